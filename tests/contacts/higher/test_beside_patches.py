"""Pins that hold what a bore, a socket or a cone leaves are seen beside it, and nothing else is."""

from __future__ import annotations

import numpy as np
import pytest
from support.diagonal import diagonal
from support.solids import ball, box, derived, random_pose, rod

SHAFT = rod(6, -25, 25, 56, 3.0)
BLOCK = box(-12, 12, -12, 12, -12, 12) - rod(6, -13, 13, 64)


def across(solid, radius, start, end, segments=24, phase=5.0):
    """The solid with a pin along y."""
    return solid + rod(radius, start, end, segments, phase).rotate((-90, 0, 0))


def slotted(play):
    return BLOCK - box(-1 - play, 1 + play, 0, 13, -9, 9)


def grooved(play):
    return BLOCK - box(-13, 13, 0, 13, -1 - play, 1 + play)


def flat():
    """A pin of the block on a flat of the shaft, the length of it."""
    shaft = SHAFT - box(-7, 7, 4, 9, -26, 26)
    return BLOCK + rod(1, -8, 8, 32).rotate((0, 90, 0)).translate((0, 5, 0)), shaft


def ball_and_pin(play):
    socket = box(-14, 14, -12, 12, -12, 4) - ball(8, 64)
    slot = box(-1 - play, 1 + play, 0, 13, -13, 5)
    return socket - slot, across(ball(8, 72) + rod(3, 0, 30, 32), 1, 4, 11)


def nose_in_slot(play):
    return slotted(play), SHAFT + ball(1, 32).translate((0, 6.5, 0))


CASES = {
    "slot along": (lambda play: (slotted(play), across(SHAFT, 1, 4, 11)), "prismatic", 1, "line"),
    "slot around": (lambda play: (grooved(play), across(SHAFT, 1, 4, 11)), "revolute", 1, "line"),
    "ball in a slot": (nose_in_slot, "prismatic", 1, "point"),
    "ball joint": (ball_and_pin, "general", 2, "line"),
}


@diagonal(name=list(CASES), play=[0.0, 0.03], scale=[1e-5, 1e-3, 0.3])
def test_what_a_pin_holds_is_not_free(name, play, scale):
    """A shaft whose pin runs in a slot was cylindrical, and determined."""
    build, kind, freedoms, touch = CASES[name]
    block, shaft = build(play)
    pose = np.eye(4) if scale == 1e-3 else random_pose(np.random.default_rng(3))
    found, touching = derived(pose, scale, block=block, shaft=shaft)
    assert {patch.kind for patch in touching.patches} > {touch}
    (joint,) = found.joints
    assert (joint.type, joint.freedoms, joint.status) == (kind, freedoms, "ambiguous")


def test_one_line_on_a_flat_keeps_a_shaft_from_turning():
    block, shaft = flat()
    found, _ = derived(random_pose(np.random.default_rng(4)), block=block, shaft=shaft)
    (joint,) = found.joints
    assert (joint.type, joint.status) == ("prismatic", "ambiguous")


@pytest.mark.parametrize("play", [0.5, 2.0])
def test_a_pin_with_much_play_holds_nothing(play):
    found, touching = derived(block=slotted(play), shaft=across(SHAFT, 1, 4, 11))
    assert [patch.kind for patch in touching.patches] == ["cylinder"]
    assert [(joint.type, joint.status) for joint in found.joints] == [("cylindrical", "determined")]


def test_a_pin_at_one_wall_is_a_stop():
    """It opposes the turn in one sense only."""
    block = BLOCK - box(-1, 9, 0, 13, -9, 9)
    found, touching = derived(block=block, shaft=across(SHAFT, 1, 4, 11))
    assert [patch.kind for patch in touching.patches] == ["cylinder"]
    assert [(joint.type, joint.status) for joint in found.joints] == [("cylindrical", "determined")]


def test_what_a_face_holds_already_is_not_said_again():
    """A pin and a key in one shaft: the key is enough."""
    shaft = across(SHAFT, 1, 4, 11) + box(-11, -5, -1.5, 1.5, -6, 6)
    block = slotted(0.0) - box(-13, 0, -1.5, 1.5, -13, 13)
    found, touching = derived(block=block, shaft=shaft)
    assert "line" not in {patch.kind for patch in touching.patches}
    assert [(joint.type, joint.status) for joint in found.joints] == [("prismatic", "determined")]
