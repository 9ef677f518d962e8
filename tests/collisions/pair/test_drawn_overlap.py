"""Parts that are drawn into each other: how far a joint goes is then not known the way that they go deeper, and it is
said which, how deep and where; never that nothing stops it, nor that it cannot move."""

from __future__ import annotations

import re

import numpy as np
import pytest
from support.diagonal import diagonal, first
from support.solids import assembly, box, extrusion, part, random_pose, rod

from kinform import collisions, contacts, kinematics, surfaces
from kinform.collisions.pair.drawn_overlap import DrawnOverlap
from kinform.foundation.algebra.displacements import displacements_along


def derived(solids, X, scale=1e-3):
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()), ground=None)
    known = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    return made, known, contacts.find(made, known)


def driven(solids, clear, X=None, scale=1e-3):
    """(lower, upper) ends of the joint of `clear` solids, about +z or along +x, the solids as they are drawn."""
    X = np.eye(4) if X is None else X
    apart = derived(clear, X, scale)
    (joint,) = (kin := kinematics.derive(*apart)).joints
    (item,) = collisions.ranges(*(apart if solids is clear else derived(solids, X, scale)), kin)
    along = X[:3, :3] @ ((0, 0, 1) if joint.type == "revolute" else (1, 0, 0))
    return (item.lower, item.upper) if joint.axis @ along > 0 else (item.upper, item.lower), item


def lever(above, below=None):
    """A lever whose sides are `above` and `below` (mm) in walls; negative: as far from them."""
    base = box(-50, 62, -50, 50, -5, 0) + rod(5, -1, 11, 32) + rod(8, 10, 13, 32) + box(12, 60, 4 - above, 20, -1, 20)
    if below is not None:
        base += box(12, 60, -20, -4 + below, -1, 20)
    return {"base": base, "lever": box(-8, 40, -4, 4, 0, 10) + rod(9, 0, 10, 32) - rod(5, -1, 11, 32)}


def slider(into):
    rail = box(-60, 60, -15, 15, -5, 0) + box(-60, 60, -15, -10, -1, 10) + box(-60, 60, 10, 15, -1, 10)
    return {"rail": rail + box(25 - into, 60, -11, 11, -1, 10), "slider": box(-10, 25, -10, 10, 0, 8)}


def hinge(thick, into, wide=60.0, opened=0.0):
    """Two leaves (mm) that are drawn into each other, the second opened by some degrees from there."""
    first = rod(3, -2, 52, 24) + rod(6, 0, 10, 24) + rod(6, 40, 50, 24) + box(8, wide, -thick, 0, 0, 50)
    first += box(0, 9, -thick, 0, 0, 10) + box(0, 9, -thick, 0, 40, 50)
    second = rod(6, 10, 40, 28) + box(0, wide, -into, thick - into, 12, 38) - rod(3, -5, 55, 24)
    return {"base": first, "leaf": second.rotate((0, 0, opened))}


def tooth(into, opened=0.0):
    """A lever with a tooth 3 mm wide that is drawn into another of the same width."""
    base = box(-30, 60, -40, 40, -5, 0) + rod(5, -1, 11, 32) + rod(8, 10, 13, 32) + box(20, 28, into - 3, into, -1, 10)
    lever = rod(9, 0, 10, 32) - rod(5, -1, 11, 32) + box(7, 24, 0, 3, 0, 10)
    return {"base": base, "lever": lever.rotate((0, 0, opened))}


def walled(thick, into, back=0.0):
    """A slider that is drawn into a wall across its rail, or is `back` from there."""
    wall = box(25 - into, 25 - into + thick, -11, 11, -1, 10)
    return {"rail": slider(-30)["rail"] + wall, "slider": box(-10, 25, -10, 10, 0, 8).translate((-back, 0, 0))}


def snap(into, back=0.0):
    """A slider with a ridge on it that is drawn with its crest in that of a ridge above."""
    rail = box(-60, 60, -15, 15, -5, 0) + box(-60, 60, -15, -10, -1, 13) + box(-60, 60, 10, 15, -1, 13)
    ridge = lambda outline: extrusion(outline, -5, 5).rotate((90, 0, 0))
    rail += box(-3, 3, -15, 15, 11, 13) + ridge([[-3, 11.5], [0, 9 - into], [3, 11.5]])
    body = box(-10, 25, -10, 10, 0, 8) + ridge([[-3, 7.5], [3, 7.5], [0, 9]])
    return {"rail": rail, "slider": body.translate((-back, 0, 0))}


def placed(seed, scale):
    return np.eye(4) if seed is None else random_pose(np.random.default_rng(seed), 100 * scale)


def said(end, parts, depth):
    assert (end.status, end.value) == ("unknown", None)
    first, second = parts.split(" and ")
    assert first in end.reason and second in end.reason
    assert float(re.search(r"([\d.]+) mm", end.reason)[1]) == pytest.approx(depth)


@diagonal(into=[0.2, 1.0], seed=[None, 2])
def test_a_lever_that_is_drawn_into_a_wall_goes_the_other_way_until_it_meets_it_from_behind(into, seed):
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed))
    (lower, upper), item = driven(lever(into), lever(-3), X)
    said(upper, "base and lever", into)
    assert (lower.status, lower.parts, item.left_out) == ("found", ("base", "lever"), (("base", "lever"),))
    clear = lever(-3)
    behind, _ = driven(clear, clear, X)
    assert abs(lower.value) == pytest.approx(abs(behind[0].value), abs=1e-8)


