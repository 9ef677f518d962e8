"""`/constraints`: the assembly's constraint matrix J as CSR, and where each row comes from."""

from __future__ import annotations

from collections.abc import Sequence

import h5py
import numpy as np

from kinform.model.arrays import freeze
from kinform.model.contacts import Patch
from kinform.model.kinematics import ConstraintMatrix
from kinform.results.table import (
    TEXT,
    read_array,
    read_columns,
    read_rows,
    read_texts,
    real,
    stored_text,
    vector,
    write_array,
    write_columns,
    write_rows,
    write_texts,
)

__all__ = ["read", "write"]

_SCALING = (vector("centre", "m"), real("length", "m"))


def write(group: h5py.Group, matrix: ConstraintMatrix, patches: Sequence[Patch]) -> None:
    """Write J, six columns a body in the order of `bodies`; `rows` names patch, sample and parts."""
    write_texts(group, "bodies", matrix.bodies)
    write_array(group, "data", matrix.data, "1 (lengths over scaling.length)")
    write_array(group, "indices", matrix.indices, "1", "<i8")
    write_array(group, "indptr", matrix.indptr, "1", "<i8")
    parts = [patches[i].parts if 0 <= i < len(patches) else ("", "") for i in matrix.patch.tolist()]
    write_columns(
        group,
        "rows",
        {
            "patch": ("1", matrix.patch.astype("<i8")),
            "sample": ("1", matrix.sample.astype("<i8")),
            "part_a": ("", np.array([stored_text(a) for a, _ in parts], dtype=TEXT)),
            "part_b": ("", np.array([stored_text(b) for _, b in parts], dtype=TEXT)),
        },
    )
    write_rows(group, "scaling", _SCALING, [vars(matrix)])


def read(group: h5py.Group) -> ConstraintMatrix:
    """The matrix that `write` wrote."""
    rows = read_columns(group, "rows", ("patch", "sample"))
    (scaling,) = read_rows(group, "scaling", _SCALING)
    return ConstraintMatrix(
        bodies=read_texts(group, "bodies"),
        data=read_array(group, "data"),
        indices=read_array(group, "indices"),
        indptr=read_array(group, "indptr"),
        patch=freeze(rows["patch"].copy()),
        sample=freeze(rows["sample"].copy()),
        **scaling,
    )
