"""`balance`: the static imbalance about an axis, mass times distance of the centre of mass, stays below a limit."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field

from kinform.form.tables import Positive, Reference, Vector
from kinform.foundation.words import length, mass, number, quoted, telling
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.findings import computed
from kinform.requirements.answer import Answer, Margin, met, undecided, violated
from kinform.requirements.bounds import amount
from kinform.requirements.evidence import Evidence
from kinform.requirements.kind import Fault, Kind, Record
from kinform.requirements.quantity import DIRECTION, JOINT, PLACE, POINT, Quantity
from kinform.requirements.table import RequirementTable


class Balance(RequirementTable):
    """The static imbalance about an axis stays below a limit."""

    kind: Literal["balance"]
    of: Annotated[Reference, PLACE] = Field(description="part or group")
    joint: Annotated[Reference | None, JOINT] = Field(None, description="axis of this joint; or axis and point")
    axis: Annotated[Vector | None, DIRECTION] = Field(None, description="direction of the axis")
    point: Annotated[Vector | None, POINT] = Field(None, description="on the axis")
    limit: Annotated[Positive, Quantity("number", "kg·m")] = Field(
        description="kg·m: mass times distance from the axis"
    )


@dataclass(frozen=True, eq=False)
class BalanceRecord(Record):
    """An imbalance of at most `limit` (kg·m) about a joint's axis, or about an axis (3,) through a point (3,) m."""

    of: str
    limit: float
    joint: str | None = None
    axis: Array | None = None
    point: Array | None = None


def faults(table: Balance) -> Iterator[Fault]:
    """Two axes, or none."""
    line = (table.axis is not None, table.point is not None)
    if table.joint is not None and any(line):
        yield "it names a joint, and axis or point too", "keep the joint, or axis and point", "joint"
    elif table.joint is None and not all(line):
        yield "it names neither a joint nor axis and point", "name a joint, or give axis and point", None


def judge(evidence: Evidence, wanted: BalanceRecord) -> Answer:
    """The imbalance beside its limit."""
    whole = amount(evidence, wanted.of)
    if isinstance(whole, Answer):
        return whole
    line = _line(evidence, wanted)
    if isinstance(line, Answer):
        return line
    distance = whole.distance(*line)
    imbalance = whole.mass * distance
    shown = telling(lambda value, digits: f"{number(value, digits)} kg·m", imbalance, wanted.limit)
    limit = f"at most {shown(wanted.limit)}"
    text = (
        f"the imbalance of {quoted([wanted.of])} is {shown(imbalance)}: {mass(whole.mass)}, "
        f"{length(distance, evidence.units)} off the axis"
    )
    margin = Margin(wanted.limit - imbalance, "kg·m")
    if imbalance <= wanted.limit:
        return met(text, margin=margin)
    return violated(
        f"{text}, required is {limit}", found=shown(imbalance), intended=limit, place=whole.centre,
        remedy="Move material across the axis, or add a counterweight.", margin=margin,
        witness=computed(
            "imbalance about a line", imbalance, wanted.limit, parts=whole.parts, axis=line[0], point=line[1],
            **whole.numbers,
        ),
    )  # fmt: skip


def _line(evidence: Evidence, wanted: BalanceRecord) -> tuple[Array, Array] | Answer:
    """Axis and point: of the derived joint, else as stated."""
    if wanted.joint is None:
        if wanted.axis is None or wanted.point is None:
            return undecided("it names neither a joint nor axis and point", "Name a joint, or give axis and point.")
        return wanted.axis, wanted.point
    lacking = evidence.lacking("kinematics")
    if lacking is not None:
        return undecided(lacking, "Run `kinform joints`.")
    resolution = evidence.resolve(wanted.joint)
    for line in (resolution.joint, resolution.intended):
        if line is not None and line.axis is not None and line.point is not None:
            return line.axis, line.point
    return undecided(f"joint '{wanted.joint}' has no axis: {resolution.reason}", "Give axis and point.")


KIND = Kind("balance", 140, Balance, BalanceRecord, judge, faults=faults, needs={"mass": "Run `kinform mass`."})