@pytest.mark.parametrize("into", first(2, [0.01, 0.5, 0.03, 0.1]))
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
    solids["base"] += rod(3, -1, 20, 24).translate((30, 6, 0))
    clear["base"] += rod(3, -1, 20, 24).translate((30, 12, 0))
    (lower, upper), item = driven(solids, clear)
    assert upper.status == "unknown"
    assert item.left_out == (("base", "lever"),)
    assert lower.status == "found"


def test_faces_along_which_a_joint_moves_may_be_drawn_into_each_other():
    solids = lever(-12)
    solids["base"] += box(-50, 62, -50, 50, -1, 0.2)
    clear = lever(-12)
    for end, expected in zip(driven(solids, clear)[0], driven(clear, clear)[0], strict=True):
        assert end.status == expected.status == "found"
        assert end.value == pytest.approx(expected.value, abs=1e-8)


PLACES = [(None, 1e-3), (3, 1e-5), (4, 1.0)]


@diagonal(share=[0.5, 0.85, 0.95], place=PLACES)
def test_a_leaf_of_sheet_metal_does_not_go_through_the_one_that_it_is_drawn_into(share, place):
    """1 mm thick and 300 mm wide it is never much deeper in the other than as drawn."""
    X, scale = placed(*place), place[1]
    (lower, upper), item = driven(hinge(1.0, share, 300.0), hinge(1.0, share, 300.0, 60.0), X, scale)
    assert lower.status == "unknown"
    assert item.left_out == (("base", "leaf"),)
    assert upper.status in ("unknown", "found")


@pytest.mark.parametrize("into", first(1, [1.2, 0.5, 2.0]))
def test_a_leaf_that_is_drawn_into_the_other_opens_until_it_meets_it_from_behind(into):
    """What crosses is all in the planes of faces, so that it is not measured how deep that is."""
    opened = hinge(3.0, into, opened=60.0)
    (lower, upper), item = driven(hinge(3.0, into), opened)
    (_, behind), _ = driven(opened, opened)
    assert (lower.status, lower.value) == ("unknown", None)
    assert item.left_out == (("base", "leaf"),)
    assert upper.status == "unknown" or upper.value == pytest.approx(behind.value + np.radians(60.0), abs=1e-6)


@diagonal(into=[1.5, 2.5], place=PLACES)
def test_a_tooth_does_not_go_through_the_one_that_it_is_drawn_into(into, place):
    """Two teeth of 3 mm: by 2.5 mm in each other they have parted about as soon one way as the other."""
    (lower, _), item = driven(tooth(into), tooth(into, 40.0), placed(*place), place[1])
    assert lower.status == "unknown"
    assert item.left_out == (("base", "lever"),)


@diagonal(wall=[(0.8, 0.5), (30.0, 5.0)], place=PLACES)
def test_a_slider_does_not_go_through_a_wall_that_it_is_drawn_into(wall, place):
    """Neither through a thin one, nor into a thick one, in which it is as deep from all sides wherever it is."""
    ends, item = driven(walled(*wall), walled(*wall, 10.0), placed(*place), place[1])
    assert ends[0].status == "unbounded"
    assert ends[1].status == "unknown"
    assert item.left_out == (("rail", "slider"),)


@pytest.mark.parametrize(("seed", "scale"), PLACES)
def test_a_ridge_that_is_drawn_with_its_crest_in_another_leads_neither_way_for_sure(seed, scale):
    for end in driven(snap(0.4), snap(0.4, 10.0), placed(seed, scale), scale)[0]:
        assert end.status == "unknown"


@diagonal(motion=["turn", "slide", "screw"], seed=[None, 5])
def test_what_is_pressed_together_neither_parts_nor_goes_on_into_it_where_it_slips(motion, seed):
    X = placed(seed, 1e-3)
    tube = part("tube", rod(9, 0, 20, 64) - rod(4.9, -1, 21, 48), X)
    shaft = part("shaft", rod(5, -10, 30, 60), X)
    overlap = DrawnOverlap(tube.mesh, shaft.mesh, np.eye(4), 1e-5)
    turn, along = {"turn": (1, 0), "slide": (0, 1e-2), "screw": (1, 1e-3)}[motion]
    axis = X[:3, 2]
    moved = displacements_along(np.concatenate([turn * axis, np.cross(X[:3, 3], turn * axis) + along * axis]))
    for sign in (-1.0, 1.0):
        assert overlap.leads_in(lambda s, sign=sign: moved(sign * s), 0.0, 1.0) is None


@diagonal(into=[0.3, 2.0, 4.0], seed=[None, 6])
def test_the_way_that_a_block_leads_on_into_another(into, seed):
    """Blocks 5 mm thick."""
    X = placed(seed, 1e-3)
    one, other = part("one", box(-9, 9, -9, 9, -5, 0), X), part("other", box(-5, 5, -5, 5, -into, 5 - into), X)
    overlap = DrawnOverlap(one.mesh, other.mesh, np.eye(4), 1e-5)
    leads = [overlap.leads_in(displacements_along(np.append(np.zeros(3), s * X[:3, 2])), 0.0, 0.1) for s in (-1, 1)]
    assert leads == [pytest.approx(4e-3 * into * 10 / (10 + 2 * into), rel=2e-3), None]
