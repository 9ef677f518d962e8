"""Files from before a column was added are read as if it had its default."""

from __future__ import annotations

import h5py
import numpy as np
import pytest
from support.places import FIXTURES
from support.sealing import editing

from kinform import results
from kinform.results.held import hold
from kinform.results.table import read_rows, real, text, write_rows


def test_a_column_that_came_later_may_be_missing(tmp_path):
    old, new = (text("name"), real("area", "m²")), (text("name"), real("area", "m²"), text("motion"))
    with h5py.File(tmp_path / "old.h5", "w") as file:
        write_rows(file, "joints", old, [["a~b"], [2.0]])
        assert read_rows(hold(file), "joints", new, later=("motion",)) == [{"name": "a~b", "area": 2.0}]
        with pytest.raises(ValueError, match="motion"):
            read_rows(hold(file), "joints", new)


def test_a_results_file_from_before_drives_named_their_freedom_is_read(tmp_path, derive_design):
    design = derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
    results.write(design, tmp_path / "old.h5")
    with editing(tmp_path / "old.h5") as file:
        name = "assembly/function/drives"
        table, units = file[name][...], file[name].attrs["units"]
        labels = [label for label in table.dtype.names if label != "freedom"]
        assert len(labels) == len(table.dtype.names) - 1
        before = np.array(table[labels].tolist(), dtype=[(label, table.dtype[label]) for label in labels])
        kept = [table.dtype.names.index(label) for label in labels]
        del file[name]
        file.create_dataset(name, data=before, track_times=False).attrs["units"] = units[kept]
    assert repr(results.read(tmp_path / "old.h5").assembly.function.drives) == repr(design.assembly.function.drives)
