"""The coupler of an RSSR linkage turns about the line of its balls: a stated mobility without that is no error."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.assemblies import assembly
from support.devices import joint
from support.solids import ball, box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform.consistency import check
from kinform.consistency.questions.passive_turns import passive_turns
from kinform.design import Design
from kinform.kinematics import derive
from kinform.model.kinematics import Body

A, B = np.array([20.0, 0, 20]), np.array([70.0, 30, 30])
PIVOT = (70, 30, 0)


def across(solid):
    """A solid about z, about y."""
    return solid.rotate((90, 0, 0))


def linkage(shape):
    """A crank about z and a rocker about y, whose balls a coupler of some shape joins."""
    journal = rod(5, -10, 10, 64) + rod(8, 10, 14, 64) + rod(8, -14, -10, 64)
    crank = journal + box(-4, 24, -4, 4, 10, 14) + rod(2, 10, 17, 32).translate((20, 0, 0))
    rocker = across(journal).translate(PIVOT) + box(66, 74, 40, 44, -4, 30)
    rocker += across(rod(2, -44, -30, 32)).translate((70, 0, 30))
    base = box(-20, 90, -20, 60, -30, -20) + box(-10, 10, -14, -10, -20, 10) + box(-10, 10, -10, 10, -10, 10)
    base += box(58, 82, 20, 40, -20, 12)
    base -= rod(5, -19, 11, 64) + across(rod(5, -60, 60, 64)).translate(PIVOT)
    along = B - A
    far = float(np.linalg.norm(along))
    bars = {"round": rod(2.5, 0, far, 48), "square": box(-3, 3, -3, 3, 0, far)}
    bars["with a lug"] = bars["round"] + box(2, 12, -1.5, 1.5, far / 2 - 6, far / 2 + 6)
    coupler = bars[shape] + ball(7, 48) + ball(7, 48).translate((0, 0, far))
    tilt, turn = math.acos(along[2] / far), math.atan2(along[1], along[0])
    coupler = coupler.rotate((0, math.degrees(tilt), 0)).rotate((0, 0, math.degrees(turn))).translate(tuple(A))
    for centre in (A, B):
        coupler -= ball(4, 48).translate(tuple(centre))
    coupler -= rod(3.2, 5, 20, 48).translate((20, 0, 0)) + across(rod(3.2, -60, -30, 48)).translate((70, 0, 30))
    crank, rocker = crank + ball(4, 48).translate(tuple(A)), rocker + ball(4, 48).translate(tuple(B))
    return {"base": base, "crank": crank, "coupler": coupler, "rocker": rocker}


@pytest.fixture(scope="module", params=["round", "square", "with a lug"])
def derived(request):
    X = random_pose(np.random.default_rng(1), 0.1)
    parts = [part(name, solid, X, 1e-3) for name, solid in linkage(request.param).items()]
    made = assembly(*parts, ground="base")
    found, touching = touching_of(made)
    return parts, found, touching, derive(made, found, touching)


def test_a_mobility_without_that_turn_is_no_error(derived):
    parts, found, touching, kinematics = derived
    assert sorted(one.type for one in kinematics.joints) == ["revolute", "revolute", "spherical", "spherical"]
    assert kinematics.mobility.effective + kinematics.mobility.idle == 2

    def outcome(mobility):
        stated = assembly(*parts, ground="base", mobility=mobility)
        (rule,) = (r for r in check(Design(stated, found, touching, kinematics)).rules if r.code == "KF301")
        return rule.outcome

    assert [outcome(mobility) for mobility in (0, 1, 2, 3)] == ["failed", "inconclusive", "passed", "failed"]


def balls(*centres):
    """Joints of a rod with as many others as there are centres."""
    return [joint("rod", f"b{k}", "spherical", None, centre) for k, centre in enumerate(centres)]


@pytest.mark.parametrize(
    ("joints", "turns"),
    [
        (balls((0, 0, 0), (1, 1, 0)), True),
        (balls((0, 0, 0), (1, 1, 0), (2, 2, 0)), True),
        (balls((0, 0, 0), (1, 1, 0), (2, 2, 0.1)), False),
        (balls((0, 0, 0)), False),
        (balls((0, 0, 0), (0, 0, 0)), False),
        ([*balls((0, 0, 0)), joint("rod", "b9", "revolute", (1, 0, 0), (1, 0, 0))], False),
        (
            [
                joint("rod", "b1", "revolute", (1, 0, 0), (0, 0, 0)),
                joint("rod", "b2", "revolute", (1, 0, 0), (1, 0, 0)),
            ],
            False,
        ),
    ],
    ids=["two", "three in line", "three", "a pendulum", "one centre", "a hinge at one end", "a door"],
)
def test_of_balls_in_a_line_alone_one_may_turn(joints, turns):
    bodies = [Body("rod", ("rod",), False)]
    assert passive_turns(bodies, joints, ()) == (("rod",) if turns else ())
    assert passive_turns(bodies, joints, ["rod"]) == ()
