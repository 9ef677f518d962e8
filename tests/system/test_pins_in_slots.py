"""Pins, keys, balls and followers in slots and grooves: nothing certain is false, and the answer hangs on no pose.

The truth is known by construction (`support.grooved`). That an answer is `ambiguous` is right where a pin, whose
contact is of one instant, alone holds something; what is `determined` has to be the joint that there is.
"""

from __future__ import annotations

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings
from support.assemblies import HERE
from support.diagonal import diagonal, first_rows
from support.diagonal import first as first_of
from support.grooved import KINDS, Grooved, Pin, apart, in_world
from support.solids import assembly, derived, part, random_pose
from support.touching import touching as touching_of

from kinform import kinematics
from kinform.consistency.comparisons.answers import answers
from kinform.design import Design
from kinform.model.function import IntendedJoint

SIZE = 20.0
"""mm: of the mechanisms."""
SAME = 0.03
"""Sine up to which two spaces of motions are one."""

PINS = st.builds(
    Pin,
    play=st.sampled_from([0.0, 0.005, 0.01, 0.02, 0.05]),
    segments=st.sampled_from([12, 16, 24, 32, 48, 64, 96, 128]),
    phase=st.floats(0.0, 30.0),
)
SCALES = st.floats(-2.0, 1.5).map(lambda power: 1e-3 * 10.0**power)
IN_HELICES = [name for name in KINDS if "heli" in name or "twisted" in name or name == "barrel wave"]


def joint_of(made: Grooved, X=None, scale=1e-3):
    """(type, status), the twists (k, 6) and the reason of the joint of the two solids, which may keep apart."""
    found, _ = derived(X, scale, a=made.first, b=made.second)
    if len(found.bodies) == 1:
        return ("fixed", "determined"), np.zeros((0, 6)), ""
    if not found.joints:
        return ("none", "apart"), np.eye(6), ""
    (joint,) = found.joints
    return (joint.type, joint.status), joint.twists, joint.reason


def is_right(made: Grooved, X, scale, twists) -> bool:
    truths = (in_world(right, X, scale) for right in made.right)
    return any(apart(twists, truth, SIZE * scale, X[:3, 3]) < SAME for truth in truths)


def assert_nothing_false(name, pin, poses):
    """The same answer under each pose and scale, as far as it is certain, and a right one then."""
    made, answers = KINDS[name](pin), set()
    for X, scale in poses:
        answer, twists, reason = joint_of(made, X, scale)
        certain = answer[1] in ("determined", "inferred", "blocked")
        answers.add(answer if certain else answer[1])
        assert not certain or is_right(made, X, scale, twists), (answer, reason)
    assert len(answers) == 1, answers


def posed(seed, scale):
    rng = np.random.default_rng(seed)
    return random_pose(rng, 100.0 * scale), scale


ONCE_FALSE = [
    ("square corner", Pin(), 1),
    ("plate arc 2", Pin(play=0.05), 1),
    ("helical -40", Pin(segments=12, phase=23.0), 3),
    ("nose helix", Pin(play=0.05, segments=48), 1),
    ("helical 25", Pin(play=0.005, segments=48), 1),
    ("key corner", Pin(), 1),
    ("block corner", Pin(), 1),
    ("pad corner", Pin(), 1),
    ("barrel wave", Pin(segments=64), 1),
]


@pytest.mark.parametrize("case", first_of(1, ONCE_FALSE))
def test_nothing_certain_is_false_where_it_once_was(case):
    name, pin, seed = case
    assert_nothing_false(name, pin, [(np.eye(4), 1e-3), posed(seed, 1e-3)])


@settings(max_examples=2, deadline=None)
@given(name=st.sampled_from(sorted(KINDS)), pin=PINS, seed=st.integers(0, 2**32 - 1), scale=SCALES)
def test_nothing_certain_is_false(name, pin, seed, scale):
    assert_nothing_false(name, pin, [(np.eye(4), 1e-3), posed(seed, scale)])


