"""Parts that are drawn into each other: how far a joint goes is then not known the way that they go deeper, and it is
said which, how deep and where; never that nothing stops it, nor that it cannot move."""

from __future__ import annotations

import numpy as np
import pytest
from support.solids import assembly, box, part, random_pose, rod

from kinform import collisions, contacts, kinematics, surfaces


def derived(solids, X):
    made = assembly(*(part(name, solid, X, 1e-3) for name, solid in solids.items()), ground=None)
    known = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    return made, known, contacts.find(made, known)


def driven(solids, clear, X=None):
    """(lower, upper) ends of the joint of `clear` solids, about +z or along +x, the solids as they are drawn."""
    X = np.eye(4) if X is None else X
    (joint,) = (kin := kinematics.derive(*derived(clear, X))).joints
    (item,) = collisions.ranges(*derived(solids, X), kin)
    along = X[:3, :3] @ ((0, 0, 1) if joint.type == "revolute" else (1, 0, 0))
    return (item.lower, item.upper) if joint.axis @ along > 0 else (item.upper, item.lower), item


def lever(above, below=None):
    """A lever whose sides are `above` and `below` (mm) in walls; negative: as far from them."""
    base = box(-50, 62, -50, 50, -5, 0) + rod(5, -1, 11, 64) + rod(8, 10, 13, 64) + box(12, 60, 4 - above, 20, -1, 20)
    if below is not None:
        base += box(12, 60, -20, -4 + below, -1, 20)
    return {"base": base, "lever": box(-8, 40, -4, 4, 0, 10) + rod(9, 0, 10, 64) - rod(5, -1, 11, 64)}


def slider(into):
    rail = box(-60, 60, -15, 15, -5, 0) + box(-60, 60, -15, -10, -1, 10) + box(-60, 60, 10, 15, -1, 10)
    return {"rail": rail + box(25 - into, 60, -11, 11, -1, 10), "slider": box(-10, 25, -10, 10, 0, 8)}


def said(end, parts, depth):
    assert (end.status, end.value) == ("unknown", None)
    assert end.reason.startswith(f"{parts} overlap by {depth:g} mm as drawn at (")


@pytest.mark.parametrize("seed", [None, 2])
@pytest.mark.parametrize("into", [0.2, 1.0])
def test_a_lever_that_is_drawn_into_a_wall_goes_the_other_way_until_it_meets_it_from_behind(into, seed):
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed))
    (lower, upper), item = driven(lever(into), lever(-3), X)
    said(upper, "base and lever", into)
    assert (lower.status, lower.parts, item.left_out) == ("found", ("base", "lever"), (("base", "lever"),))
    behind, _ = driven(lever(-3), lever(-3), X)
    assert abs(lower.value) == pytest.approx(abs(behind[0].value), abs=1e-8)


@pytest.mark.parametrize("into", [0.01, 0.03, 0.1, 0.5])
def test_a_lever_that_is_drawn_into_walls_on_both_sides_is_not_said_to_be_stopped(into):
    for end in driven(lever(into, into), lever(-3, -3))[0]:
        said(end, "base and lever", into)


def test_a_lever_that_just_fits_between_walls_is_stopped():
    for end in driven(lever(0, 0), lever(-3, -3))[0]:
        assert (end.status, end.value) == ("found", pytest.approx(0.0, abs=1e-8))


@pytest.mark.parametrize("into", [0.2, 1.0])
def test_a_slider_that_is_drawn_into_its_stop_does_not_go_through_it(into):
    (lower, upper), _ = driven(slider(into), slider(-3))
    assert lower.status == "unbounded"
    said(upper, "rail and slider", into)


@pytest.mark.parametrize("into", [0.0, 0.01, 0.02])
def test_a_slider_that_is_in_its_stop_by_no_more_than_parts_may_overlap_is_at_its_stop(into):
    (lower, upper), _ = driven(slider(into), slider(-3))
    assert lower.status == "unbounded"
    assert (upper.status, upper.value) == ("found", pytest.approx(0.0, abs=5e-5))


def test_a_peg_that_a_lever_is_drawn_into_is_not_passed_to_be_met_from_behind():
    """The lever is in the peg by 1 mm: the way through it is none."""
    solids, clear = lever(-12), lever(-12)
    solids["base"] += rod(3, -1, 20, 48).translate((30, 6, 0))
    clear["base"] += rod(3, -1, 20, 48).translate((30, 12, 0))
    (lower, upper), _ = driven(solids, clear)
    assert upper.status == "unknown"
    assert "base and lever overlap by" in upper.reason
    assert lower.status == "found"


def test_faces_along_which_a_joint_moves_may_be_drawn_into_each_other():
    solids = lever(-12)
    solids["base"] += box(-50, 62, -50, 50, -1, 0.2)
    for end, expected in zip(driven(solids, lever(-12))[0], driven(lever(-12), lever(-12))[0], strict=True):
        assert end.status == expected.status == "found"
        assert end.value == pytest.approx(expected.value, abs=1e-8)
