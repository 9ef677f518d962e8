"""Ends are where parts first touch that are too deep in each other soon after: of either order and any place of them,
and whether facets that cross show it, or points that come in."""

from __future__ import annotations

from dataclasses import replace
from math import asin, atan2, hypot, radians
from types import SimpleNamespace

import numpy as np
import pytest
from support.assemblies import intended
from support.diagonal import diagonal, first
from support.solids import assembly, box, part, random_pose, rod

from kinform import collisions, contacts, kinematics, surfaces
from kinform.collisions.driving import alone
from kinform.collisions.driving.candidates import STOP_ANGLE, STOP_LENGTH
from kinform.collisions.pair.advancement import First
from kinform.collisions.pair.mate_surfaces import Mates

STATED = "prismatic"
SCALES = [1e-5, 1e-3, 1.0]
WITHIN = STOP_ANGLE


def stated_joint(kind, frame, mover, axis):
    """The function states it where contact leaves two readings."""
    return replace(intended("driven", "frame" if len(frame) > 1 else frame[0], mover, kind), axis=axis, point=None)


def ends(solids, along, X=None, scale=1e-3, names=None, stated=None):
    """(lower, upper) of the joint of a base and what moves on it (mm), of the latter about or along a direction; rad or
    mm. `names`: others."""
    X, names = np.eye(4) if X is None else X, names or {}
    X = np.block([[X[:3, :3], X[:3, 3:] * scale / 1e-3], [np.zeros((1, 3)), np.ones((1, 1))]])
    frame = tuple(names.get(name, name) for name in solids if name != "mover")
    mover = names.get("mover", "mover")
    joints = () if stated is None else (stated_joint(stated, frame, mover, X[:3, :3] @ along),)
    made = assembly(
        *(part(names.get(name, name), solid, X, scale) for name, solid in solids.items()),
        ground=None, joints=joints, groups=(("frame", frame),) if len(frame) > 1 else (),
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


OTHER_ORDER = {"base": "zz", "mover": "aa"}


@pytest.fixture(
    params=[
        pytest.param(({}, OTHER_ORDER), id="straight"),
        pytest.param((OTHER_ORDER, {}), id="turned", marks=pytest.mark.sweep),
    ]
)
def everywhere(request):
    """Tests the upper end at two places, at either in one order of the parts and turned round in the other."""
    placed = None, random_pose(np.random.default_rng(3))

    def stops(solids, along, expected, within, scale=1e-3, stated=None):
        for X, names in zip(placed, request.param, strict=True):
            assert ends(solids, along, X, scale, names, stated)[1] == pytest.approx(expected, abs=within)

    return stops


x, z = np.eye(3)[[0, 2]]


@diagonal(clear=[0.0, 0.05, 0.3, 1.0, 10.0], thick=[5.0, 0.1, 0.03], scale=SCALES)
def test_a_lever_stops_at_the_corner_of_a_bar_however_thin_and_near(clear, thick, scale, everywhere):
    """Points on a thin bar come in far from the corner that the lever meets first."""
    bar = box(20, 30, 4 + clear, 4 + clear + thick, -1, 8)
    everywhere({"base": plate() + bar, "mover": lever()}, z, touched(30, 4 + clear), WITHIN, scale)


@pytest.mark.parametrize("turn", first(1, [10, 90, 170]))
def test_a_lever_stops_at_a_wire_that_is_in_it_within_a_step(turn, everywhere):
    across = lambda s, t: (radians(turn) + atan2(t, 30 + s), hypot(30 + s, t))
    meets = min(a - asin(4 / r) for a, r in (across(s, t) for s in (-0.05, 0.05) for t in (-0.05, 0.05)))
    wire = box(29.95, 30.05, -0.05, 0.05, -1, 8).rotate((0, 0, turn))
    everywhere({"base": plate() + wire, "mover": lever()}, z, meets, WITHIN)


@pytest.mark.parametrize("clear", first(2, [1.0, 10.0, 3.0]))
def test_a_flush_slider_stops_where_its_corner_meets_a_wall_askew(clear, everywhere):
    """What they share there is flat, and no depth tells of it: the points beside it do, later."""
    wall = box(0, 5, -11, 11, -1, 10).rotate((0, 0, 3)).translate((25 + clear, 0, 0))
    slider = box(-10, 25, -10, 10, 0, 8)
    touch = clear - 10 * np.tan(radians(3))
    everywhere({"base": rail() + wall, "mover": slider}, x, touch, STOP_LENGTH * 41.1)


@pytest.mark.parametrize("into", first(1, [0.01, 0.001, 0.03]))
def test_what_is_drawn_in_its_stop_by_less_than_parts_may_scrape_is_at_its_stop(into, everywhere):
    bar = box(20, 30, 4 - into, 9, -1, 8)
    everywhere({"base": plate() + bar, "mover": lever()}, z, 0.0, WITHIN)
    wall = box(25 - into, 30, -11, 11, -1, 10)
    everywhere(
        {"base": rail() + wall, "mover": box(-10, 25, -10, 10, 0, 8)}, x, 0.0, STOP_LENGTH * 41.1, stated="prismatic"
    )


@pytest.mark.parametrize("away", [-0.5, 0.2, 0.5, 0.8])
def test_what_is_on_a_mate_with_a_gap_is_so_in_either_order(away):
    """A bore is 0.3 wider than its shaft: the one surface is no more the mate than the other is."""
    radii = {"bore": 10.3, "shaft": 10.0}
    surface = lambda radius: SimpleNamespace(kind="cylinder", axis=z, point=np.zeros(3), radius=radius)
    segment = np.array([[[10.0 + away, 0.0, 0.0], [10.0 + away, 0.0, 1.0]]])
    told = []
    for names in (("bore", "shaft"), ("shaft", "bore")):
        patch = SimpleNamespace(
            parts=("bore", "shaft"), surfaces=(0, 0), kind="cylinder", chord=0.0, gap=0.3, uncertainty=(0.0, 0.0)
        )
        own = [SimpleNamespace(surfaces=[surface(radii[name])]) for name in names]
        mates = Mates(names[0], [patch], (own[0], own[1]), ([{0}], [{0}]), 1.0)
        none = np.zeros(1, dtype=np.int64)
        told.append(bool(mates.along((none, none), (segment, segment))[0]))
    assert told == [0.3 - 0.6 <= away <= 0.6] * 2


class Known:
    """On the way to one side, of which it is known where the pair meets, and where that is seen."""

    def __init__(self, candidate, sign, s, whole):
        self.candidate, self.s, self.overlap = candidate, s, None

    def advance(self, reach):
        self.s = np.inf
        at, deep = self.candidate.at, self.candidate.deep
        return First(at, at, np.zeros(3), deep=deep) if deep <= reach else First(None, None, None)


@pytest.mark.parametrize(("deep", "expected"), [(1.052, 1.0), (1.06, 1.0), (1.5, 1.05)])
@pytest.mark.parametrize("turned", [False, True])
def test_the_end_is_where_the_first_met_of_those_that_are_too_deep_there(deep, expected, turned, monkeypatch):
    """Whichever is asked first; what would be too deep much further on is only scraped up to there."""
    pair = lambda name, at, deep: SimpleNamespace(
        part_names=(name, "z"), at=at, deep=deep, beyond=0.02, turns=None, units="m"
    )
    candidates = [pair("x", 1.0, deep), pair("y", 1.05, 1.055)]
    monkeypatch.setattr(alone, "Approach", Known)
    end, _ = alone._end(candidates[::-1] if turned else candidates, -1, 3.0, 0.0)
    assert (end.status, end.value) == ("found", -expected)
