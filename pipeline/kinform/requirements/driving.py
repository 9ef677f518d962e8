"""What the drive of a joint must give with friction, in the poses that a requirement states."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from kinform.model.kinematics import Joint
from kinform.requirements.answer import Answer, undecided
from kinform.requirements.evidence import Driving, Evidence
from kinform.requirements.joints import Poses, pose_words, single_joint

STATE = "State masses, drives, joints and friction so that the load is determined."
NO_FRICTION = "no friction is stated"
REMEDY = (
    'Add a [[function.drive]] with kind = "friction" for each joint that rubs, and the efficiency of each '
    "[[function.coupling]] that loses power."
)

InPose = tuple[str, Driving, Joint]
"""A pose in words, what the drive must give there, and the joint."""


def driven_in(evidence: Evidence, name: str, poses: Poses) -> list[InPose] | Answer:
    """What the drive must give in each of the poses; or why that is not known. Needs kinematics."""
    joint = single_joint(evidence, name)
    if isinstance(joint, Answer):
        return joint
    if evidence.lacking("mass") is not None:
        return undecided("masses have not been computed", "Run `kinform mass`.")
    if not evidence.function.rubs:
        return undecided(NO_FRICTION, REMEDY)
    out: list[InPose] = []
    for pose in poses or [{}]:
        shown = pose_words(evidence, pose)
        found = evidence.driving(joint, pose)
        if isinstance(found, str):
            why = found.replace(f"'{joint.name}'", f"'{name}'")
            return undecided(f"at {shown}: {why}", STATE)
        out.append((shown, found, joint))
    return out


def worst(found: Sequence[InPose], measure: Callable[[Driving], float]) -> InPose:
    """The pose in which the measure is greatest, the first of equal ones."""
    return max(found, key=lambda one: measure(one[1]))