@pytest.mark.sweep
@pytest.mark.parametrize("name", sorted(KINDS))
@settings(max_examples=12, deadline=None)
@given(pin=PINS, seed=st.integers(0, 2**20), scales=st.lists(SCALES, min_size=6, max_size=6))
def test_nothing_certain_is_false_of_any_kind(name, pin, seed, scales):
    assert_nothing_false(name, pin, [posed(seed + k, scale) for k, scale in enumerate(scales)])


@pytest.mark.parametrize("name", first_of(1, ["twisted -60", "helical 60", "nose helix"]))
def test_a_shaft_whose_pin_is_in_a_helical_slot_is_not_cylindrical(name):
    """Facets that hold a shaft in both senses were left out as what blocks it."""
    (kind, status), _, _ = joint_of(KINDS[name](Pin(play=0.01)))
    assert (kind, status) == ("fixed", "ambiguous")


ENDS = {"axial end": "prismatic", "bayonet end": "revolute", "bayonet hook": "prismatic", "helical end": "screw"}


@pytest.mark.parametrize("name", first_of(2, list(ENDS)))
def test_the_rounded_end_of_a_slot_may_be_a_stop(name):
    """Shaft and sleeve were one body, and determined."""
    made = KINDS[name](Pin(play=0.01))
    found, _ = derived(a=made.first, b=made.second)
    (joint,) = found.joints
    assert (joint.type, joint.status) == ("fixed", "ambiguous")
    assert [(reading.type, reading.cause) for reading in joint.readings] == [(ENDS[name], "stop")]


@diagonal(
    name=["bayonet corner", "square corner", "key corner"],
    stated=["cylindrical", "revolute", "prismatic", "fixed"],
)
def test_nothing_may_be_stated_of_a_corner(name, stated):
    """The pin may go either way, one at a time, and is at two stops."""
    assert answer_to(KINDS[name](Pin(play=0.01)), stated) == "undecided"


def answer_to(made: Grooved, stated: str, pitch=None):
    """What is said to a function that states this joint about the shaft."""
    X = random_pose(np.random.default_rng(6))
    axis = None if stated == "fixed" else X[:3, 2]
    place = X[:3, 3] if stated in ("revolute", "cylindrical", "screw") else None
    wanted = IntendedJoint("j", ("a", "b"), stated, axis, None, place, pitch, None, HERE.file, None)
    whole = assembly(part("a", made.first, X), part("b", made.second, X), joints=[wanted])
    known, touching = touching_of(whole)
    (answer,) = answers(Design(whole, known, touching, kinematics.derive(whole, known, touching)))
    return answer.answer


@pytest.mark.parametrize("stated", first_of(2, ["screw", "cylindrical", "revolute", "prismatic", "fixed"]))
def test_of_a_helical_slot_no_function_passes_and_none_is_an_error(stated):
    """Its flanks are of facets, whose direction is known to 11°: no pitch follows from them."""
    pitch = 0.06 if stated == "screw" else None
    assert answer_to(KINDS["helical 60"](Pin(play=0.01)), stated, pitch) == "undecided"


@pytest.mark.parametrize(("stated", "answer"), [
    ("revolute", "agrees"), ("cylindrical", "agrees"), ("prismatic", "undecided"), ("fixed", "undecided"),
])  # fmt: skip
def test_a_shaft_at_the_bottom_of_its_bore_whose_key_is_at_a_wall_may_turn_or_slide_as_well(stated, answer):
    """It was a blocked hinge, whatever the bottom is: a shaft at it that has no key was doubtful all the time."""
    assert answer_to(KINDS["key at bottom"](Pin()), stated) == answer


@pytest.mark.parametrize(("name", "stated", "answer"), first_rows(3, [
    ("axial end", "prismatic", "agrees"), ("bayonet end", "cylindrical", "undecided"),
    ("bayonet hook", "prismatic", "agrees"), ("axial end", "revolute", "undecided"),
    ("axial end", "cylindrical", "undecided"), ("bayonet end", "revolute", "agrees"),
    ("bayonet end", "prismatic", "undecided"),
]))  # fmt: skip
def test_of_an_end_what_leaves_it_may_be_stated(name, stated, answer):
    assert answer_to(KINDS[name](Pin(play=0.01)), stated) == answer
