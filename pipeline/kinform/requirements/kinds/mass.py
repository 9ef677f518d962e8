"""`mass`: the mass of a part, a group or the whole lies within bounds."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from kinform.form.tables import NonNegative, Reference
from kinform.foundation import words
from kinform.frozen import dataclass
from kinform.requirements.answer import Answer
from kinform.requirements.bounds import Compared, amount, beside_bounds, proof_of_amount, whose
from kinform.requirements.evidence import Evidence
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import PLACE, Quantity
from kinform.requirements.table import RequirementTable, bound_faults

KG = Quantity("number", "kg")
REMEDY = "Change the shape, the material or the bound."


class Mass(RequirementTable):
    """A mass within bounds."""

    kind: Literal["mass"]
    of: Annotated[Reference | None, PLACE] = Field(None, description="part or group; default all")
    minimum: Annotated[NonNegative | None, KG] = Field(None, description="kg")
    maximum: Annotated[NonNegative | None, KG] = Field(None, description="kg")


@dataclass(frozen=True, eq=False)
class MassRecord(Record):
    """A part, a group or the whole (None) has a mass between bounds (kg)."""

    of: str | None = None
    minimum: float | None = None
    maximum: float | None = None


def judge(evidence: Evidence, wanted: MassRecord) -> Answer:
    """The mass beside its bounds."""
    whole = amount(evidence, wanted.of)
    if isinstance(whole, Answer):
        return whole
    compared = Compared(
        f"the mass of {whose(wanted.of)}",
        words.mass,
        REMEDY,
        "kg",
        whole.centre,
        proof=proof_of_amount("mass of shapes", whole),
    )
    return beside_bounds(compared, whole.mass, whole.bound * whole.mass, wanted.minimum, wanted.maximum)


KIND = Kind(
    "mass", 110, Mass, MassRecord, judge,
    faults=lambda table: bound_faults(table.minimum, table.maximum),
    needs={"mass": "Run `kinform mass`."},
)  # fmt: skip
