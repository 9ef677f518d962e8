"""`speed`: the speed of a joint during the simulation stays below a limit."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from kinform.form.tables import Positive, Reference
from kinform.frozen import dataclass
from kinform.model.findings import Witness, computed
from kinform.requirements.answer import Answer
from kinform.requirements.bounds import Compared
from kinform.requirements.evidence import Evidence
from kinform.requirements.joints import shown_value, unit_of_value
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import JOINT, Quantity
from kinform.requirements.runs import peak_beside_limit, run_of_joint, window
from kinform.requirements.table import RequirementTable


class Speed(RequirementTable):
    """The peak speed of a joint during the simulation stays below a limit."""

    kind: Literal["speed"]
    joint: Annotated[Reference, JOINT] = Field(description="a [[function.joint]]")
    limit: Annotated[Positive, Quantity("joint_rate")] = Field(description="degrees or lengths a second")
    when_run: bool = Field(False, description="true: a limit of the joint, asked about only when there is a run")


@dataclass(frozen=True, eq=False)
class SpeedRecord(Record):
    """The speed of a joint stays below `limit` (rad/s or m/s) in the simulation."""

    joint: str
    limit: float


def judge(evidence: Evidence, wanted: SpeedRecord) -> Answer:
    """The peak speed beside its limit."""
    run = run_of_joint(evidence, wanted)
    if isinstance(run, Answer):
        return run
    joint, simulation, column = run

    def shown(value: float, digits: int) -> str:
        return f"{shown_value(value, joint, evidence.units, digits)}/s"

    def proof(k: int, value: float) -> Witness | None:
        near = window(simulation, k)
        times, values = simulation.time[near], simulation.joint_position[near, column]
        return computed("rate of positions", value, wanted.limit, times=times, values=values, at=simulation.time[k])

    unit = f"{unit_of_value(joint)}/s"
    compared = Compared(f"the speed of joint '{wanted.joint}'", shown, "Slow the drive.", unit, joint.point)
    return peak_beside_limit(compared, simulation, np.abs(simulation.joint_velocity[:, column]), wanted.limit, proof)


KIND = Kind("speed", 80, Speed, SpeedRecord, judge, needs={"kinematics": "Run the stages before."})
