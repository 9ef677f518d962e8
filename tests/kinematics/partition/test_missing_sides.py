"""Joints that name one side, or none: the bodies are those of both, or all ways of parting are listed."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from kinematics.partition.test_bodies import ARM, joint, stack
from random_assemblies.draw import Draw
from random_assemblies.machine_verdict import assembly_of, judge
from random_assemblies.machines import machine
from random_assemblies.rings import ring
from support.assemblies import assembly
from support.diagonal import first as first_of
from support.solids import box, part, rod
from support.touching import touching as touching_of

from kinform import kinematics
from kinform.errors import InputError
from kinform.kinematics.partition import find_missing_sides, partition
from kinform.kinematics.partition.candidate_splits import Splits
from kinform.model.function import Function


def opened(one, named=0):
    """The joint with its first sides named only."""
    return replace(one, between=tuple(name if k < named else "" for k, name in enumerate(one.between)), named=named)


def stated(whole, *joints, complete=("",)):
    return replace(whole, function=Function(joints=joints, complete=complete))


@cache
def arm():
    """The arm of `test_bodies`, its cover farther from the pivot: it is a flat beside the axis."""
    solids = stack()
    return shaped(**solids | {"cover": solids["cover"].translate((-5, 0, 0))})


@cache
def two_arms():
    """Two arms on the two ends of one axle, which is one part with the base."""
    base = box(-30, 30, -30, 30, -10, 10) + rod(5, -40, 40, 48)
    hole = rod(5.02, -50, 50, 48)
    up = box(-10, 60, -10, 10, 10, 20) - hole
    down = box(-60, 10, -10, 10, -20, -10) - hole
    return shaped(base=base, up=up, down=down)


@cache
def drawer():
    outside = box(-20, 20, -50, 50, -20, 20) - box(-10, 10, -60, 60, -10, 10)
    return shaped(case=outside, drawer=box(-10, 10, -30, 55, -10, 10))


def shaped(**solids):
    whole = assembly(*(part(name, solid, np.eye(4)) for name, solid in solids.items()))
    found, near = touching_of(whole)
    return whole, found, near


def bodies(whole, touching):
    whole, _ = find_missing_sides(whole, touching)
    return partition(whole, touching, whole.function.joints).parts


def candidates(whole, touching, one):
    """The candidate splits of one joint among no others: a part of each side, and how far along the axis they touch."""
    splits = Splits(stated(whole, one), touching, [one])
    return sorted((*split.names, round(split.beyond, 6)) for split in splits.candidates(0, {}))


@pytest.mark.parametrize("one", [opened(ARM), opened(ARM, 1), opened(replace(ARM, between=ARM.between[::-1]), 1)])
def test_one_side_or_none_gives_the_bodies_of_both(one):
    whole, _, touching = arm()
    assert {frozenset(parts) for parts in bodies(stated(whole, one), touching)} == {
        frozenset(parts) for parts in bodies(stated(whole, ARM), touching)
    }


def test_the_named_side_is_the_first_and_of_none_the_ground():
    whole, found, touching = arm()
    named, sides = find_missing_sides(stated(whole, opened(replace(ARM, between=("high", "base")), 1)), touching)
    assert sides[0].parts[0] == "high"
    assert sides[0].parts[1] in {"base", "cover"}
    assert named.function.joints[0].between == sides[0].parts
    assert named.function.as_named.joints[0].between == ("high", "")
    for ground, first in (("base", {"base", "cover"}), ("high", {"low", "high", "bolt_1", "bolt_2"})):
        _, sides = find_missing_sides(replace(stated(whole, opened(ARM)), ground=ground), touching)
        assert sides[0].parts[0] in first
    K = kinematics.derive(stated(whole, opened(ARM)), found, touching)
    assert [one.joint for one in K.sides] == ["turn"]
    assert (K.joints[0].type, K.joints[0].status) == ("revolute", "determined")


def test_two_journals_on_one_axis_are_listed():
    whole, _, touching = two_arms()
    one = joint("up", ("base", "up"), point=(0, 0, 0.015))
    with pytest.raises(InputError) as error:
        find_missing_sides(stated(whole, opened(one)), touching)
    assert len(error.value.problems) == 1
    assert candidates(whole, touching, opened(one)) == [("base", "down", 0.025), ("base", "up", 0.0)]
    other = joint("down", ("base", "down"))
    expected = bodies(stated(whole, one, other), touching)
    assert len(expected) == 3
    assert bodies(stated(whole, opened(one), other), touching) == expected
    assert bodies(stated(whole, opened(replace(one, between=("up", "base")), 1), other), touching) == expected
    with pytest.raises(InputError):
        find_missing_sides(stated(whole, opened(one), opened(other)), touching)


def test_an_axis_beside_the_journal_has_no_split():
    whole, _, touching = two_arms()
    off = joint("up", ("base", "up"), point=(0.0, 0.02, 0.0))
    with pytest.raises(InputError):
        find_missing_sides(stated(whole, opened(off)), touching)
    assert candidates(whole, touching, opened(off)) == []


def test_contact_far_along_the_axis_is_not_accepted():
    """A pair that turns about the same line, far from the joint, is a coincidence: it was taken."""
    whole, _, touching = arm()
    far = replace(ARM, point=np.array([0.0, 0.0, 0.2]))
    with pytest.raises(InputError):
        find_missing_sides(stated(whole, opened(far)), touching)
    assert candidates(whole, touching, opened(far)) == [("base", "low", 0.194)]
    assert bodies(stated(whole, far), touching) == bodies(stated(whole, ARM), touching)


def test_a_bracket_between_two_legs_may_be_of_the_frame():
    """It touches only the legs, not the frame that the other leg hangs on: it was given to that leg."""
    frame, bracket = box(-100, 100, -20, 20, -60, -40), box(-20, 20, -10, 10, -10, 10)
    left, right = box(20, 40, -10, 10, -10, 10), box(-40, -20, -10, 10, -10, 10)
    foot = box(20, 40, -10, 10, -30, -10)
    whole, _, touching = shaped(frame=frame, bracket=bracket, left=left, right=right, foot=foot)
    legs = [joint(name, ("frame", name), axis=(1, 0, 0), point=(0, 0, 0.012)) for name in ("left", "right")]
    knee = joint("knee", ("left", "foot"), axis=(1, 0, 0), point=(0.03, 0, -0.03))
    with pytest.raises(InputError):
        find_missing_sides(stated(whole, opened(legs[0]), legs[1], knee), touching)


@pytest.mark.parametrize("complete", [("",), ()])
def test_a_slider_needs_no_name(complete):
    whole, found, touching = drawer()
    slide = joint("slide", ("case", "drawer"), "prismatic", (0, 1, 0), None)
    K = kinematics.derive(stated(whole, opened(slide), complete=complete), found, touching)
    assert K.sides[0].parts == ("case", "drawer")
    assert [one.type for one in K.joints] == ["prismatic"]


def test_a_planar_joint_needs_no_point():
    """Without one, it was not known where a complete function's planar joint turns."""
    whole, _, touching = shaped(table=box(-50, 50, -50, 50, -10, 0), puck=rod(10, 0, 5, 32))
    slide = joint("slide", ("table", "puck"), "planar", (0, 0, 1), None)
    assert partition(whole, touching, [slide]).parts == (("puck",), ("table",))
    assert bodies(stated(whole, opened(slide)), touching) == (("puck",), ("table",))


