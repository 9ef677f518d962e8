"""`fit`: the clearance between two parts or groups lies within bounds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Annotated, Literal

from pydantic import Field

from kinform.form.tables import Finite, Pair
from kinform.foundation.words import counted, length, quoted
from kinform.frozen import dataclass
from kinform.model.findings import computed
from kinform.requirements.answer import Answer, least, met, undecided, worst_of
from kinform.requirements.bounds import Compared, Proof, beside_bounds, shared_parts
from kinform.requirements.evidence import Evidence, FitClearance
from kinform.requirements.kind import Fault, Kind, Record
from kinform.requirements.quantity import LENGTH, PLACE
from kinform.requirements.table import RequirementTable, bound_faults, side_faults

TITLES = {"radial": "radial clearance", "both sides": "clearance between planes", "gap": "gap between planes"}
REMEDY = "Change one of the two sizes."


class Fit(RequirementTable):
    """A clearance between two parts within bounds; negative is press."""

    kind: Literal["fit"]
    between: Annotated[Pair, PLACE] = Field(description="two parts or groups")
    minimum: Annotated[Finite | None, LENGTH] = Field(None, description="least clearance")
    maximum: Annotated[Finite | None, LENGTH] = Field(None, description="greatest clearance")


@dataclass(frozen=True, eq=False)
class FitRecord(Record):
    """A clearance between two parts or groups, between bounds (m); negative is press."""

    between: Sequence[str]
    minimum: float | None = None
    maximum: float | None = None


def faults(table: Fit) -> Iterator[Fault]:
    """Bounds that exclude everything, and sides that are one."""
    yield from bound_faults(table.minimum, table.maximum)
    yield from side_faults(table.between)


def judge(evidence: Evidence, wanted: FitRecord) -> Answer:
    """Every fit of the two beside the bounds."""
    between = wanted.between
    if shared := shared_parts(evidence, between):
        return undecided(f"{quoted(shared)} would be on both sides", "Name two that share no part.")
    first, second = (evidence.assembly.parts_of(name) for name in between)
    fits = evidence.fits(first, second)
    if not fits:
        return undecided(
            f"no surfaces of {quoted(between)} mate within the contact tolerance",
            "Raise [tolerances] contact, or see KF203.",
        )

    def shown(value: float, digits: int) -> str:
        return length(value, evidence.units, digits)

    answers = []
    for fit in fits:
        name = f"the {TITLES[fit.kind]} of {quoted(between)}"
        compared = Compared(name, shown, REMEDY, "m", fit.place, cause="by the fit of the surfaces", proof=_proof(fit))
        answers.append(beside_bounds(compared, fit.value, fit.error, wanted.minimum, wanted.maximum))
    whole = worst_of(answers) or met(f"{counted(len(fits), 'fit')} within bounds; {answers[0].message}")
    return whole if whole.state == "undecided" else replace(whole, margin=least(answer.margin for answer in answers))


def _proof(fit: FitClearance) -> Proof | None:
    if not fit.numbers:
        return None
    return lambda off, error, bounds: computed(
        "fit of surfaces", off, error, parts=fit.parts, gap=fit.value, **fit.numbers, **bounds
    )


KIND = Kind("fit", 160, Fit, FitRecord, judge, faults=faults, needs={"contacts": "Give both parts meshes."})
