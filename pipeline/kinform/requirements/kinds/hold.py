"""`hold`: the static effort that holds a joint in given poses stays below a limit."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from kinform.form.tables import Finite, Positive, Reference
from kinform.foundation.words import counted, telling
from kinform.frozen import dataclass
from kinform.model.findings import Witness, computed
from kinform.model.kinematics import Joint
from kinform.requirements.answer import Answer, Margin, met, undecided, violated
from kinform.requirements.driving import driven_in, worst
from kinform.requirements.evidence import Evidence
from kinform.requirements.joints import Poses, effort, pose_words, single_joint, unit_of_effort
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import JOINT, JOINT_EFFORT, JOINT_VALUES
from kinform.requirements.table import RequirementTable

REMEDY = "Balance the joint, lighten what it carries, or take a stronger drive."
STATE = "State masses, drives and joints so that the load is determined."


class Hold(RequirementTable):
    """The static effort that holds the poses stays below a limit."""

    kind: Literal["hold"]
    joint: Annotated[Reference, JOINT] = Field(description="a [[function.joint]]")
    limit: Annotated[Positive, JOINT_EFFORT] = Field(description="N·m or N")
    poses: Annotated[list[dict[str, Finite]], JOINT_VALUES] = Field(
        [], description="tables of joint = degrees or lengths; default the pose of the meshes"
    )


@dataclass(frozen=True, eq=False)
class HoldRecord(Record):
    """A joint takes at most `limit` (N·m or N) to hold poses: joint values by name, none for the pose of the meshes."""

    joint: str
    limit: float
    poses: Poses = ()


def judge(evidence: Evidence, wanted: HoldRecord) -> Answer:
    """The greatest holding effort of all poses beside the limit."""
    joint = single_joint(evidence, wanted.joint)
    if isinstance(joint, Answer):
        return joint
    if evidence.lacking("mass") is not None:
        return undecided("masses have not been computed", "Run `kinform mass`.")
    if evidence.function.rubs:
        return _with_friction(evidence, wanted)
    mechanism = evidence.mechanism()
    if isinstance(mechanism, str):
        return undecided(mechanism, "See KF401 and KF901.")
    most, where = -1.0, ""
    poses = wanted.poses or [{}]
    worst_pose = poses[0]
    for pose in poses:
        held = mechanism.effort(joint, pose)
        if isinstance(held, str):
            why = held.replace(f"'{joint.name}'", f"'{wanted.joint}'")
            return undecided(f"at {pose_words(evidence, pose)}: {why}", STATE)
        if abs(held) > most:
            most, where, worst_pose = abs(held), pose_words(evidence, pose), pose
    work = mechanism.work(joint, worst_pose) if most > wanted.limit else None
    witness = None if work is None else computed("work of weights", most, wanted.limit, **work)
    return _beside_limit(wanted, joint, most, where, len(poses), witness=witness)


def _with_friction(evidence: Evidence, wanted: HoldRecord) -> Answer:
    """The same where friction helps to hold."""
    found = driven_in(evidence, wanted.joint, wanted.poses)
    if isinstance(found, Answer):
        return found
    where, driving, joint = worst(found, lambda one: one.least)
    without = abs(driving.without)
    witness = computed(
        "loss by friction", driving.least, wanted.limit, without=without, friction=without - driving.least
    )
    return _beside_limit(wanted, joint, driving.least, where, len(found), without, witness)


def _beside_limit(
    wanted: HoldRecord, joint: Joint, most: float, where: str, poses: int, without: float | None = None,
    witness: Witness | None = None,
) -> Answer:  # fmt: skip
    """The greatest effort, found in the pose `where`, beside the limit; `without`: that without friction."""
    shown = telling(lambda value, digits: effort(value, joint, digits), most, wanted.limit)
    friction = "" if without is None else f", with friction at rest ({shown(without)} without friction)"
    text = f"joint '{wanted.joint}' takes {shown(most)} to hold {where}{friction}"
    limit = f"at most {shown(wanted.limit)}"
    margin = Margin(wanted.limit - most, unit_of_effort(joint))
    if most > wanted.limit:
        return violated(
            f"{text}, required is {limit}", found=shown(most), intended=limit, place=joint.point, remedy=REMEDY,
            margin=margin, witness=witness,
        )  # fmt: skip
    text = f"{text}, the most of {counted(poses, 'pose')}"
    return met(text, found=shown(most), intended=limit, margin=margin)


KIND = Kind("hold", 40, Hold, HoldRecord, judge, needs={"kinematics": "Run the stages before."})
