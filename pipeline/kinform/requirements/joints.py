"""Joints of requirements: the derived joint that a name stands for, and its values in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kinform.foundation.rounding import ARITHMETIC
from kinform.foundation.words import angle, counted, length, number
from kinform.model.kinematics import Joint
from kinform.requirements.answer import Answer, undecided
from kinform.requirements.evidence import Evidence

Poses = Sequence[Mapping[str, float]]
"""Values (rad or m) of joints by their names; none: the pose of the meshes."""


def single_joint(evidence: Evidence, name: str) -> Joint | Answer:
    """The derived joint that a name stands for, where it has one freedom; else why not. Needs kinematics."""
    resolution = evidence.resolve(name)
    joint = resolution.joint
    if joint is None:
        why = f"joint '{name}' is not found: {resolution.reason}"
        return undecided(why, "Name a joint that geometry has: see KF401.")
    if joint.status == "ambiguous":
        return undecided(f"joint '{name}' is ambiguous: {joint.reason}", "See KF901.")
    if joint.freedoms != 1 or joint.type == "general":
        freedoms = counted(joint.freedoms, "freedom")
        return undecided(
            f"joint '{name}' is {joint.type}, with {freedoms}: one value does not describe it",
            "Require it of a joint with one freedom.",
        )
    return joint


def is_driven(evidence: Evidence, joint: Joint) -> bool:
    """Whether anything is stated that acts on a derived joint."""
    return any(evidence.resolve(drive.joint).joint is joint for drive in evidence.function.drives)


def pose_words(evidence: Evidence, pose: Mapping[str, float]) -> str:
    """A pose in words."""
    if not pose:
        return "the pose of the meshes"
    shown = []
    for name, value in sorted(pose.items()):
        joint = evidence.resolve(name).joint
        text = f"{value:g}" if joint is None else shown_value(value, joint, evidence.units)
        shown.append(f"{name} = {text}")
    return ", ".join(shown)


def shown_value(value: float, joint: Joint, units: str, digits: int = 4) -> str:
    """A joint value (rad or m)."""
    return length(value, units, digits) if _slides(joint) else angle(value, digits)


def effort(value: float, joint: Joint, digits: int = 4) -> str:
    """A joint's effort; rounding is shown as nothing."""
    value = 0.0 if abs(value) < ARITHMETIC else value
    return f"{number(value, digits)} {unit_of_effort(joint)}"


def unit_of_effort(joint: Joint) -> str:
    """N or N·m."""
    return "N" if _slides(joint) else "N·m"


def unit_of_value(joint: Joint) -> str:
    """m or rad."""
    return "m" if _slides(joint) else "rad"


def _slides(joint: Joint) -> bool:
    return joint.type == "prismatic"
