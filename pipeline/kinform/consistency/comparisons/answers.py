"""One of five answers for every intended joint: what contact says of it.

agrees: contact gives this joint (or both sides are one body, where fixed is intended). not held: contact leaves the
intended motion free, and more. contradicts: contact forbids it, or gives the joint about another axis. no contact: the
bodies do not touch, or one of them has no geometry. undecided: contact may be read in several ways.
"""

from __future__ import annotations

from dataclasses import dataclass

from kinform.consistency.comparisons.intended_joints import Comparison, compare_joint
from kinform.kinematics.bodies.complete import leaves_free
from kinform.kinematics.bodies.extents import Extents
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.kinematics import Blocker, Kinematics

ANSWERS = ("agrees", "not held", "contradicts", "no contact", "undecided")


@dataclass(frozen=True, eq=False)
class IntendedAnswer:
    """The answer for one intended joint, with what it rests on."""

    comparison: Comparison
    answer: str
    free: str
    """In words what contact leaves free, where it does not hold the joint."""
    blocked_by: tuple[Blocker, ...]


def answers_of(assembly: Assembly, contacts: Contacts | None, kinematics: Kinematics) -> tuple[IntendedAnswer, ...]:
    """The answers for all intended joints, in the order of the manifest."""
    size = Extents(assembly).assembly
    out = []
    for joint in assembly.function.joints:
        found = compare_joint(assembly, contacts, kinematics, joint)
        answer = _answer(found, assembly, size)
        free = found.joint.motion if answer == "not held" and found.joint is not None else ""
        out.append(IntendedAnswer(found, answer, free, () if found.joint is None else found.joint.blockers))
    return tuple(out)


def _answer(found: Comparison, assembly: Assembly, size: float) -> str:
    joint = found.joint
    if found.state == "one body":
        return "agrees" if found.right_type else "contradicts"
    if found.state == "stated":
        return "not held" if joint is not None and joint.status == "stated" and joint.motion else "no contact"
    if found.state in ("absent", "undecided"):
        return "no contact" if found.state == "absent" else "undecided"
    if not found.right_type:
        free = joint is not None and not found.through and leaves_free(joint, found.intended, size)
        return "not held" if free else "contradicts"
    angle, offset = found.angle, found.offset
    tilted = angle is not None and angle > assembly.tolerances.angle_limit() + found.angle_slack
    beside = offset is not None and offset > found.position_limit + found.position_slack
    return "contradicts" if tilted or beside else "agrees"
