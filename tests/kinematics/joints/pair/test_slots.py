"""A function that states what a pin in a slot holds is answered, and no other."""

from __future__ import annotations

import numpy as np
import pytest
from support.assemblies import HERE, assembly
from support.diagonal import diagonal
from support.solids import box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import kinematics
from kinform.consistency.comparisons.answers import answers
from kinform.design import Design
from kinform.model.function import IntendedJoint

SHAFT = rod(6, -25, 25, 56, 3.0)
PIN = rod(1, 4, 11, 24, 5.0).rotate((-90, 0, 0))
BLOCK = box(-12, 12, -12, 12, -12, 12) - rod(6, -13, 13, 64)
COLLARS = rod(9, -15, -12, 56) + rod(9, 12, 15, 56)


def slotted(play=0.0):
    return BLOCK - box(-1 - play, 1 + play, 0, 13, -9, 9)


def grooved(play=0.0):
    return BLOCK - box(-13, 13, 0, 13, -1 - play, 1 + play)


def between_pegs():
    """Of the slot, no more than two pegs beside the pin: it leaves them as it slides."""
    pegs = rod(1.5, 6.2, 12, 32, 4.0).rotate((-90, 0, 0))
    return BLOCK - box(-6, 6, 0, 13, -9, 9) + pegs.translate((2.5, 0, 0)) + pegs.translate((-2.5, 0, 0))


def tongue(eccentric, play):
    """A small pin near the axis, whose play lets it turn all the more."""
    shaft = rod(6, 0, 40, 56, 3.0) + rod(0.5, -3, 1, 32).translate((eccentric, 0, 0))
    wide = 0.5 + play
    return box(-12, 12, -12, 12, -6, 30) - rod(6, -1, 50, 64) - box(-3, 3, -wide, wide, -4, 1), shaft


def found(block, shaft, type_, along=(0, 0, 1), pose=None, scale=1e-3):
    """The joint, and the answer to a function that states one along `along`."""
    X = random_pose(np.random.default_rng(6)) if pose is None else pose
    axis = None if type_ == "fixed" else X[:3, :3] @ np.array(along, float)
    place = X[:3, 3] if type_ in ("revolute", "cylindrical") else None
    wanted = IntendedJoint("j", ("block", "shaft"), type_, axis, None, place, None, None, HERE.file, None)
    made = assembly(part("block", block, X, scale), part("shaft", shaft, X, scale), joints=[wanted])
    known, touching = touching_of(made)
    derived = kinematics.derive(made, known, touching)
    (joint,) = derived.joints
    (answer,) = answers(Design(made, known, touching, derived))
    return joint, answer.answer


HELD = {
    "slot along": (slotted, SHAFT + PIN, "prismatic", "cylindrical"),
    "slot around": (grooved, SHAFT + PIN, "revolute", "cylindrical"),
    "slot along, and collars": (slotted, SHAFT + PIN + COLLARS, "fixed", "revolute"),
}


@diagonal(name=list(HELD), scale=[1e-5, 1e-3, 1.0], play=[0.0, 0.03])
def test_the_joint_that_the_pin_constrains_may_be_stated(name, scale, play):
    block, shaft, kind, free = HELD[name]
    joint, answer = found(block(play), shaft, kind, scale=scale)
    assert (joint.type, joint.status, answer) == (kind, "inferred", "agrees")
    assert joint.evidence[-1] == "function"
    assert [(reading.type, reading.cause) for reading in joint.readings] == [(free, "pin")]


@pytest.mark.parametrize("stated", ["fixed", "revolute", "prismatic", "cylindrical", "planar"])
@pytest.mark.parametrize("name", HELD)
def test_no_other_joint_may_be_stated(name, stated):
    """Least of all the motion that the pin stops."""
    block, shaft, kind, _ = HELD[name]
    if stated != kind:
        joint, answer = found(block(), shaft, stated)
        assert (joint.type, joint.status, answer) == (kind, "ambiguous", "undecided")


def test_another_direction_may_not_be_stated():
    joint, answer = found(slotted(), SHAFT + PIN, "prismatic", along=(1, 0, 0))
    assert (joint.status, answer) == ("ambiguous", "undecided")


@pytest.mark.parametrize("stated", ["prismatic", "cylindrical"])
def test_a_pin_between_rounds_is_in_doubt_as_before(stated):
    joint, answer = found(between_pegs(), SHAFT + PIN, stated)
    assert (joint.type, joint.status, joint.readings, answer) == ("prismatic", "ambiguous", (), "undecided")


def test_a_pin_that_is_clear_of_its_slot_holds_nothing():
    joint, answer = found(slotted(2.0), SHAFT + PIN, "prismatic")
    assert (joint.type, joint.status, answer) == ("cylindrical", "determined", "not held")


@pytest.mark.parametrize(("play", "status"), [(0.01, "inferred"), (0.1, "ambiguous")])
def test_clearance_that_lets_the_shaft_turn_is_ambiguous(play, status):
    """0.6° and 5.7° to either side, of a lever of 1 mm."""
    joint, answer = found(*tongue(1.0, play), "prismatic")
    assert (joint.type, joint.status) == ("prismatic", status)
    assert answer == ("agrees" if status == "inferred" else "undecided")


def test_a_pin_of_which_the_vertices_scatter_is_in_doubt():
    rng = np.random.default_rng(8)
    rough = (SHAFT + PIN).warp_batch(lambda v: v + 0.004 * rng.normal(size=v.shape))
    joint, answer = found(slotted(), rough, "prismatic")
    assert joint.status in ("ambiguous", "blocked")
    assert answer in ("undecided", "not held")
