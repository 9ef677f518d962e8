"""A point of a body, or its orientation, strays from the required path during the simulation.

The path is straight between its rows. It is compared at the times of its rows and at all output times between;
motion between output times is interpolated, and where that could decide, where the simulation ends before the
path does, or where there is none, the requirement is inconclusive (KF902).

Why it matters: the tool, the camera or the gripper is not where it should be.

What to do: correct the drives or the geometry. `kinform show F.h5 simulation` shows the motion.

Example: `kind = "follow"` of a coupler point whose crank is 0.5 mm too short.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.context import Context
from kinform.consistency.requirements import Answer, met, requirement_rule, simulated, undecided, violated
from kinform.foundation.words import angle, length, number, telling
from kinform.function.paths import Deviation, deviation
from kinform.model.function import Requirement
from kinform.model.simulation import Simulation

__all__ = ["RULE", "judge"]

REMEDY = "Correct the drives or the geometry, or the path."


def judge(context: Context, requirement: Requirement) -> Answer:
    """The greatest deviation beside the tolerance."""
    values = requirement.values
    simulation = simulated(context)
    if isinstance(simulation, Answer):
        return simulation
    body = context.body(values["part"])
    if body is None or body not in simulation.body_names:
        return undecided(f"the simulation does not have '{values['part']}'", "See KF501.")
    path = np.array(values.get("rows", []))
    if path.ndim != 2 or len(path) < 2:
        return undecided("the path has no rows", "Give a CSV file of time, x, y, z.")
    if values.get("angle_tolerance") is not None and path.shape[1] != 8:
        return undecided(
            "angle_tolerance is stated, but the path has no orientation", "Add qw, qx, qy, qz to its rows."
        )
    early = path[:, 0] <= simulation.time[-1] * (1.0 + 1e-9)
    found = _deviation(simulation, body, values["point"], path[early])
    if found is not None and (worse := _violation(context, requirement, found)) is not None:
        return worse
    if not early.all() or path[0, 0] < 0.0:
        return undecided(
            f"the simulation ends at t = {number(float(simulation.time[-1]))} s, the path at "
            f"{number(float(path[-1, 0]))} s", "Simulate as long as the path takes.",
        )  # fmt: skip
    assert found is not None
    text = f"the greatest distance from the path is {length(found.distance, context.units)}"
    if found.distance + found.error > values["tolerance"]:
        return undecided(
            f"{text}, give or take {length(found.error, context.units)} between output times",
            "Simulate with a shorter step.",
        )
    return met(f"{text}, at t = {number(found.time)} s")


def _deviation(simulation: Simulation, body: str, point: list[float], path: np.ndarray) -> Deviation | None:
    if len(path) < 2:
        return None
    b = simulation.body_names.index(body)
    return deviation(simulation.time, simulation.p_WB[:, b], simulation.q_WB[:, b], np.array(point), path)


def _violation(context: Context, requirement: Requirement, found: Deviation) -> Answer | None:
    """What is certainly outside of the tolerances."""
    values, units = requirement.values, context.units
    if found.distance - found.error > values["tolerance"]:
        shown = telling(lambda value, digits: length(value, units, digits), found.distance, values["tolerance"])
        return violated(
            f"the point is {shown(found.distance)} from the path at t = {number(found.time)} s",
            found=shown(found.distance), intended=f"within {shown(values['tolerance'])}", place=found.place, remedy=REMEDY,
        )  # fmt: skip
    wanted = values.get("angle_tolerance")
    if wanted is not None and found.angle is not None and found.angle > wanted:
        shown = telling(angle, found.angle, wanted)
        return violated(
            f"the body is turned {shown(found.angle)} from the path at t = {number(found.angle_time)} s",
            found=shown(found.angle), intended=f"within {shown(wanted)}", place=found.place, remedy=REMEDY,
        )  # fmt: skip
    return None


RULE = requirement_rule("KF422", "path-not-followed", "follow", __doc__, judge)