def test_a_group_is_one_side():
    whole, _, touching = arm()
    whole = replace(whole, groups=assembly(groups=(("frame", ("base", "cover")),)).groups)
    _, sides = find_missing_sides(stated(whole, opened(replace(ARM, between=("frame", "low")), 1)), touching)
    assert sides[0].parts == ("frame", "low")


@pytest.mark.parametrize("seed", first_of(1, [3, 9]))
def test_machines_without_names(seed):
    """Every joint in turn without its names: exact as with them, or listed; and in any order."""
    drawn = machine(Draw([seed]))
    whole = assembly_of(drawn, seed)
    found, touching = touching_of(whole)
    joints = whole.function.joints
    told = 0
    for k in range(len(joints)):
        some = tuple(opened(one) if i == k else one for i, one in enumerate(joints))
        try:
            named, sides = find_missing_sides(stated(whole, *some), touching)
        except InputError:
            continue
        told += 1
        assert find_missing_sides(stated(whole, *some[::-1]), touching)[1] == sides
        assert judge(drawn, kinematics.derive(named, found, touching)).exact
    assert told


@pytest.mark.parametrize("seed", first_of(1, [123, 120]))
def test_a_ring_of_bodies_without_any_name(seed):
    """It comes apart at all joints at once; in 120 a bearing's ring was held at the side that it was found at."""
    drawn = ring(Draw([seed]), largest=True)
    whole = assembly_of(drawn, seed, sides=0)
    found, touching = touching_of(whole)
    named, sides = find_missing_sides(whole, touching)
    assert find_missing_sides(stated(whole, *whole.function.joints[::-1]), touching)[1] == sides
    assert judge(drawn, kinematics.derive(named, found, touching)).exact
