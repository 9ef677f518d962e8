"""What leaves an assembly and what stays: the answer follows from how each case is made, at any pose and size."""

from __future__ import annotations

import numpy as np
import pytest
from support.assemblies import assembly
from support.diagonal import diagonal
from support.numbers import numbers
from support.solids import ball, box, extrusion, part, random_pose, rod
from support.touching import touching

from kinform import kinematics
from kinform.consistency.context import Context
from kinform.consistency.requirements import answer
from kinform.design import Design
from kinform.model.function import Requirement

X, Y, Z = np.eye(3)


def design(solids, ground, groups=(), X=None, scale=1e-3):
    """A design through to its joints, of solids in units of `scale` (m)."""
    X = np.eye(4) if X is None else X
    made = assembly(*(part(n, solid, X, scale) for n, solid in solids.items()), ground=ground, groups=groups)
    known, found = touching(made)
    return Design(made, surfaces=known, contacts=found, kinematics=kinematics.derive(made, known, found))


def retained(made, name, directions=()):
    values = {"part": name, "directions": [list(map(float, d)) for d in directions]}
    return answer(Context(made), Requirement("r", "retained", values, "m.toml", 1))


def along_y(solid):
    """What is made along z, along y."""
    return solid.rotate((-90, 0, 0))


def shaft(*steps, segments=40):
    """Rods of (radius, from, to) along y."""
    first, *others = (along_y(rod(radius, low, high, segments)) for radius, low, high in steps)
    for other in others:
        first += other
    return first


def clevis(*pin):
    """A fork along x with two cheeks, an arm between them, and a pin of these steps through all three."""
    cheeks = box(-12, 12, -20, -10, -12, 12) + box(-12, 12, 10, 20, -12, 12) + box(-12, 12, -20, 20, -20, -12)
    return {
        "fork": cheeks - shaft((5.03, -30, 30)),
        "arm": box(-10, 10, -9.97, 9.97, -10, 60) - shaft((5.03, -30, 30)),
        "pin": shaft(*pin),
    }


def bearing(*steps):
    """A shaft of these steps in a bearing 30 long."""
    return {"base": box(-15, 15, -15, 15, -15, 15) - shaft((5.02, -20, 20)), "shaft": shaft(*steps)}


def dovetail(**more):
    """A slide along y in a guide, undercut."""
    inner = [(-10, 0), (10, 0), (6, 8), (-6, 8)]
    guide = box(-20, 20, -30, 30, -10, 8) - along_y_extrusion(inner, -40, 40)
    return {"guide": guide, "slide": along_y_extrusion(inner, -15, 15)} | more


def along_y_extrusion(outline, y0, y1):
    """An outline of (x, z), extruded along y."""
    return extrusion([(x, -z) for x, z in outline][::-1], y0, y1).rotate((-90, 0, 0))


def cup(top):
    """A ball of radius 8 in a block whose upper face is at `top` of its centre."""
    return {"block": box(-20, 20, -20, 20, -20, top) - ball(8.03, 64, 3), "ball": ball(8, 64)}


def screwed_lid():
    """A lid on a box, and two bolts through clearance holes of the lid, tight in the box."""
    base, lid = box(-30, 30, -20, 20, -20, 0), box(-30, 30, -20, 20, 0, 5)
    solids = {}
    for name, x in (("bolt_1", -20), ("bolt_2", 20)):
        base -= rod(2.0, -15, 1).translate((x, 0, 0))
        lid -= rod(2.5, -1, 6).translate((x, 0, 0))
        solids[name] = (rod(2.0, -15, 6) + rod(4.5, 5, 9)).translate((x, 0, 0))
    return {"base": base, "lid": lid} | solids


def stack():
    return {"table": box(-40, 40, -40, 40, -10, 0), "low": box(-10, 10, -10, 10, 0, 8), "top": box(-8, 8, -8, 8, 8, 15)}


