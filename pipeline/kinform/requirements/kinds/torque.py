"""`torque`: the effort that a joint's drive gives during the simulation stays below a limit."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from kinform.form.tables import Positive, Reference
from kinform.frozen import dataclass
from kinform.model.findings import Witness, computed
from kinform.requirements.answer import Answer, undecided
from kinform.requirements.bounds import Compared
from kinform.requirements.evidence import Evidence
from kinform.requirements.joints import effort, is_driven, unit_of_effort
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import JOINT, JOINT_EFFORT
from kinform.requirements.runs import peak_beside_limit, run_of_joint
from kinform.requirements.table import RequirementTable

REMEDY = "Slow the motion, balance what moves, or take a stronger drive."


class Torque(RequirementTable):
    """The peak effort of a joint during the simulation stays below a limit."""

    kind: Literal["torque"]
    joint: Annotated[Reference, JOINT] = Field(description="a [[function.joint]]")
    limit: Annotated[Positive, JOINT_EFFORT] = Field(description="N·m or N")
    when_run: bool = Field(False, description="true: a limit of the joint, asked about only when a run drives it")


@dataclass(frozen=True, eq=False)
class TorqueRecord(Record):
    """The effort of a joint's drive stays below `limit` (N·m or N) in the simulation."""

    joint: str
    limit: float


def judge(evidence: Evidence, wanted: TorqueRecord) -> Answer:
    """The peak effort beside its limit."""
    run = run_of_joint(evidence, wanted, dynamic=True)
    if isinstance(run, Answer):
        return run
    joint, simulation, column = run
    if not is_driven(evidence, joint):
        return undecided(f"nothing drives the joint '{wanted.joint}'", "Add a [[function.drive]] for it.")

    def shown(value: float, digits: int) -> str:
        return effort(value, joint, digits)

    def proof(k: int, value: float) -> Witness | None:
        carried = evidence.carried(joint, k)
        if carried is None:
            return computed("record of a run", value, wanted.limit, output=k, column=column, quantity=0.0)
        return computed("effort of motion", value, wanted.limit, quantity=0.0, **carried)

    compared = Compared(f"the effort of joint '{wanted.joint}'", shown, REMEDY, unit_of_effort(joint), joint.point)
    return peak_beside_limit(compared, simulation, np.abs(simulation.joint_effort[:, column]), wanted.limit, proof)


KIND = Kind("torque", 70, Torque, TorqueRecord, judge, needs={"kinematics": "Run the stages before."})
