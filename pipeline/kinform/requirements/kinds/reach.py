"""`reach`: a point, or a pointing direction, of a body covers a region.

`function.coverage` computes what is covered; rule KF421 reports what is not.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kinform.form.tables import NonNegative, Reference, Table, Vector
from kinform.foundation.words import angle, counted, direction, length, place, quoted
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.findings import Witness, computed
from kinform.requirements.answer import Answer, met, undecided, violated
from kinform.requirements.evidence import Carrier, Chain, Coverage, Evidence
from kinform.requirements.kind import Fault, Kind, Record, record_values
from kinform.requirements.quantity import ANGLE, DIRECTION, LENGTH, PLACE, POINT, Quantity
from kinform.requirements.regions import REGIONS, Region, Targets, targets_of
from kinform.requirements.table import RequirementTable

REACHED_SHARE = 1e-3
"""Share of the assembly's size within which a place is reached, where no tolerance is stated. Chosen, not measured:
0.3 mm of a device of 300 mm."""
REACHED_ANGLE = math.radians(0.1)
"""rad within which a direction is reached, where no tolerance is stated. Chosen, not measured: 0.5 mm at 300 mm, about
what the default of places is."""
SAMPLED_FREEDOMS = 2
"""Freedoms of closed loops up to which sampling is dense enough for a "no": the walk through 600 configurations leaves
a step of 24 by 24 in two freedoms, and of 8 a freedom in three."""
ENDLESS = 1e6
"""rad or m that stands for no bound in a witness, which holds finite numbers."""
OTHERWISE = "Check it by other means, or require `follow` of a simulated motion."
REMEDY = "Widen a range, lengthen a link, or move the base."


class Cone(Table):
    """Directions within half_angle of an axis."""

    type: Literal["cone"]
    axis: Annotated[Vector, DIRECTION] = Field(description="middle of the cone")
    half_angle: Annotated[float, Field(gt=0, le=180), ANGLE] = Field(description="degrees")


class Box(Table):
    """A box along the axes of the manifest's frame."""

    type: Literal["box"]
    lower: Annotated[Vector, Quantity("frame")] = Field(description="corner with the least coordinates")
    upper: Annotated[Vector, Quantity("frame")] = Field(description="corner with the greatest coordinates")


class Poses(Table):
    """Single places, or single directions, that are to be reached."""

    type: Literal["poses"]
    points: Annotated[list[Vector] | None, POINT] = Field(None, description="places for the point")
    directions: Annotated[list[Vector] | None, DIRECTION] = Field(None, description="directions to point in")


class Reach(RequirementTable):
    """A point, or a pointing direction, of a body covers a region."""

    kind: Literal["reach"]
    part: Annotated[Reference, PLACE] = Field(description="part or group that carries the point or direction")
    point: Annotated[Vector | None, POINT] = Field(None, description="point, at the pose of the meshes")
    direction: Annotated[Vector | None, DIRECTION] = Field(
        None, description="direction, at the pose of the meshes; in place of point"
    )
    region: Annotated[Cone | Box | Poses, Field(discriminator="type")] = Field(description="what to cover")
    tolerance: Annotated[NonNegative | None, LENGTH] = Field(None, description="distance that is near enough")
    angle_tolerance: Annotated[NonNegative | None, ANGLE] = Field(None, description="degrees that are near enough")


@dataclass(frozen=True, eq=False)
class ReachRecord(Record):
    """A point (3,) m, or a direction (3,), that a part carries covers a region."""

    part: str
    region: Region
    point: Array | None = None
    direction: Array | None = None
    tolerance: float | None = None
    angle_tolerance: float | None = None

    @classmethod
    def read(cls, values: Mapping[str, Any]) -> Self:
        """The record, with its region."""
        region = values["region"]
        shape = REGIONS[region["type"]]
        return super().read({**values, "region": shape(**record_values(shape, region))})


def faults(table: Reach) -> Iterator[Fault]:
    """Regions that are none of a point, or of a direction."""
    if (table.point is None) == (table.direction is None):
        yield "it needs either a point or a direction", "state one of them", None
        return
    pointing, region = table.direction is not None, table.region
    what, other = ("directions", "points") if pointing else ("points", "directions")
    if isinstance(region, Poses):
        if not getattr(region, what):
            yield f"the poses list no {what}", f"add {what} to the region", "region"
        if getattr(region, other) is not None:
            yield f"the poses list {other}, and it is {what} that are asked for", f"remove {other}", "region"
    elif pointing == isinstance(region, Box):
        wrong = "a box is a region of points" if pointing else "a cone is a region of directions"
        yield wrong, f"state a {'point' if pointing else 'direction'}, or another region", "region"
    if isinstance(region, Box) and any(a > b for a, b in zip(region.lower, region.upper, strict=True)):
        yield "the lower corner of the box is not below its upper one", "exchange what is the wrong way round", "region"
    stray = "tolerance" if pointing else "angle_tolerance"
    if getattr(table, stray) is not None:
        yield f"{stray} says nothing about {what}", f"state {'angle_tolerance' if pointing else 'tolerance'}", stray


