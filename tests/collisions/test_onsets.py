"""Ends are where parts first touch that are too deep in each other soon after: of either order and any place of them,
and whether facets that cross show it, or points that come in."""

from __future__ import annotations

from math import asin, atan2, hypot, radians

import numpy as np
import pytest
from support.solids import assembly, box, extrusion, part, random_pose, rod

from kinform import collisions, contacts, kinematics, surfaces
from kinform.collisions import constants

SCALES = [1e-5, 1e-3, 1.0]
WITHIN = constants.STOP_ANGLE


def ends(solids, along, X=None, scale=1e-3, names=None):
    """(lower, upper) of the joint of a base and what moves on it (mm), of the latter about or along a direction; rad or
    mm. `names`: others."""
    X, names = np.eye(4) if X is None else X, names or {}
    X = np.block([[X[:3, :3], X[:3, 3:] * scale / 1e-3], [np.zeros((1, 3)), np.ones((1, 1))]])
    frame = tuple(names.get(name, name) for name in solids if name != "mover")
    mover = names.get("mover", "mover")
    made = assembly(
        *(part(names.get(name, name), solid, X, scale) for name, solid in solids.items()),
        ground=None, groups=(("frame", frame),) if len(frame) > 1 else (),
    )  # fmt: skip
    known = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, known)
    kin = kinematics.derive(made, known, touching)
    (joint,) = kin.joints
    (item,) = collisions.ranges(made, known, touching, kin)
    sign = np.sign(joint.axis @ (X[:3, :3] @ along)) * (1 if mover in joint.bodies[1] else -1)
    length = 1.0 if joint.type == "revolute" else scale
    both = (item.lower, item.upper) if sign > 0 else (item.upper, item.lower)
    return tuple(None if end.value is None else sign * end.value / length for end in both)


def plate():
    return box(-70, 70, -70, 70, -5, 0) + rod(5, -1, 11) + rod(8, 10, 13)


def lever():
    return box(-8, 40, -4, 4, 0, 10) + rod(9, 0, 10) - rod(5.02, -1, 11, 32, 3.0)


def rail():
    return box(-60, 60, -15, 15, -5, 0) + box(-60, 60, -15, -10, -1, 10) + box(-60, 60, 10, 15, -1, 10)


def touched(x, y):
    """The angle at which the side of the lever comes to a corner."""
    return atan2(y, x) - asin(4 / hypot(x, y))


def everywhere(solids, along, expected, within, scale=1e-3):
    """The upper end, in both orders and at two places."""
    for X in (None, random_pose(np.random.default_rng(3))):
        for names in ({}, {"base": "zz", "mover": "aa"}):
            assert ends(solids, along, X, scale, names)[1] == pytest.approx(expected, abs=within)


x, z = np.eye(3)[[0, 2]]


@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("thick", [5.0, 0.1, 0.03])
@pytest.mark.parametrize("clear", [0.0, 0.05, 0.3, 1.0, 10.0])
def test_a_lever_stops_at_the_corner_of_a_bar_however_thin_and_near(clear, thick, scale):
    """Points on a thin bar come in far from the corner that the lever meets first."""
    bar = box(20, 30, 4 + clear, 4 + clear + thick, -1, 8)
    everywhere({"base": plate() + bar, "mover": lever()}, z, touched(30, 4 + clear), WITHIN, scale)


@pytest.mark.parametrize("turn", [10, 90, 170])
def test_a_lever_stops_at_a_wire_that_is_in_it_within_a_step(turn):
    across = lambda s, t: (radians(turn) + atan2(t, 30 + s), hypot(30 + s, t))
    first = min(a - asin(4 / r) for a, r in (across(s, t) for s in (-0.05, 0.05) for t in (-0.05, 0.05)))
    wire = box(29.95, 30.05, -0.05, 0.05, -1, 8).rotate((0, 0, turn))
    everywhere({"base": plate() + wire, "mover": lever()}, z, first, WITHIN)


@pytest.mark.parametrize("clear", [1.0, 3.0, 10.0])
def test_a_flush_slider_stops_where_its_corner_meets_a_wall_askew(clear):
    """What they share there is flat, and no depth tells of it: the points beside it do, later."""
    wall = box(0, 5, -11, 11, -1, 10).rotate((0, 0, 3)).translate((25 + clear, 0, 0))
    slider = box(-10, 25, -10, 10, 0, 8)
    touch = clear - 10 * np.tan(radians(3))
    everywhere({"base": rail() + wall, "mover": slider}, x, touch, constants.STOP_LENGTH * 41.1)


@pytest.mark.parametrize("into", [0.001, 0.01, 0.03])
def test_what_is_drawn_in_its_stop_by_less_than_parts_may_scrape_is_at_its_stop(into):
    bar = box(20, 30, 4 - into, 9, -1, 8)
    everywhere({"base": plate() + bar, "mover": lever()}, z, 0.0, WITHIN)
    wall = box(25 - into, 30, -11, 11, -1, 10)
    everywhere({"base": rail() + wall, "mover": box(-10, 25, -10, 10, 0, 8)}, x, 0.0, constants.STOP_LENGTH * 41.1)


def test_dogs_beside_a_loose_bore_stop_it_in_either_order():
    """They meet further from the shaft than it may be off its mate, and no further from the bore."""
    hub = rod(20, 0, 10, 64) - rod(10.3, -1, 11, 64)
    hub += (box(10.5, 14, 0, 4, 9, 14) ^ rod(14, 9, 14, 64)) - rod(10.3, 8, 15, 64)
    shaft = rod(10, -3, 16, 64) + rod(15, -3, 0, 64) + rod(15, 14, 16, 64)
    dog = (box(-14, 14, -8, 0, 10, 15) ^ (rod(10.85, 10, 15, 64) - rod(9, 9, 16, 64))) - box(-20, 20, -20, -1, 9, 16)
    found = [ends({"base": hub, "mover": shaft + dog}, z, None, 1e-3, names) for names in ({}, {"base": "zz"})]
    assert None not in found[0]
    assert found[1] == pytest.approx(found[0], abs=WITHIN)


@pytest.mark.parametrize("names", [{}, {"ramp": "zz"}, {"ramp": "aa"}])
@pytest.mark.parametrize("clear", [3.0, 4.2, 5.1, 6.3])
def test_a_ramp_that_is_only_scraped_until_a_wall_stops_is_no_stop(clear, names):
    """It would be one 1.5 mm behind the wall, whichever is asked first."""
    ramp = extrusion([[0, -1], [20, -1], [20, 0.4], [0, 0.0]], -5, 5).rotate((90, 0, 0)).translate((24.5 + clear, 0, 0))
    solids = {"base": rail(), "wall": box(25 + clear, 30 + clear, -9, 9, 1, 8), "ramp": ramp}
    solids |= {"mover": box(-10, 25, -10, 10, 0, 8)}
    assert ends(solids, x, None, 1e-3, names)[1] == pytest.approx(clear, abs=constants.STOP_LENGTH * 41.1)
