"""`self_locking`: a joint stays under its load when nothing drives it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from kinform.form.tables import Finite, Reference
from kinform.foundation.words import counted, telling
from kinform.frozen import dataclass
from kinform.model.findings import computed
from kinform.requirements.answer import Answer, met, undecided, violated
from kinform.requirements.driving import driven_in, worst
from kinform.requirements.evidence import Evidence
from kinform.requirements.joints import Poses, effort
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import JOINT, JOINT_VALUES
from kinform.requirements.table import RequirementTable

REMEDY = "Take a smaller lead, a larger radius or a greater coefficient at rest, or add a brake."
LOAD = "State the load: a [[function.load]], or gravity with the masses."


class SelfLocking(RequirementTable):
    """A joint stays under its load when nothing drives it."""

    kind: Literal["self_locking"]
    joint: Annotated[Reference, JOINT] = Field(description="a [[function.joint]], whose drive lets go")
    poses: Annotated[list[dict[str, Finite]], JOINT_VALUES] = Field(
        [], description="tables of joint = degrees or lengths; default the pose of the meshes"
    )


@dataclass(frozen=True, eq=False)
class SelfLockingRecord(Record):
    """A joint stays in these poses under the load when nothing drives it."""

    joint: str
    poses: Poses = ()


def judge(evidence: Evidence, wanted: SelfLockingRecord) -> Answer:
    """Whether friction holds the joint in all poses."""
    name = wanted.joint
    found = driven_in(evidence, name, wanted.poses)
    if isinstance(found, Answer):
        return found
    for shown, driving, _ in found:
        if driving.without == 0.0:
            return undecided(f"at {shown}: nothing loads joint '{name}', so that nothing is shown", LOAD)
    shown, driving, joint = worst(found, lambda one: one.least)
    if driving.locked:
        where = counted(len(found), "pose")
        return met(f"joint '{name}' stays under its load without a drive, in {where}", found="stays", intended="stays")
    words = telling(lambda value, digits: effort(value, joint, digits), driving.least, abs(driving.without))
    return violated(
        f"joint '{name}' does not stay under its load at {shown}: it takes {words(driving.least)} to hold it "
        f"({words(abs(driving.without))} without friction)",
        found=words(driving.least), intended="stays without a drive", place=joint.point, remedy=REMEDY,
        witness=computed(
            "loss by friction", driving.least, 0.0, without=abs(driving.without),
            friction=abs(driving.without) - driving.least,
        ),
    )  # fmt: skip


KIND = Kind("self_locking", 60, SelfLocking, SelfLockingRecord, judge, needs={"kinematics": "Run the stages before."})
