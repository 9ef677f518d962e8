"""Frozen records with other values in some fields."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Record = TypeVar("Record", bound="DataclassInstance")


def made(record: type[Record], /, **values: Any) -> Record:
    """A record of this kind with these values in its fields, all of which are to be given: not set one by one, as its
    constructor does, in a fifth of the time."""
    if values.keys() != record.__dataclass_fields__.keys():
        raise TypeError(f"{record.__name__} has the fields {', '.join(record.__dataclass_fields__)}")
    out = object.__new__(record)
    vars(out).update(values)
    return out


def altered(record: Record, **values: Any) -> Record:
    """As `dataclasses.replace`, of a record whose fields are what it was given: not made anew field by field, in a
    fifth of the time. What the record has found of itself and kept is not taken along."""
    given, fields = vars(record), record.__dataclass_fields__
    if not values.keys() <= fields.keys():
        raise TypeError(f"{type(record).__name__} has no field {', '.join(values.keys() - fields.keys())}")
    out = object.__new__(type(record))
    held = vars(out)
    for name in fields:
        held[name] = given[name]
    held.update(values)
    return out
