"""What a kind of requirement consists of, and how a stored requirement becomes its record."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import field, fields
from typing import Any, Generic, Self, TypeVar

import numpy as np

from kinform.frozen import dataclass
from kinform.requirements.answer import Answer
from kinform.requirements.evidence import Evidence, Stage

Fault = tuple[str, str, str | None]
"""What is wrong with a table, the remedy, and the key at which it is."""


def record_values(record: type, values: Mapping[str, Any]) -> dict[str, Any]:
    """The stored values that a record has fields for, lists of numbers as arrays. Keys of newer tables are left out."""
    stored = {f: values[f.name] for f in fields(record) if values.get(f.name) is not None}
    return {
        f.name: np.array(value, dtype=np.float64) if str(f.type).startswith("Array") else value
        for f, value in stored.items()
    }


class Record:
    """What a requirement asks for: SI and radians, world frame at the pose of the meshes."""

    @classmethod
    def read(cls, values: Mapping[str, Any]) -> Self:
        """The record of the values that a requirement is stored with."""
        return cls(**record_values(cls, values))


def no_faults(table: Any) -> Iterator[Fault]:
    """For tables whose keys say nothing about each other."""
    return iter(())


T = TypeVar("T")
R = TypeVar("R", bound=Record)


@dataclass(frozen=True, eq=False)
class Kind(Generic[T, R]):
    """One kind of requirement."""

    name: str
    """As `kind` of the table has it."""
    position: int
    """Its place in the schema and in lists; any number that no other kind has."""
    table: type[T]
    """Of the manifest, with pydantic's types."""
    record: type[R]
    judge: Callable[[Evidence, R], Answer]
    faults: Callable[[T], Iterator[Fault]] = no_faults
    """What the keys of a table contradict in each other, or would ask nothing with."""
    needs: Mapping[Stage, str] = field(default_factory=dict)
    """Stages whose results the judge reads, with what to do where one is missing: the requirement is then undecided."""
