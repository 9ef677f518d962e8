"""`torque_speed`: what a drive gives, and how fast, stays below the curve of its motor during the simulation."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from kinform.form.tables import ROWS_MOST, NonNegative, Reference
from kinform.foundation.words import number
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.findings import computed
from kinform.requirements.answer import Answer, undecided
from kinform.requirements.bounds import Compared
from kinform.requirements.evidence import Evidence
from kinform.requirements.joints import effort, is_driven, shown_value
from kinform.requirements.kind import Fault, Kind, Record
from kinform.requirements.quantity import JOINT, JOINT_EFFORT, Quantity
from kinform.requirements.runs import peak_beside_limit, run_of_joint
from kinform.requirements.table import RequirementTable

REMEDY = "Slow the motion, change the gear ratio, or take another motor."


class TorqueSpeed(RequirementTable):
    """What a drive gives, and how fast, stays below the curve of its motor during the simulation."""

    kind: Literal["torque_speed"]
    joint: Annotated[Reference, JOINT] = Field(description="a [[function.joint]] that is driven")
    speeds: Annotated[list[NonNegative], Quantity("joint_rate"), Field(min_length=2, max_length=ROWS_MOST)] = Field(
        description="degrees or lengths a second, ascending from 0; the last is the greatest speed"
    )
    efforts: Annotated[list[NonNegative], JOINT_EFFORT, Field(min_length=2, max_length=ROWS_MOST)] = Field(
        description="N·m or N that the drive can give at each of the speeds, straight between them; none greater than "
        "the one before"
    )


@dataclass(frozen=True, eq=False)
class TorqueSpeedRecord(Record):
    """Effort and speed of a joint's drive stay below a curve: (n,) speeds (rad/s or m/s), ascending from 0, and what it
    can give at each (N·m or N), never more than at the one before."""

    joint: str
    speeds: Array
    efforts: Array

    def used(self, speed: Array, effort: Array) -> Array:
        """(T,) by how much the points (|speed|, |effort|) would have to shrink towards the origin to lie on the curve:
        1 there, less below it. Beyond the greatest speed the curve falls to no effort at all."""
        unit = np.array([self.speeds[-1], self.efforts[0]])
        curve = np.column_stack([self.speeds, self.efforts]) / unit
        if curve[-1, 1] > 0.0:
            curve = np.vstack([curve, [1.0, 0.0]])
        points = np.abs(np.column_stack([speed, effort])) / unit
        # seen from the origin the curve turns from the axis of efforts to that of speeds
        angles = np.arctan2(curve[:, 0], curve[:, 1])
        edge = np.searchsorted(angles, np.arctan2(points[:, 0], points[:, 1]), side="left").clip(1, len(curve) - 1)
        start, along = curve[edge - 1], curve[edge] - curve[edge - 1]
        normal = np.column_stack([-along[:, 1], along[:, 0]])
        return np.asarray((normal * points).sum(axis=1) / (normal * start).sum(axis=1))


def faults(table: TorqueSpeed) -> Iterator[Fault]:
    """Curves that are none of a motor."""
    if len(table.speeds) != len(table.efforts):
        given = f"it has {len(table.speeds)} speeds and {len(table.efforts)} efforts"
        yield given, "give an effort for each of the speeds", "efforts"
    if table.speeds[0] != 0.0 or any(b <= a for a, b in pairwise(table.speeds)):
        yield "its speeds do not ascend from 0", "begin with 0, the stalled drive, and list each speed once", "speeds"
    if 0.0 in table.efforts[:-1] or any(b > a for a, b in pairwise(table.efforts)):
        wrong = "its efforts grow with speed, or are 0 before its greatest speed"
        yield wrong, "give what the drive can do at each speed, up to the greatest", "efforts"


def judge(evidence: Evidence, wanted: TorqueSpeedRecord) -> Answer:
    """The worst point of the motion beside the curve."""
    run = run_of_joint(evidence, wanted, dynamic=True)
    if isinstance(run, Answer):
        return run
    joint, simulation, column = run
    if not is_driven(evidence, joint):
        return undecided(f"nothing drives the joint '{wanted.joint}'", "Add a [[function.drive]] for it.")
    given, speed = simulation.joint_effort[:, column], simulation.joint_velocity[:, column]
    used = wanted.used(speed, given)
    known = np.where(np.isfinite(used), used, -np.inf)
    worst = int(known.argmax())
    remedy = REMEDY
    if np.isfinite(known[worst]):
        fast = shown_value(abs(float(speed[worst])), joint, evidence.units, 4)
        remedy = f"There it gives {effort(abs(float(given[worst])), joint, 4)} at {fast}/s. {REMEDY}"
    name = f"what the drive of joint '{wanted.joint}' gives, beside the curve of its motor,"
    compared = Compared(name, _percent, remedy, "1", joint.point)
    return peak_beside_limit(compared, simulation, used, 1.0, lambda k, value: computed(
        "share of a curve", value, 1.0, speeds=wanted.speeds, efforts=wanted.efforts, speed=speed[k], effort=given[k],
    ))  # fmt: skip


def _percent(value: float, digits: int) -> str:
    return f"{number(100.0 * value, digits)} %"


KIND = Kind(
    "torque_speed", 90, TorqueSpeed, TorqueSpeedRecord, judge,
    faults=faults, needs={"kinematics": "Run the stages before."},
)  # fmt: skip
