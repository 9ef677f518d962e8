"""`efficiency`: of the work that the drive of a joint puts in against its load, a share comes out."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from kinform.form.tables import Finite, Reference
from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.model.findings import Witness, computed
from kinform.requirements.answer import Answer, Margin, met, undecided, violated
from kinform.requirements.driving import driven_in, worst
from kinform.requirements.evidence import Driving, Evidence
from kinform.requirements.joints import Poses
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import JOINT, JOINT_VALUES
from kinform.requirements.table import RequirementTable

REMEDY = "Take a steeper lead, a smaller radius, other materials or lubrication, or rolling bodies."
LOAD = "State the load: a [[function.load]], or gravity with the masses."


class Efficiency(RequirementTable):
    """Of the work that the drive of a joint puts in, moving slowly against the load, a share comes out."""

    kind: Literal["efficiency"]
    joint: Annotated[Reference, JOINT] = Field(description="a [[function.joint]], which the drive moves")
    minimum: Annotated[float, Field(gt=0, le=1)] = Field(description="share, between 0 and 1")
    poses: Annotated[list[dict[str, Finite]], JOINT_VALUES] = Field(
        [], description="tables of joint = degrees or lengths; default the pose of the meshes"
    )


@dataclass(frozen=True, eq=False)
class EfficiencyRecord(Record):
    """Of the work that a joint's drive puts in as it moves slowly against the load at least the share `minimum` comes
    out, in these poses."""

    joint: str
    minimum: float
    poses: Poses = ()


def judge(evidence: Evidence, wanted: EfficiencyRecord) -> Answer:
    """The least efficiency of all poses beside the minimum."""
    name = wanted.joint
    found = driven_in(evidence, name, wanted.poses)
    if isinstance(found, Answer):
        return found
    for shown, driving, _ in found:
        if driving.efficiency is None:
            return undecided(f"at {shown}: nothing loads joint '{name}', so that it has no efficiency", LOAD)
    shown, driving, joint = worst(found, lambda one: -(one.efficiency or 0.0))
    least = driving.efficiency or 0.0
    limit = f"at least {100.0 * wanted.minimum:.4g} %"
    value = f"{100.0 * least:.4g} %"
    text = f"moving joint '{name}' slowly against its load has an efficiency of {value} at {shown}"
    if least == 0.0:
        text = f"no effort moves joint '{name}' against its load at {shown}: friction grows with it"
    margin = Margin(least - wanted.minimum, "")
    if least < wanted.minimum:
        return violated(
            f"{text}, required is {limit}", found=value, intended=limit, place=joint.point, remedy=REMEDY,
            margin=margin, witness=_witness(driving, least, wanted.minimum),
        )  # fmt: skip
    text = f"{text}, the least of {counted(len(found), 'pose')}"
    return met(text, found=value, intended=limit, margin=margin)


def _witness(driving: Driving, least: float, minimum: float) -> Witness | None:
    """What the drive gives as it moves the joint against the load, beside the load; 0 where nothing does."""
    needed = 0.0 if least == 0.0 else driving.without / least
    return computed("loss by friction", minimum - least, 0.0, without=driving.without, needed=needed, minimum=minimum)


KIND = Kind("efficiency", 50, Efficiency, EfficiencyRecord, judge, needs={"kinematics": "Run the stages before."})
