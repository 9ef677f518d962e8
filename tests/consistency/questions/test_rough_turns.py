"""A pin with a rough mesh may be a solid of revolution: a mobility without its turn is no error then."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import assembly
from support.diagonal import diagonal
from support.solids import box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform.consistency import check
from kinform.design import Design
from kinform.kinematics import derive

AXLE = box(-30, 30, -30, 30, -20, -8) + rod(4, -5, 8) + rod(8, -8, 0) + rod(8, 6, 8)


def hinge(sides):
    """Two leaves about a headed pin."""
    fixed, moving = box(-40, -9, -1, 1, 0, 30), box(9, 40, -1, 1, 0, 30) + rod(6, 10, 20) + box(3, 10, -1, 1, 10, 20)
    for low in (0, 20):
        fixed += rod(6, low, low + 10) + box(-10, -3, -1, 1, low, low + 10)
    pin = rod(2, 0, 30, sides) + rod(4, -2, 0, sides) + rod(4, 30, 32, sides)
    hole = rod(2.05, -1, 31)
    return {"fixed": fixed - hole, "moving": moving - hole, "pin": pin}


def rough(one, share, seed=1):
    """A part whose vertices are off by up to a share of its size."""
    mesh = one.mesh
    off = np.random.default_rng(seed).uniform(-1.0, 1.0, mesh.vertices.shape)
    vertices = mesh.vertices + share * mesh.diagonal * off
    return replace(one, mesh=replace(mesh, vertices=vertices, digest=hashlib.sha256(vertices.tobytes()).hexdigest()))


def outcomes(solids, roughened, share, mobilities, scale=1e-3):
    """Of the rule, for each stated mobility; the first solid is ground."""
    X = random_pose(np.random.default_rng(3), 100 * scale)
    parts = [part(name, solid, X, scale) for name, solid in solids.items()]
    parts = [rough(one, share) if one.name == roughened else one for one in parts]
    made = assembly(*parts, ground=parts[0].name)
    found, touching = touching_of(made)
    kinematics = derive(made, found, touching)
    out = []
    for mobility in mobilities:
        stated = replace(made, function=replace(made.function, mobility=mobility))
        rules = check(Design(stated, found, touching, kinematics)).rules
        out += [rule.outcome for rule in rules if rule.code == "KF301"]
    return out


@diagonal(sides=[7, 9, 11], share=[1e-4, 1e-3], scale=[1e-3, 1.0])
def test_the_turn_of_a_rough_pin_may_count_or_not(sides, share, scale):
    below, without, with_it, above = outcomes(hinge(sides), "pin", share, (0, 1, 2, 3), scale)
    assert without in ("inconclusive", "passed")
    assert "failed" != with_it
    assert {below, above} <= {"failed", "inconclusive"}


def test_a_mobility_that_no_turn_of_the_pin_explains_is_an_error():
    assert outcomes(hinge(9), "pin", 1e-4, (0, 1, 3)) == ["failed", "inconclusive", "failed"]


@pytest.mark.parametrize(
    "more", [rod(3, 5, 15).translate((14, 0, 0)), box(18, 22, -2, 2, 0, 6)], ids=["a crank pin", "a lug"]
)
def test_what_is_seen_to_turn_counts_however_rough_it_is(more):
    wheel = rod(20, 0, 6) - rod(4.05, -1, 7) + more
    assert outcomes({"base": AXLE, "wheel": wheel}, "wheel", 1e-6, (0, 1)) == ["failed", "passed"]


def test_so_does_a_hole_beside_the_axis():
    wheel = rod(20, 0, 6) - rod(4.05, -1, 7) - rod(3, -1, 7).translate((12, 0, 0))
    assert outcomes({"base": AXLE, "wheel": wheel}, "wheel", 1e-6, (0, 1)) == ["failed", "passed"]
