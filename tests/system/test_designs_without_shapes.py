"""The gate of a design that is function alone: what can be is checked, what is given is not compared with itself."""

from __future__ import annotations

import numpy as np
import pytest
from support.places import FIXTURES

from kinform.consistency import verdict

HINGE = """
[[function.joint]]
name = "{name}"
between = ["{a}", "{b}"]
type = "revolute"
axis = [0, 0, {sense}]
point = [{x}, 0, 0]
{more}
"""


def arm(tmp_path, *, mobility=2, ranges=True, extra="", elbow_between=("upper", "fore"), sense=1, mesh=""):
    """A manifest of two hinges in a row, 200 and 150 mm long."""
    more = "range = [-90, 90]" if ranges else ""
    path = tmp_path / "arm.toml"
    path.write_text(
        'schema = 1\n[assembly]\nname = "arm"\nunits = "mm"\nground = "base"\n'
        + f'[[part]]\nname = "base"\n{mesh}\n[[part]]\nname = "upper"\n[[part]]\nname = "fore"\n'
        + f"[function]\nmobility = {mobility}\n"
        + HINGE.format(name="shoulder", a="base", b="upper", x=0, sense=1, more=more)
        + HINGE.format(name="elbow", a=elbow_between[0], b=elbow_between[1], x=200, sense=sense, more=more)
        + extra
    )
    return path


def coupling(ratio):
    return f'\n[[function.coupling]]\njoints = ["elbow", "shoulder"]\nratio = {ratio}\n'


def outcomes(design):
    return {rule.code: rule.outcome for rule in design.report.rules}


def test_sticks_with_ranges_are_verified_and_given_ranges_are_skipped(derive_design, tmp_path):
    design = derive_design(arm(tmp_path))
    assert verdict(design.report) == 0
    found = {rule.code: rule for rule in design.report.rules}
    assert found["KF301"].outcome == "passed"
    assert found["KF904"].outcome == "skipped"
    # nothing that is about shapes passes without shapes
    assert {found[code].outcome for code in ("KF201", "KF204", "KF205", "KF206", "KF412")} == {"skipped"}


def test_one_mesh_at_a_joint_and_its_range_is_open(derive_design, tmp_path):
    block = FIXTURES / "pairs" / "planar_block"
    mesh = next(path for path in sorted(block.glob("*.stl")))
    (tmp_path / "part.stl").write_bytes(mesh.read_bytes())
    design = derive_design(arm(tmp_path, mesh='mesh = "part.stl"'))
    notes = [f for f in design.report.findings if f.code == "KF904"]
    assert [f.subject for f in notes] == [("shoulder",)]
    assert "'upper'" in notes[0].message
    assert outcomes(design)["KF904"] == "inconclusive"
    assert verdict(design.report) == 2


def test_a_mobility_that_sticks_do_not_have_is_an_error(derive_design, tmp_path):
    assert verdict(derive_design(arm(tmp_path, mobility=3)).report) == 1


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("between", [("upper", "fore"), ("fore", "upper")])
def test_a_stated_coupling_costs_a_freedom_and_turns_as_the_designer_counts(derive_design, tmp_path, sense, between):
    design = derive_design(arm(tmp_path, mobility=1, extra=coupling(-2), sense=sense, elbow_between=between))
    assert verdict(design.report) == 0
    assert outcomes(design)["KF903"] == "skipped"
    mobility = design.kinematics.mobility
    assert (mobility.instantaneous, mobility.finite, mobility.effective, mobility.redundant) == (1, 1, 1, 0)
    names = [body.name for body in design.kinematics.bodies]
    twist = mobility.freedoms[0]
    upper = twist[names.index("upper"), 2]
    relative = twist[names.index("fore"), 2] - upper
    forward = sense * (1 if between == ("upper", "fore") else -1)
    assert forward * relative == pytest.approx(-2.0 * upper)
    (named,) = mobility.named
    assert len(named.drives) == 2


def test_couplings_that_contradict_each_other_lock(derive_design, tmp_path):
    other = tmp_path / "same"
    other.mkdir()
    locked = derive_design(arm(tmp_path, mobility=0, extra=coupling(2) + coupling(3)))
    assert locked.kinematics.mobility.effective == 0
    same = derive_design(arm(other, mobility=1, extra=coupling(2) + coupling(2)))
    assert same.kinematics.mobility.effective == 1
    assert same.kinematics.mobility.redundant == 1


def test_a_region_that_only_joints_free_of_their_coupling_reach_is_not_a_pass(derive_design, tmp_path):
    place = 200 * np.array([np.cos(0.3), np.sin(0.3)]) + 150 * np.array([np.cos(-0.5), np.sin(-0.5)])
    reach = (
        '\n[[function.require]]\nname = "tip"\nkind = "reach"\npart = "fore"\npoint = [350, 0, 0]\n'
        f'tolerance = 1\nregion = {{type = "poses", points = [[{place[0]}, {place[1]}, 0]]}}\n'
    )
    free = derive_design(arm(tmp_path, extra=reach))
    assert outcomes(free)["KF421"] == "passed"
    (tmp_path / "tied").mkdir()
    tied = derive_design(arm(tmp_path / "tied", mobility=1, extra=reach + coupling(1)))
    (note,) = (f for f in tied.report.findings if f.code == "KF902")
    assert note.subject == ("tip",)
    assert verdict(tied.report) == 2