def ring_between_collars(gap):
    """A ring on a shaft that is fixed, between two collars with that gap to each."""
    fixed = shaft((5, -30, 30), (8, -9, -5 - gap), (8, 5 + gap, 9))
    return {"shaft": fixed, "ring": shaft((9, -5, 5)) - shaft((5.02, -6, 6))}


def blind_hole(**more):
    return {"base": box(-20, 20, -20, 20, -20, 0) - rod(5.03, -15, 1), "peg": rod(5, -15, 10)} | more


def under_a_roof(gap, reach=40):
    """A block on a table, under a roof on two walls that is so far above it; the block reaches in between them."""
    walls = box(-40, 40, -40, -30, -10, 20 + gap) + box(-40, 40, 30, 40, -10, 20 + gap)
    frame = box(-40, 40, -40, 40, -10, 0) + walls + box(-40, 40, -40, 40, 20 + gap, 30 + gap)
    ends = box(-40, -reach, -40, 40, -10, 30 + gap) + box(reach, 40, -40, 40, -10, 30 + gap) if reach < 40 else None
    return {"frame": frame if ends is None else frame + ends, "block": box(-10, 10, -10, 10, 0, 20)}


def corner(**more):
    base = box(-20, 20, -20, 20, -20, 0) + box(-20, -10, -20, 20, -1, 20) + box(-20, 20, -20, -10, -1, 20)
    return {"base": base, "block": box(-10, 0, -10, 0, 0, 10)} | more


def door(shut):
    """A door on a pin that is one with its frame, headed, and at the jamb where it is shut."""
    frame = box(-20, 60, 12, 20, 0, 60) + box(-20, 60, -20, 20, -5, 0) + rod(4, -1, 62) + rod(8, 60.02, 66)
    leaf = box(0, 50, -6, 12 if shut else 8, 1, 60) + rod(9, 0.02, 60)
    return {"frame": frame, "leaf": leaf - rod(4.02, -1, 61)}


def recess(lift):
    """A block in a recess 1.2 deep, under a roof that lets it rise by `lift`; nothing else is in its way along x."""
    walls = box(-40, 40, -40, -11, -10, 20 + lift) + box(-40, 40, 11, 40, -10, 20 + lift)
    frame = box(-40, 40, -40, 40, -10, 1.2) - box(-10, 10, -10, 10, 0, 2) + walls
    return {"frame": frame + box(-40, 40, -40, 40, 20 + lift, 30), "block": box(-10, 10, -10, 10, 0, 20)}