def judge(evidence: Evidence, wanted: ReachRecord) -> Answer:
    """The targets of the region that are not reached."""
    pointing = wanted.direction is not None
    carried = wanted.direction if pointing else wanted.point
    if carried is None or (pointing and wanted.point is not None):
        return undecided("it needs either a point or a direction", "State one of them.")
    targets = targets_of(wanted.region, direction=pointing)
    if isinstance(targets, str):
        return undecided(targets, "Correct the requirement.")
    carrier = _carrier(evidence, wanted.part)
    if isinstance(carrier, Answer):
        return carrier
    chain = carrier.chain
    endless = next((c.joint for c in chain.coordinates if not c.turns and not math.isfinite(c.upper - c.lower)), None)
    if not chain.looped and endless is not None:
        slides = f"joint '{evidence.stated_as(endless)[0]}' slides, and its range is not known"
        return undecided(slides, "State the `range` of its [[function.joint]].")
    near = wanted.angle_tolerance if pointing else wanted.tolerance
    if near is None:
        near = REACHED_ANGLE if pointing else REACHED_SHARE * (evidence.size or 1.0)
    coverage = carrier.cover(carried, targets.values, directions=pointing, near=near)
    missed = np.flatnonzero(~(coverage.distance <= near))
    if len(missed) and chain.looped and chain.freedoms > SAMPLED_FREEDOMS:
        return undecided(
            f"{len(missed)} of {len(targets.values)} places were not reached, but {chain.freedoms} freedoms in closed "
            "loops are too many to be sampled densely",
            OTHERWISE,
        )
    if len(missed):
        answer = _not_reached(evidence.units, targets, coverage, missed, near)
        worst = int(missed[np.argmax(coverage.distance[missed])])
        return replace(
            answer, witness=_witness(carrier, carried, targets.values[worst], pointing, coverage, worst, near)
        )
    text = f"all {counted(len(targets.values), 'place')} of the region reached{_bound(evidence.units, targets)}"
    unknown = [evidence.stated_as(name)[0] for name in chain.undetermined(carrier.body)]
    if unknown:
        return undecided(
            f"{text}, but only if {quoted(unknown)} may turn freely: no range is known",
            "State the `range` of the [[function.joint]].",
        )
    tied = _tied(evidence, chain)
    if tied:
        return undecided(
            f"{text}, but only if {quoted(tied)} move without each other: their coupling is stated and no geometry "
            "shows it",
            OTHERWISE,
        )
    return met(text)


def _tied(evidence: Evidence, chain: Chain) -> tuple[str, ...]:
    """Names of stated joints of which one is in the chain, and that a coupling of the function ties; () without any."""
    moving = {coordinate.joint for coordinate in chain.coordinates}
    for coupling in evidence.function.couplings:
        ends = [evidence.resolve(name).joint for name in coupling.joints]
        if any(joint is not None and joint.name in moving for joint in ends):
            return coupling.joints
    return ()


def _carrier(evidence: Evidence, part: str) -> Carrier | Answer:
    """The body of the part, with the joints between the ground and it."""
    kinematics = evidence.kinematics
    body = kinematics.body_of(evidence.assembly.parts_of(part)[0])
    ground = next((b.name for b in kinematics.bodies if b.ground), None)
    if ground is None or body.ground:
        return undecided(f"'{part}' does not move: it is the ground", "Require it of a part that moves.")
    carrier = evidence.carrier(ground, body.name)
    return undecided(carrier, "See KF401 and KF901.") if isinstance(carrier, str) else carrier


def _bound(units: str, targets: Targets) -> str:
    if targets.gap == 0.0:
        return ""
    size = angle(targets.gap) if targets.directions else length(targets.gap, units)
    return f"; between them holes of up to {size} in radius can be missed"


def _witness(
    carrier: Carrier, carried: Array, aim: Array, pointing: bool, coverage: Coverage, worst: int, near: float
) -> Witness | None:
    """The chain, and how near it comes to the target that it misses most."""
    screws = carrier.screws()
    if screws is None:
        return None
    bounds = {name: np.clip(screws[name], -ENDLESS, ENDLESS) for name in ("lower", "upper")}
    return computed(
        "reach of a chain", coverage.distance[worst], near, carried=carried, aim=aim, pointing=float(pointing),
        screws=screws["screws"], **bounds,
    )  # fmt: skip


def _not_reached(units: str, targets: Targets, coverage: Coverage, missed: NDArray[np.intp], near: float) -> Answer:
    """The requirement is violated; `missed` are the targets that are farther than `near` (m or rad) from all poses."""
    distance = coverage.distance
    worst = int(missed[np.argmax(distance[missed])])
    aim = targets.values[worst]
    shown = direction(np.round(aim, 4)) if targets.directions else place(aim, units)
    size = angle if targets.directions else (lambda v: length(v, units))
    share = f"{len(missed)} of {len(targets.values)}"
    return violated(
        f"{share} places of the region are not reached; the nearest to {shown} is {size(float(distance[worst]))} off, "
        f"found from {coverage.samples} sampled configurations",
        found=f"{share} not reached, {size(float(distance[worst]))} off at most",
        intended=f"all, within {size(near)}",
        place=None if targets.directions else aim,
        remedy=REMEDY,
    )


KIND = Kind("reach", 10, Reach, ReachRecord, judge, faults=faults, needs={"kinematics": "Run `kinform joints`."})
