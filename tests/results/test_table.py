"""Files from before a column was added are read as if it had its default."""

from __future__ import annotations

from dataclasses import replace

import h5py
import numpy as np
import pytest
from support.places import FIXTURES
from support.sealing import editing

from kinform import results, stages
from kinform.results.held import hold
from kinform.results.table import read_rows, real, text, write_rows


def test_a_column_that_came_later_may_be_missing(tmp_path):
    old, new = (text("name"), real("area", "m²")), (text("name"), real("area", "m²"), text("motion"))
    with h5py.File(tmp_path / "old.h5", "w") as file:
        write_rows(file, "joints", old, [["a~b"], [2.0]])
        assert read_rows(hold(file), "joints", new, later=("motion",)) == [{"name": "a~b", "area": 2.0}]
        with pytest.raises(ValueError, match="motion"):
            read_rows(hold(file), "joints", new)


def test_a_results_file_from_before_drives_named_their_freedom_is_read(tmp_path):
    design = stages.import_(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
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


def test_joints_that_nobody_looked_for_are_not_said_to_be_none(tmp_path, derive_design):
    """A file from before left-out joints were looked for: the rule is skipped with the reason, and does not pass."""
    design = derive_design(FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml")
    stated = replace(design.assembly, function=replace(design.assembly.function, complete=("",)))
    design = stages.simulate(stages.mass(stages.joints(replace(design, assembly=stated))))
    results.write(design, tmp_path / "old.h5")
    assert _outcome(results.read(tmp_path / "old.h5")).outcome == "passed"
    with editing(tmp_path / "old.h5") as file:
        del file["joints/left_out"]
    before = _outcome(results.read(tmp_path / "old.h5"))
    assert before.outcome == "skipped"
    assert before.reason


def _outcome(design):
    (rule,) = (outcome for outcome in stages.check(design).report.rules if outcome.code == "KF416")
    return rule
