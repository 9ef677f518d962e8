"""`inertia`: a moment of inertia about an axis lies within bounds."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from kinform.form.tables import NonNegative, Reference, Vector
from kinform.foundation.words import direction, number
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.requirements.answer import Answer
from kinform.requirements.bounds import Compared, amount, beside_bounds, proof_of_amount, whose
from kinform.requirements.evidence import Evidence
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import DIRECTION, PLACE, POINT, Quantity
from kinform.requirements.table import RequirementTable, bound_faults

KG_M2 = Quantity("number", "kg·m²")
REMEDY = "Move material, or change the bound."


class Inertia(RequirementTable):
    """A moment of inertia about an axis through the centre of mass, or through a point, within bounds."""

    kind: Literal["inertia"]
    of: Annotated[Reference | None, PLACE] = Field(None, description="part or group; default all")
    axis: Annotated[Vector, DIRECTION] = Field(description="direction of the axis")
    point: Annotated[Vector | None, POINT] = Field(None, description="on the axis; default the centre of mass")
    minimum: Annotated[NonNegative | None, KG_M2] = Field(None, description="kg·m²")
    maximum: Annotated[NonNegative | None, KG_M2] = Field(None, description="kg·m²")


@dataclass(frozen=True, eq=False)
class InertiaRecord(Record):
    """A moment of inertia about a unit axis (3,), through a point (3,) m or the centre of mass, is between bounds
    (kg·m²)."""

    axis: Array
    of: str | None = None
    point: Array | None = None
    minimum: float | None = None
    maximum: float | None = None


def judge(evidence: Evidence, wanted: InertiaRecord) -> Answer:
    """The moment of inertia beside its bounds."""
    whole = amount(evidence, wanted.of)
    if isinstance(whole, Answer):
        return whole
    value = whole.about(wanted.axis, wanted.point)
    through = "the centre of mass" if wanted.point is None else "the point"
    name = f"the moment of inertia of {whose(wanted.of)} about {direction(wanted.axis)} through {through}"
    line = {"axis": wanted.axis} | ({} if wanted.point is None else {"point": wanted.point})
    proof = proof_of_amount("inertia about a line", whole, **line)
    compared = Compared(name, _shown, REMEDY, "kg·m²", whole.centre, proof=proof)
    # Relative error of the inertia for that of the mass: at equal proportions mass grows with the third power of the
    # size and inertia with the fifth.
    return beside_bounds(compared, value, (5.0 / 3.0) * whole.bound * value, wanted.minimum, wanted.maximum)


def _shown(value: float, digits: int) -> str:
    return f"{number(value, digits)} kg·m²"


KIND = Kind(
    "inertia", 130, Inertia, InertiaRecord, judge,
    faults=lambda table: bound_faults(table.minimum, table.maximum),
    needs={"mass": "Run `kinform mass`."},
)  # fmt: skip
