"""`/constraints`: the assembly's constraint matrix J as CSR, and where each row comes from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from typing import Any

import h5py
import numpy as np

from kinform.design import Design
from kinform.model.arrays import freeze
from kinform.model.contacts import Patch
from kinform.model.kinematics import ConstraintMatrix
from kinform.results.datasets import TEXT
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Numbers, Row, Rows, Texts
from kinform.results.table import read_columns, write_columns
from kinform.results.texts import stored_text


class _Origins:
    """Of each row its patch and sample, and for readers the parts that the patch is between."""

    dataset, fields = "rows", ("patch", "sample")

    def __init__(self, patches: Sequence[Patch] = ()):
        self._patches = patches

    def write(self, group: h5py.Group, cls: type, records: Sequence[ConstraintMatrix]) -> None:
        (matrix,), patches = records, self._patches
        parts = [patches[i].parts if 0 <= i < len(patches) else ("", "") for i in matrix.patch.tolist()]
        columns = {
            "patch": ("1", matrix.patch.astype("<i8")),
            "sample": ("1", matrix.sample.astype("<i8")),
            "part_a": ("", np.array([stored_text(a) for a, _ in parts], dtype=TEXT)),
            "part_b": ("", np.array([stored_text(b) for _, b in parts], dtype=TEXT)),
        }
        write_columns(group, "rows", columns)

    def read(self, group: HeldGroup, cls: type, rows: Rows) -> None:
        table = read_columns(group, "rows", self.fields)
        rows[0].update({name: freeze(table[name].copy()) for name in self.fields})


def _layout(origins: _Origins) -> Layout:
    arrays = map(Numbers, ("data", "indices", "indptr"))
    return Layout(ConstraintMatrix, Texts("bodies"), *arrays, origins, Row("scaling", "centre", "length"))


def write(group: h5py.Group, design: Design) -> None:
    """Write J, six columns a body in the order of `bodies`."""
    assert design.kinematics is not None
    patches = () if design.contacts is None else design.contacts.patches
    _layout(_Origins(patches)).write(group, design.kinematics.matrix)


def read(group: HeldGroup) -> ConstraintMatrix:
    """The matrix that `write` wrote."""
    matrix: ConstraintMatrix = _layout(_Origins()).read(group)
    return matrix


class LaterMatrix(ConstraintMatrix):
    """The matrix that a function gives when one of its fields is first looked at: most of the rows of a file are its
    origins, and few commands ask for them. What the function raises is raised then."""

    def __init__(self, made: Callable[[], ConstraintMatrix]):
        object.__setattr__(self, "_made", made)

    def __getattr__(self, name: str) -> Any:
        if name not in {field.name for field in fields(ConstraintMatrix)}:
            raise AttributeError(name)
        whole = self._made()
        for field in fields(ConstraintMatrix):
            object.__setattr__(self, field.name, getattr(whole, field.name))
        return getattr(whole, name)

    def __reduce__(self) -> tuple[type, tuple[Any, ...]]:
        """As a plain one: another process has not the file open."""
        return ConstraintMatrix, tuple(getattr(self, field.name) for field in fields(ConstraintMatrix))
