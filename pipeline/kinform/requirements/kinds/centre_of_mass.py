"""`centre_of_mass`: a centre of mass is near a point, at the pose of the meshes."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from kinform.form.tables import Positive, Reference, Vector
from kinform.foundation.words import length, place, telling
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.findings import computed
from kinform.requirements.answer import Answer, Margin, met, violated
from kinform.requirements.bounds import amount, whose
from kinform.requirements.evidence import Evidence
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import LENGTH, PLACE, POINT
from kinform.requirements.table import RequirementTable


class CentreOfMass(RequirementTable):
    """A centre of mass near a point, at the pose of the meshes."""

    kind: Literal["centre_of_mass"]
    of: Annotated[Reference | None, PLACE] = Field(None, description="part or group; default all")
    point: Annotated[Vector, POINT] = Field(description="where it should be")
    tolerance: Annotated[Positive, LENGTH] = Field(description="greatest distance from there")


@dataclass(frozen=True, eq=False)
class CentreOfMassRecord(Record):
    """A centre of mass is within `tolerance` (m) of a point (3,) m."""

    point: Array
    tolerance: float
    of: str | None = None


def judge(evidence: Evidence, wanted: CentreOfMassRecord) -> Answer:
    """The distance of the centre of mass from its point."""
    units = evidence.units
    whole = amount(evidence, wanted.of)
    if isinstance(whole, Answer):
        return whole
    distance = float(np.linalg.norm(whole.centre - wanted.point))
    shown = telling(lambda value, digits: length(value, units, digits), distance, wanted.tolerance)
    centre, aim, within = place(whole.centre, units), place(wanted.point, units), shown(wanted.tolerance)
    text = f"the centre of mass of {whose(wanted.of)} is at {centre}, {shown(distance)} from {aim}"
    margin = Margin(wanted.tolerance - distance, "m")
    if distance <= wanted.tolerance:
        return met(text, margin=margin)
    return violated(
        f"{text}, required is within {within}", found=centre, intended=f"within {within} of {aim}",
        place=whole.centre, remedy="Move material, or correct the point.", margin=margin,
        witness=computed(
            "centre off a point", distance, wanted.tolerance, parts=whole.parts, point=wanted.point, **whole.numbers
        ),
    )  # fmt: skip


KIND = Kind("centre_of_mass", 120, CentreOfMass, CentreOfMassRecord, judge, needs={"mass": "Run `kinform mass`."})
