"""A point of a body, or its orientation, strays from the required path during the simulation.

The path is straight between its rows. It is compared at the times of its rows and at all output times between;
motion between output times is interpolated, and where that could decide, where the simulation ends before the
path does, or where there is none, the requirement is inconclusive (KF902).

Why it matters: the tool, the camera or the gripper is not where it should be.

What to do: correct the drives or the geometry. `kinform show F.h5 simulation` shows the motion.

Example: `kind = "follow"` of a coupler point whose crank is 0.5 mm too short.
"""

from __future__ import annotations

from dataclasses import replace

from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, Margin, met, undecided, violated
from kinform.consistency.requirements import requirement_rule, simulated
from kinform.foundation.words import angle, length, number, telling
from kinform.function.paths import Deviation, deviation
from kinform.function.requirement_kinds import Follow
from kinform.model.arrays import Array
from kinform.model.simulation import Simulation

SAME_TIME = 1e-9
"""Share of the simulated time by which a path may be longer: rounding."""


REMEDY = "Correct the drives or the geometry, or the path."


def judge(context: Context, requirement: Follow) -> Answer:
    """The greatest deviation beside the tolerance."""
    simulation = simulated(context)
    if isinstance(simulation, Answer):
        return simulation
    body = context.body(requirement.part)
    if body is None or body not in simulation.body_names:
        return undecided(f"the simulation does not have '{requirement.part}'", "See KF501.")
    path = requirement.rows
    if len(path) < 2:
        return undecided("the path has no rows", "Give a CSV file of time, x, y, z.")
    if requirement.angle_tolerance is not None and path.shape[1] != 8:
        unknown = "angle_tolerance is stated, but the path has no orientation"
        return undecided(unknown, "Add qw, qx, qy, qz to its rows.")
    early = path[:, 0] <= simulation.time[-1] * (1.0 + SAME_TIME)
    greatest = _deviation(simulation, body, requirement.point, path[early])
    violation = None if greatest is None else _violation(context, requirement, greatest)
    whole = greatest is not None and early.all() and path[0, 0] >= 0.0 and requirement.angle_tolerance is None
    margin = Margin(requirement.tolerance - greatest.distance, "m") if greatest is not None and whole else None
    if violation is not None:
        return replace(violation, margin=margin)
    if greatest is None or not early.all() or path[0, 0] < 0.0:
        return undecided(
            f"the simulation ends at t = {number(float(simulation.time[-1]))} s, the path at "
            f"{number(float(path[-1, 0]))} s", "Simulate as long as the path takes.",
        )  # fmt: skip
    text = f"the greatest distance from the path is {length(greatest.distance, context.units)}"
    if greatest.distance + greatest.error > requirement.tolerance:
        doubt = f"{text}, give or take {length(greatest.error, context.units)} between output times"
        return undecided(doubt, "Simulate with a shorter step.")
    return met(f"{text}, at t = {number(greatest.time)} s", margin=margin)


def _deviation(simulation: Simulation, body: str, point: Array, path: Array) -> Deviation | None:
    if len(path) < 2:
        return None
    b = simulation.body_names.index(body)
    return deviation(simulation.time, simulation.p_WB[:, b], simulation.q_WB[:, b], point, path)


def _violation(context: Context, requirement: Follow, greatest: Deviation) -> Answer | None:
    """What is certainly outside of the tolerances."""
    units = context.units
    if greatest.distance - greatest.error > requirement.tolerance:
        shown = telling(lambda value, digits: length(value, units, digits), greatest.distance, requirement.tolerance)
        return violated(
            f"the point is {shown(greatest.distance)} from the path at t = {number(greatest.time)} s",
            found=shown(greatest.distance), intended=f"within {shown(requirement.tolerance)}",
            place=greatest.place, remedy=REMEDY,
        )  # fmt: skip
    wanted = requirement.angle_tolerance
    if wanted is not None and greatest.angle is not None and greatest.angle > wanted:
        shown = telling(angle, greatest.angle, wanted)
        return violated(
            f"the body is turned {shown(greatest.angle)} from the path at t = {number(greatest.angle_time)} s",
            found=shown(greatest.angle), intended=f"within {shown(wanted)}", place=greatest.place, remedy=REMEDY,
        )  # fmt: skip
    return None


RULE = requirement_rule("KF422", "path-not-followed", Follow, __doc__, judge)
