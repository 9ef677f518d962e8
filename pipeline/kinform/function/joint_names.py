"""Finds the joint that a name stands for, and how the designer's value of it reads in kinform's.

A name is that of a `[[function.joint]]`, or of a joint as kinform names it ("base~shoulder"). The
designer may list the bodies in the other order and turn the axis round; each reverses the value.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from kinform.frozen import dataclass
from kinform.model.assembly import Assembly
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint, Kinematics

NO_STOP_TURN = math.radians(2.0)
"""rad from the modelled pose within which an end of range is no stop, where contact does not hold the joint. Of 38
public robots those within 0.9° are teeth and bars of loops that touch as modelled; the next is at 5.9°."""
NO_STOP_SLIDE = 0.02
"""The same for prismatic joints, as a share of the width of the stated range. Chosen, not measured: the robots have
such ends at exactly 0 only."""


@dataclass(frozen=True, eq=False)
class Resolution:
    """What a name stands for. `joint` is None when there is no such joint; `reason` says why."""

    name: str
    intended: IntendedJoint | None
    """None when the name is one of kinform's own, or unknown."""
    bodies: tuple[str, str]
    """Bodies of the two sides in the designer's order; "" for a side that is unknown."""
    joint: Joint | None
    sign: int
    """Designer's value = sign · kinform's joint value."""
    reason: str = ""

    @staticmethod
    def own(joint: Joint) -> Resolution:
        """Of the name that kinform gives a joint."""
        return Resolution(str(joint.name), None, joint.bodies, joint, 1)


def resolve_joint(assembly: Assembly, kinematics: Kinematics, name: str) -> Resolution:
    """The joint that `name` stands for; never raises, a miss says its reason.

    A `[[function.joint]]` of that name goes before a joint that kinform names so.
    """
    intended = assembly.function.named_joints.get(name)
    if intended is not None:
        return _resolve_intended(assembly, kinematics, intended)
    joint = kinematics.named_joints.get(name)
    if joint is not None:
        return Resolution.own(joint)
    known = ", ".join([j.name for j in assembly.function.joints] + [j.name for j in kinematics.joints])
    return Resolution(name, None, ("", ""), None, 1, f'there is no joint "{name}"; known: {known or "none"}')


def stated_as(assembly: Assembly, kinematics: Kinematics, joint: str) -> tuple[str, int]:
    """The name that the designer gave a derived joint, else its own, and the sign of the designer's values against
    kinform's."""
    for intended in assembly.function.joints:
        resolution = resolve_joint(assembly, kinematics, intended.name)
        if resolution.joint is not None and resolution.joint.name == joint:
            return intended.name, resolution.sign
    return joint, 1


def stated_ranges(assembly: Assembly, kinematics: Kinematics) -> Iterator[tuple[str, tuple[float, float]]]:
    """(name of the derived joint, range in kinform's sign: rad or m), as the function states them, in its order."""
    for intended in assembly.function.joints:
        derived = resolve_joint(assembly, kinematics, intended.name)
        if intended.range is not None and derived.joint is not None:
            low, high = intended.range
            yield derived.joint.name, (low, high) if derived.sign > 0 else (-high, -low)


def no_stop_within(type: str, width: float) -> float:
    """rad or m from the modelled pose within which an end of range is no stop, of a joint of that type that contact
    does not hold and whose stated range has that width: what meets there touches as modelled."""
    return NO_STOP_SLIDE * width if type == "prismatic" else NO_STOP_TURN


def _resolve_intended(assembly: Assembly, kinematics: Kinematics, intended: IntendedJoint) -> Resolution:
    """The joint between the bodies that contain the two sides."""

    def missing(reason: str) -> Resolution:
        return Resolution(intended.name, intended, (first, second), None, 1, reason)

    first, why_first = _body(assembly, kinematics, intended.between[0])
    second, why_second = _body(assembly, kinematics, intended.between[1])
    if why_first or why_second:
        return missing(why_first or why_second)
    if first == second:
        return missing(f'both sides belong to the body "{first}"')
    found = kinematics.joints_between(first, second)
    if not found:
        return missing(f'the bodies "{first}" and "{second}" do not touch')
    if len(found) > 1:
        names = ", ".join(joint.name for joint in found)
        return missing(f'the bodies "{first}" and "{second}" have several joints: {names}')
    joint = found[0]
    return Resolution(intended.name, intended, (first, second), joint, _sign(intended, joint, first))


def _body(assembly: Assembly, kinematics: Kinematics, side: str) -> tuple[str, str]:
    """Name of the body that contains a part or group, or "" and the reason."""
    try:
        bodies = sorted({kinematics.body_of(part).name for part in assembly.parts_of(side)})
    except KeyError:
        return "", f'there is no part or group "{side}"'
    if len(bodies) != 1:
        return "", f'"{side}" is spread over the bodies {", ".join(bodies)}'
    return bodies[0], ""


def _sign(intended: IntendedJoint, joint: Joint, first: str) -> int:
    """+1 when the designer's value grows with kinform's, else −1."""
    sign = 1 if first == joint.bodies[0] else -1
    if intended.axis is not None and joint.axis is not None and np.dot(intended.axis, joint.axis) < 0.0:
        sign = -sign
    return sign
