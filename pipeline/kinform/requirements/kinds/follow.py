"""`follow`: a point of a body, with its orientation if the path has it, follows a path during the simulation."""

from __future__ import annotations

from dataclasses import field, replace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from kinform.form.tables import Positive, Reference, Vector
from kinform.foundation.rounding import SOLVED
from kinform.foundation.words import angle, length, number, telling
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.findings import Witness, computed
from kinform.model.simulation import Simulation
from kinform.requirements.answer import Answer, Margin, met, undecided, violated
from kinform.requirements.evidence import Deviation, Evidence
from kinform.requirements.kind import Kind, Record
from kinform.requirements.quantity import ANGLE, LENGTH, PLACE, POINT, Quantity
from kinform.requirements.runs import simulated, window
from kinform.requirements.table import RequirementTable

REMEDY = "Correct the drives or the geometry, or the path."


class Follow(RequirementTable):
    """A point of a body, with its orientation if the path has it, follows a path during the simulation."""

    kind: Literal["follow"]
    part: Annotated[Reference, PLACE] = Field(description="part or group that carries the point")
    point: Annotated[Vector, POINT] = Field(description="point, at the pose of the meshes")
    path: Annotated[Reference, Quantity("path")] = Field(
        description="CSV file of time (s), x, y, z and optionally qw, qx, qy, qz, relative to the manifest"
    )
    tolerance: Annotated[Positive, LENGTH] = Field(description="greatest distance from the path")
    angle_tolerance: Annotated[Positive | None, ANGLE] = Field(None, description="degrees from the orientation")


@dataclass(frozen=True, eq=False)
class FollowRecord(Record):
    """A point (3,) m that a part carries follows `rows` (n, 4) of t, x, y, z or (n, 8) with qw, qx, qy, qz."""

    part: str
    point: Array
    tolerance: float
    angle_tolerance: float | None = None
    rows: Array = field(default_factory=lambda: np.zeros((0, 4)))


def judge(evidence: Evidence, wanted: FollowRecord) -> Answer:
    """The greatest deviation beside the tolerance."""
    simulation = simulated(evidence)
    if isinstance(simulation, Answer):
        return simulation
    body = evidence.body(wanted.part)
    if body is None or body not in simulation.body_names:
        return undecided(f"the simulation does not have '{wanted.part}'", "See KF501.")
    path = wanted.rows
    if len(path) < 2:
        return undecided("the path has no rows", "Give a CSV file of time, x, y, z.")
    if wanted.angle_tolerance is not None and path.shape[1] != 8:
        unknown = "angle_tolerance is stated, but the path has no orientation"
        return undecided(unknown, "Add qw, qx, qy, qz to its rows.")
    end = float(simulation.time[-1])
    early = path[:, 0] <= end * (1.0 + SOLVED)
    greatest = evidence.deviation(body, wanted.point, path[early]) if np.count_nonzero(early) > 1 else None
    violation = None if greatest is None else _violation(evidence.units, wanted, greatest)
    if violation is not None and greatest is not None:
        violation = replace(violation, witness=_witness(simulation, body, wanted, greatest))
    whole = greatest is not None and early.all() and path[0, 0] >= 0.0 and wanted.angle_tolerance is None
    margin = Margin(wanted.tolerance - greatest.distance, "m") if greatest is not None and whole else None
    if violation is not None:
        return replace(violation, margin=margin)
    if greatest is None or not early.all() or path[0, 0] < 0.0:
        return undecided(
            f"the simulation ends at t = {number(end)} s, the path at {number(float(path[-1, 0]))} s",
            "Simulate as long as the path takes.",
        )
    text = f"the greatest distance from the path is {length(greatest.distance, evidence.units)}"
    if greatest.distance + greatest.error > wanted.tolerance:
        doubt = f"{text}, give or take {length(greatest.error, evidence.units)} between output times"
        return undecided(doubt, "Simulate with a shorter step.")
    return met(f"{text}, at t = {number(greatest.time)} s", margin=margin)


def _witness(simulation: Simulation, body: str, wanted: FollowRecord, greatest: Deviation) -> Witness | None:
    """The motion of the body about that time, and the path."""
    off = greatest.distance - greatest.error > wanted.tolerance
    when = greatest.time if off else greatest.angle_time
    near = window(simulation, int(np.abs(simulation.time - when).argmin()))
    b, rows = simulation.body_names.index(body), wanted.rows
    k = int(np.clip(np.searchsorted(rows[:, 0], when, side="right") - 1, 0, len(rows) - 2))
    return computed(
        "path and motion", greatest.distance if off else greatest.angle or 0.0,
        wanted.tolerance if off else wanted.angle_tolerance or 0.0, turned=float(not off), at=when,
        times=simulation.time[near], places=simulation.p_WB[near, b], turns=simulation.q_WB[near, b],
        point=wanted.point, rows=rows[k : k + 2],
    )  # fmt: skip


def _violation(units: str, wanted: FollowRecord, greatest: Deviation) -> Answer | None:
    """What is certainly outside of the tolerances."""
    if greatest.distance - greatest.error > wanted.tolerance:
        shown = telling(lambda value, digits: length(value, units, digits), greatest.distance, wanted.tolerance)
        return violated(
            f"the point is {shown(greatest.distance)} from the path at t = {number(greatest.time)} s",
            found=shown(greatest.distance), intended=f"within {shown(wanted.tolerance)}",
            place=greatest.place, remedy=REMEDY,
        )  # fmt: skip
    limit = wanted.angle_tolerance
    if limit is not None and greatest.angle is not None and greatest.angle > limit:
        shown = telling(angle, greatest.angle, limit)
        return violated(
            f"the body is turned {shown(greatest.angle)} from the path at t = {number(greatest.angle_time)} s",
            found=shown(greatest.angle), intended=f"within {shown(limit)}", place=greatest.place, remedy=REMEDY,
        )  # fmt: skip
    return None


KIND = Kind("follow", 20, Follow, FollowRecord, judge)
