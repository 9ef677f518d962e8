"""Columns of a table from the annotations of a record's fields, so that a field is declared in one place, its class.

A text, flag, count, number, list of texts or dict of values is one column. Several numbers in one field, a tuple, or a
record inside a record take a column each, labelled as the annotation says (`kinform.model.quantities`). Everything
else, tuples of records and arrays of any length first of all, has no place in a row: `layout` says where it goes.
"""

from __future__ import annotations

import functools
import sys
import types
import typing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass, replace
from typing import Annotated, Any, Literal, NewType

import numpy as np

from kinform.frozen import dataclass
from kinform.model.quantities import Columns
from kinform.results.table import Column, arrays, flag, inline, integer, numbers, real, text, texts, values


@dataclass(frozen=True)
class Hint:
    """What an annotation says."""

    type: Any
    """The type itself: neither a name for another, nor optional, nor annotated."""
    optional: bool
    unit: str | None
    columns: Columns | None

    @property
    def arguments(self) -> tuple[Any, ...]:
        """Types of the items of a tuple, of NumPy's arrays shape and kind."""
        return typing.get_args(self.type)

    @property
    def item(self) -> Hint | None:
        """Of a tuple of any length: what its items are."""
        arguments = self.arguments if typing.get_origin(self.type) is tuple else ()
        return hint(arguments[0]) if arguments[1:] == (Ellipsis,) else None

    @property
    def number(self) -> Any:
        """The type of the numbers of an array; None for anything else."""
        return typing.get_args(self.arguments[1])[0] if typing.get_origin(self.type) is np.ndarray else None


def hint(annotation: Any) -> Hint:
    """What an annotation says, its names and layers taken off."""
    optional, said = False, []
    while True:
        origin = typing.get_origin(annotation)
        if origin is Annotated:
            said += annotation.__metadata__
            annotation = annotation.__origin__
        elif origin in (typing.Union, types.UnionType):
            optional = True
            (annotation,) = (kind for kind in typing.get_args(annotation) if kind is not types.NoneType)
        elif isinstance(annotation, NewType):
            annotation = annotation.__supertype__
        elif origin is Literal:
            annotation = type(typing.get_args(annotation)[0])
        else:
            unit = next((item for item in said if isinstance(item, str)), None)
            return Hint(annotation, optional, unit, next((item for item in said if isinstance(item, Columns)), None))


def _hints(cls: type) -> Mapping[str, Hint]:
    """What the annotation of each field of a class says, in the order of the fields."""
    said: dict[str, tuple[str, Any]] = {}
    for base in reversed(cls.__mro__):
        said |= {name: (base.__module__, text) for name, text in vars(base).get("__annotations__", {}).items()}
    return {field.name: _hint_of(*said[field.name]) for field in fields(cls)}


@functools.cache
def _hint_of(module: str, annotation: Any) -> Hint:
    """What an annotation says that stands in a module, as text or not. Most are those of many fields."""
    return hint(eval(annotation, vars(sys.modules[module])) if isinstance(annotation, str) else annotation)


def _defaults(cls: type) -> frozenset[str]:
    """Fields of a class that have a default: files from before they were added may lack them."""
    plain = {field.name for field in fields(cls) if field.default is not MISSING}
    return frozenset(plain | {field.name for field in fields(cls) if field.default_factory is not MISSING})


hints: Callable[[Any], Mapping[str, Hint]] = functools.cache(_hints)
defaults: Callable[[Any], frozenset[str]] = functools.cache(_defaults)


@functools.cache
def columns_of(
    record: Hint, leave_out: frozenset[str] = frozenset(), first: tuple[str, ...] = ()
) -> tuple[Column, ...]:
    """The columns of a dataclass, or of a tuple whose annotation names its items.

    Without the fields `leave_out`; those named `first` come first, where the file has another order than the class.
    Raises TypeError for a field that has no place in a row.
    """
    if is_dataclass(record.type):
        said = hints(record.type)
        names = [*first, *(name for name in said if name not in first and name not in leave_out)]
        return tuple(_column(name, said[name]) for name in names)
    assert record.columns is not None
    return tuple(_column(*item) for item in zip(record.columns.labels, map(hint, record.arguments), strict=True))


def record_values(record: Hint, records: Sequence[Any], column: Column) -> list[Any]:
    """What a column holds of all these records."""
    if is_dataclass(record.type):
        return [getattr(item, column.field) for item in records]
    assert record.columns is not None
    place = record.columns.labels.index(column.field)
    return [item[place] for item in records]


def record_maker(record: Hint) -> Callable[..., Any]:
    """What makes a record of its fields by name."""
    return record.type if is_dataclass(record.type) else lambda **row: tuple(row.values())  # type: ignore[return-value]


def _column(name: str, said: Hint) -> Column:
    """The column, or columns, of one field."""
    if said.type is str:
        return text(name, optional=said.optional)
    if said.type is bool:
        return flag(name, optional=said.optional)
    if said.type is int:
        return integer(name, optional=said.optional)
    if typing.get_origin(said.type) is dict:
        of_numbers = typing.get_origin(said.arguments[1]) is tuple
        return (arrays if of_numbers else values)(name, optional=said.optional)
    if said.item is not None and said.item.type in (str, int):
        return texts(name, said.item.type, optional=said.optional)
    if said.type is float and said.unit is not None:
        return real(name, said.unit, optional=said.optional)
    if said.number is np.float64 and said.unit is not None and said.columns is not None:
        return numbers(name, said.unit, _labels(name, said.columns.labels), said.columns.shape, optional=said.optional)
    if typing.get_origin(said.type) is tuple and said.columns is not None:
        return _tuple_column(name, said, said.columns.labels)
    if is_dataclass(said.type):
        return _record_column(name, said)
    raise TypeError(f"a field `{name}` of the type {said.type} has no place in a row of a table")


def _labels(name: str, labels: Sequence[str]) -> list[str]:
    return [label.replace("*", name) for label in labels]


def _tuple_column(name: str, said: Hint, labels: Sequence[str]) -> Column:
    """A tuple of a fixed length: its items are numbered; a unit is that of all of them."""
    items = [replace(item, unit=item.unit or said.unit) for item in map(hint, said.arguments)]
    inner = [_column(str(place), item) for place, item in enumerate(items)]
    get = lambda value, column: value[int(column.field)]
    return inline(name, inner, _labels(name, labels), get, tuple, optional=True)


def _record_column(name: str, said: Hint) -> Column:
    """A record in a record."""
    inner = columns_of(replace(said, optional=False, columns=None))
    labels = [label for column in inner for label in column.labels]
    names = [column.field for column in inner]
    shown = labels if said.columns is None else _labels(name, said.columns.labels)
    make = lambda row: said.type(**dict(zip(names, row, strict=True)))
    later = {field.name for field in fields(said.type) if field.default is None}
    get = lambda value, column: getattr(value, column.field)
    return inline(name, inner, shown, get, make, optional=said.optional, later=later)