CASES = {
    "headed pin without its clip": (clevis((5, -25, 24), (8, 20, 24)), "fork", "pin", Y),
    "headed pin with the head on the other side": (clevis((5, -24, 25), (8, -24, -20)), "fork", "pin", -Y),
    "pin with a head on both sides": (clevis((5, -24, 24), (8, 20, 24), (8, -24, -20)), "fork", "pin", None),
    "pin with a head, and one with play on the other side": (
        clevis((5, -25, 24), (8, 20, 24), (8, -26, -22)), "fork", "pin", None,
    ),
    "pin with play on both sides": (clevis((5, -25, 24), (8, 21, 24), (8, -26, -22)), "fork", "pin", None),
    "pin without a head": (clevis((5, -25, 25)), "fork", "pin", "either"),
    "shaft with a collar on one side": (bearing((5, -30, 30), (9, 15, 20)), "base", "shaft", Y),
    "shaft with two collars": (bearing((5, -30, 30), (9, 15, 20), (9, -20, -15)), "base", "shaft", None),
    "top of a stack": (stack(), "table", "top", "any"),
    "bottom of a stack": (stack(), "table", "low", "any"),
    "bottom of a stack under a loose roof": (
        stack() | {"roof": box(-40, 40, -40, 40, 15, 20)}, "table", "low", "any",
    ),
    "dovetail": (dovetail(), "guide", "slide", "either"),
    "dovetail with a loose block in its way": (
        dovetail(stop=box(-20, 20, 30, 35, -10, 20)), "guide", "slide", "either",
    ),
    "peg in a blind hole": (blind_hole(), "base", "peg", Z),
    "peg in a blind hole under a loose lid": (blind_hole(lid=box(-20, 20, -20, 20, 10, 15)), "base", "peg", Z),
    "ball in a cup": (cup(-3), "block", "ball", "any"),
    "ball in a socket beyond its equator": (cup(4), "block", "ball", None),
    "ring between two collars": (ring_between_collars(0.0), "shaft", "ring", None),
    "ring between two collars with play": (ring_between_collars(2.0), "shaft", "ring", None),
    "ring between two collars that touches nothing": (
        {
            "shaft": shaft((5, -20, 20), (8, -9, -5.9), (8, 5.9, 9), segments=12),
            "ring": shaft((9, -5, 5), segments=12) - shaft((5.9, -6, 6), segments=12),
        }, "shaft", "ring", None,
    ),
    "block that touches nothing": (
        {"table": box(-40, 40, -40, 40, -10, 0), "block": box(-5, 5, -5, 5, 3, 13)}, "table", "block", "any",
    ),
    "block under a roof slides out": (under_a_roof(0.0), "frame", "block", "any"),
    "block under a roof with play slides out": (under_a_roof(5.0), "frame", "block", "any"),
    "block in a closed box": (under_a_roof(0.0, 10), "frame", "block", None),
    "block in a closed box with a little play": (under_a_roof(0.8, 10.5), "frame", "block", "not certain"),
    "block in a recess that it can be lifted out of": (recess(1.7), "frame", "block", "any"),
    "block in a recess deeper than it can be lifted": (recess(1.1), "frame", "block", None),
    "block in a corner": (corner(), "base", "block", "any"),
    "door off its jamb": (door(shut=False), "frame", "leaf", None),
    "door on its jamb": (door(shut=True), "frame", "leaf", None),
}  # fmt: skip


def agrees(found, expected, pose):
    """An answer is that it leaves in the direction, or stays (None), or is "not certain" but does not leave."""
    if expected is None:
        assert found.state == "met", found.message
        return
    if isinstance(expected, str) and expected == "not certain":
        assert found.state != "violated", found.message
        return
    assert found.state == "violated", found.message
    way = np.array(numbers(found.found))
    if not isinstance(expected, str):
        assert float(way @ pose[:3, :3] @ expected) > 0.999
    elif expected == "either":
        assert abs(float(way @ pose[:3, :3] @ Y)) > 0.999


@diagonal(name=list(CASES), seed=[0, 1, 2])
def test_what_leaves_and_what_stays(name, seed):
    solids, ground, asked, expected = CASES[name]
    rng, scale = np.random.default_rng(seed), (1e-3, 0.2, 1e-4)[seed]
    pose = np.eye(4) if seed == 0 else random_pose(rng, 100.0 * scale)
    agrees(retained(design(solids, ground, X=pose, scale=scale), asked), expected, pose)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_lid_is_held_by_bolts_that_are_fastened(seed):
    pose = np.eye(4) if seed == 0 else random_pose(np.random.default_rng(seed), 0.1)
    fastened = design(screwed_lid(), "base", [("body", ("base", "bolt_1", "bolt_2"))], X=pose)
    assert retained(fastened, "lid").state == "met"
    loose = design(screwed_lid(), "base", X=pose)
    agrees(retained(loose, "bolt_1"), Z, pose)
    agrees(retained(loose, "lid"), Z, pose)


def test_what_is_between_listed_directions_is_listed():
    pose = random_pose(np.random.default_rng(5), 0.1)
    made = design(corner(), "base", X=pose)
    ways = [pose[:3, :3] @ d for d in (X, Y, Z)]
    assert retained(made, "block", ways).state == "met"
    assert retained(made, "block", ways[:2]).state == "violated"
    table = design(
        {"table": box(-40, 40, -40, 40, -10, 0), "block": box(-5, 5, -5, 5, 0, 10).rotate((0, 0, 30))}, "table"
    )
    every = [X, -X, Y, -Y, Z]
    assert retained(table, "block", every).state == "met"
    assert retained(table, "block", every[:3] + every[4:]).state == "violated"
