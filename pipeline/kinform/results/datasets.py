"""A dataset made whole: its numbers or texts, and the units that go with them.

By HDF5's own calls: h5py's names for them look up and make anew, of each of some two hundred datasets, types and
properties that are the same every time, and that was a third of what writing a file took.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import h5py
import numpy as np
from h5py import h5a, h5d, h5p, h5s, h5t
from numpy.typing import NDArray

TEXT = h5py.string_dtype()


def create(group: h5py.Group, name: str, data: NDArray[Any], units: str | Sequence[str]) -> None:
    """Make a dataset of this name in the group, of data in C order: contiguous, uncompressed, without times. `units` is
    one text, or one a column."""
    stored = h5t.py_create(data.dtype, logical=True)
    held = h5t.py_create(data.dtype) if data.dtype.hasobject else stored
    dataset = h5d.create(group.id, name.encode(), stored, h5s.create_simple(data.shape), dcpl=_properties())
    dataset.write(h5s.ALL, h5s.ALL, data, held)
    said = np.array(units, dtype=TEXT)
    stored, held = _texts()
    attribute = h5a.create(dataset, b"units", stored, h5s.create_simple(said.shape))
    attribute.write(said, held)


@cache
def _properties() -> Any:
    """How datasets are made."""
    properties = h5p.create(h5p.DATASET_CREATE)
    properties.set_obj_track_times(False)
    return properties


@cache
def _texts() -> tuple[Any, Any]:
    """The type of texts in a file, and in memory."""
    return h5t.py_create(TEXT, logical=True), h5t.py_create(TEXT)
