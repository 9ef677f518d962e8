"""Every intended joint of [function] as queries: are the freedoms there that the designer wants?"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.kinematics.queries.design_view import DesignView
from kinform.kinematics.queries.motion_query import QueryAnswer, query_twist
from kinform.model.arrays import Array
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import MotionKind


@dataclass(frozen=True, eq=False)
class IntendedMotion:
    """One freedom of an intended joint: turn, slide or screw by the twist (ω; v at the world's origin)."""

    kind: MotionKind
    twist: Array
    answer: QueryAnswer


@dataclass(frozen=True, eq=False)
class IntendedAnswer:
    """Are the freedoms of an intended joint there? `free` is None where the function does not say which they are."""

    joint: IntendedJoint
    free: bool | None
    motions: tuple[IntendedMotion, ...]
    text: str


def intended_answers(design: DesignView) -> tuple[IntendedAnswer, ...]:
    """The answer for each joint of [function], in the order of the manifest."""
    return tuple(_answer(design, joint) for joint in design.assembly.function.joints)


def _answer(design: DesignView, joint: IntendedJoint) -> IntendedAnswer:
    assert design.kinematics is not None
    bodies = [design.kinematics.body_of(design.assembly.parts_of(name)[0]).name for name in joint.between]
    if joint.type == "fixed":
        return _answer_fixed(design, joint, bodies)
    wanted = _motions(joint)
    if not wanted:
        return IntendedAnswer(joint, None, (), f"the {joint.type} joint states no axis or point")
    asked = tuple(
        IntendedMotion(kind, twist, query_twist(design, *joint.between, twist, kind)) for kind, twist in wanted
    )
    missing = [item for item in asked if not item.answer.free_in_assembly]
    if not missing:
        return IntendedAnswer(joint, True, asked, "every freedom is there, in the whole assembly")
    if bodies[0] == bodies[1]:
        return IntendedAnswer(joint, False, asked, "both sides are one body")
    if len(asked) == 1:
        return IntendedAnswer(joint, False, asked, "its freedom is not there, or one way only")
    return IntendedAnswer(joint, False, asked, f"of {len(asked)} freedoms {len(missing)} not there, or one way only")


def _answer_fixed(design: DesignView, joint: IntendedJoint, bodies: Sequence[str]) -> IntendedAnswer:
    assert design.kinematics is not None
    if bodies[0] == bodies[1]:
        return IntendedAnswer(joint, True, (), "both sides are one body")
    index = {str(body.name): k for k, body in enumerate(design.kinematics.bodies)}
    freedoms = design.kinematics.mobility.freedoms
    relative = freedoms[:, index[bodies[1]]] - freedoms[:, index[bodies[0]]]
    moves = bool(len(relative)) and float(np.abs(relative).max()) > SOLVED
    text = (
        "they move relative to each other" if moves else "they are two bodies that do not move relative to each other"
    )
    return IntendedAnswer(joint, not moves, (), text)


def _motions(joint: IntendedJoint) -> list[tuple[MotionKind, Array]]:
    """The freedoms that the joint has, as the designer states them; none where axis or point are missing."""
    no_axis = joint.axis is None and joint.type != "spherical"
    no_point = joint.point is None and joint.type not in ("prismatic", "planar")
    if no_axis or no_point or (joint.type == "universal" and joint.axis2 is None):
        return []
    point = np.zeros(3) if joint.point is None else joint.point
    twists = twists_of(joint.type, joint.axis, point, joint.pitch, joint.axis2)
    if joint.type == "planar" and joint.point is None:
        twists = twists[1:]
    turn: MotionKind = "screw" if joint.type == "screw" else "turn"
    return [(turn if twist[:3].any() else "slide", twist) for twist in twists]
