"""Files from before a column was added are read as if it had its default."""

from __future__ import annotations

import h5py
import pytest

from kinform.results.held import hold
from kinform.results.table import read_rows, real, text, write_rows


def test_a_column_that_came_later_may_be_missing(tmp_path):
    old, new = (text("name"), real("area", "m²")), (text("name"), real("area", "m²"), text("motion"))
    with h5py.File(tmp_path / "old.h5", "w") as file:
        write_rows(file, "joints", old, [["a~b"], [2.0]])
        assert read_rows(hold(file), "joints", new, later=("motion",)) == [{"name": "a~b", "area": 2.0}]
        with pytest.raises(ValueError, match="motion"):
            read_rows(hold(file), "joints", new)
