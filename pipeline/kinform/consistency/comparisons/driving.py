"""What the drive of a joint must give with friction, in poses as requirements state them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, undecided
from kinform.consistency.requirements import shown_value, single_joint, stated_as
from kinform.function import resolve_joint, stated_ranges
from kinform.model.function import PASSIVE
from kinform.model.kinematics import Joint
from kinform.statics.driving import Driving, driving

AT_END = 1e-6
"""rad or m: a pose at the very end of a range is inside."""


STATE = "State masses, drives, joints and friction so that the load is determined."
NO_FRICTION = "no friction is stated"
REMEDY = (
    'Add a [[function.drive]] with kind = "friction" for each joint that rubs, and the efficiency of each '
    "[[function.coupling]] that loses power."
)

Poses = Sequence[Mapping[str, float]]


def driven_in(context: Context, name: str, poses: Poses) -> list[tuple[str, Driving, Joint]] | Answer:
    """(pose in words, what the drive must give, the joint) in each of the poses; or why that is not known. Needs
    kinematics and masses."""
    joint = single_joint(context, name)
    if isinstance(joint, Answer):
        return joint
    if context.lacks("mass"):
        return undecided("masses have not been computed", "Run `kinform mass`.")
    if not context.function.rubs:
        return undecided(NO_FRICTION, REMEDY)
    out = []
    for pose in poses or [{}]:
        shown = pose_words(context, pose)
        values = values_of(context, pose)
        found = values if isinstance(values, str) else driving(context.design, joint.name, values, drives_of(context))
        if isinstance(found, str):
            why = found.replace(f"'{joint.name}'", f"'{name}'")
            return undecided(f"at {shown}: {why}", STATE)
        out.append((shown, found, joint))
    return out


def values_of(context: Context, pose: Mapping[str, float]) -> dict[str, float] | str:
    """The values (rad or m) of derived joints in a pose, in kinform's sense; or what is wrong with it."""
    assembly, kinematics = context.assembly, context.kinematics
    ranges = dict(stated_ranges(assembly, kinematics))
    out: dict[str, float] = {}
    for name, value in pose.items():
        resolution = resolve_joint(assembly, kinematics, name)
        if resolution.joint is None:
            return f"joint '{name}' is not found: {resolution.reason}"
        if resolution.joint.freedoms != 1:
            return f"joint '{name}' has several freedoms"
        own = str(resolution.joint.name)
        out[own] = resolution.sign * value
        lower, upper = ranges.get(own, (out[own], out[own]))
        if not lower - AT_END <= out[own] <= upper + AT_END:
            return f"joint '{stated_as(context, own)[0]}' would be outside of its range"
    return out


def drives_of(context: Context) -> list[str]:
    """Derived joints with drives that hold them."""
    found = [
        resolve_joint(context.assembly, context.kinematics, drive.joint).joint
        for drive in context.function.drives
        if drive.kind not in PASSIVE
    ]
    return [str(joint.name) for joint in found if joint is not None]


def pose_words(context: Context, pose: Mapping[str, float]) -> str:
    """The pose in words."""
    if not pose:
        return "the pose of the meshes"
    shown = []
    for name, value in sorted(pose.items()):
        joint = resolve_joint(context.assembly, context.kinematics, name).joint
        shown.append(f"{name} = {value:g}" if joint is None else f"{name} = {shown_value(value, joint, context.units)}")
    return ", ".join(shown)


def worst(
    found: Sequence[tuple[str, Driving, Joint]], measure: Callable[[Driving], float]
) -> tuple[str, Driving, Joint]:
    """The pose in which the measure is greatest, the first of equal ones."""
    return max(found, key=lambda one: measure(one[1]))
