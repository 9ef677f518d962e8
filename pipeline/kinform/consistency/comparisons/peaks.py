"""Peaks of a simulated quantity beside a limit.

The values are known at output times. Where they curve smoothly, the parabola through three of them says how high the
peak between them is; jumps and kinks have no such peak. What is shorter than the output step is not seen.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from kinform.consistency.context import Context
from kinform.consistency.requirements import Answer, met, resolved, simulated, undecided, violated
from kinform.foundation.words import number, telling
from kinform.model.function import Requirement
from kinform.model.kinematics import Joint
from kinform.model.simulation import Simulation

__all__ = ["coarse", "of_joint", "peak"]

SINGLE = ("revolute", "prismatic", "screw")
MANY = 0.2
"""Share of the steps."""
QUIET = 1e-9
"""rad/s or m/s below which nothing moves."""


def peak(
    simulation: Simulation,
    values: NDArray[np.float64],
    limit: float,
    what: str,
    told: Callable[[float, int], str],
    remedy: str,
    place: Iterable[float] | None = None,
) -> Answer:
    """The greatest of the values (T,), which are not negative, beside the limit; unknown values are nan."""
    known = np.isfinite(values)
    intended = f"at most {telling(told)(limit)}"
    if known.any():
        k = int(np.nanargmax(np.where(known, values, -np.inf)))
        shown = telling(told, float(values[k]), limit)
        intended = f"at most {shown(limit)}"
        text = f"{what} peaks at {shown(float(values[k]))} at t = {number(float(simulation.time[k]))} s"
        summit = max(float(values[k]), _between(values))
        if summit > limit >= values[k] and known.all():
            return undecided(
                f"{text}, and between the output times at about {shown(summit)}: too near to the limit",
                "Ask for a shorter `step` of the output.", found=f"about {shown(summit)}", intended=intended,
            )  # fmt: skip
        if values[k] > limit:
            return violated(
                f"{text}, required is {intended}", found=shown(float(values[k])), intended=intended,
                place=place, remedy=remedy,
            )  # fmt: skip
    if not known.all():
        return undecided(f"{what} is not known at all times of the simulation", "See the notes of the simulation.")
    if coarse(simulation):
        step = number(float(np.diff(simulation.time).max())) if len(simulation.time) > 1 else "0"
        return undecided(
            f"{text}, but output times {step} s apart are too few to follow the motion", "Ask for a shorter `step` of the output.",
            intended=intended,
        )  # fmt: skip
    if simulation.status != "done":
        return undecided(
            f"the simulation stopped at t = {number(float(simulation.time[-1]))} s: {simulation.reason}",
            "See KF502.", intended=intended,
        )  # fmt: skip
    apart = f", {number(float(np.diff(simulation.time).max()))} s apart" if len(simulation.time) > 1 else ""
    more = f", and between them at about {shown(summit)}" if shown(summit) != shown(float(values[k])) else ""
    return met(f"{text}, of {len(values)} output times{apart}{more}", found=shown(float(values[k])), intended=intended)


RESOLVED = 0.1
"""Share of the greatest rate by which a rate may miss what its derivatives at both ends of a step make of it; a sine is
within it from six output times a period."""


def coarse(simulation: Simulation) -> bool:
    """Whether speeds and positions change between output times by other than speeds and accelerations there say, in many
    steps: single kinks and jumps of a law are no reason."""
    turns = [int(simulation.joint_offset[k]) for k, kind in enumerate(simulation.joint_types) if kind in SINGLE]
    if len(simulation.time) < 2 or len(simulation.joint_acceleration) != len(simulation.time):
        return False
    h = np.diff(simulation.time)[:, None]
    q, v, a = (
        x[:, turns] for x in (simulation.joint_position, simulation.joint_velocity, simulation.joint_acceleration)
    )
    if not (np.isfinite(a).all() and np.isfinite(v).all()):
        return False
    fastest = np.abs(v).max(axis=0, initial=0.0)
    by_rates = 0.5 * h * (v[:-1] + v[1:]) + h**2 / 12.0 * (a[:-1] - a[1:])
    missed = np.abs(np.diff(v, axis=0) - 0.5 * h * (a[:-1] + a[1:])) > RESOLVED * fastest
    missed |= np.abs(np.diff(q, axis=0) - by_rates) > RESOLVED * h * fastest
    # Turning points fall on the outputs where their time is that of an oscillation: all rates vanish, accelerations do not.
    moving = np.maximum(fastest, (h * np.abs(a[1:])).max(axis=0, initial=0.0)) > QUIET
    return bool(((missed.mean(axis=0) > MANY) & moving).any())


def of_joint(
    context: Context, requirement: Requirement, *, dynamic: bool = False
) -> tuple[Joint, Simulation, int] | Answer:
    """The joint of a requirement, the run, and the joint's column in it; or why there is none."""
    found = resolved(context, requirement.values["joint"])
    if isinstance(found, Answer):
        return found
    simulation = simulated(context, dynamic=dynamic)
    if isinstance(simulation, Answer):
        return simulation
    joint = found[0]
    if joint.name not in simulation.joint_names:
        return undecided(f"the simulation does not have the joint '{joint.name}'", "See KF501.")
    return joint, simulation, int(simulation.joint_offset[simulation.joint_names.index(joint.name)])


def _between(values: NDArray[np.float64]) -> float:
    """The highest vertex of the parabolas through three neighbours, where the curvature beside them is much the same."""
    if len(values) < 5:
        return -np.inf
    bend = np.diff(values, 2)
    slope = 0.5 * (values[2:] - values[:-2])
    beside = np.minimum(bend[:-2], bend[2:])
    middle, rate, top = bend[1:-1], slope[1:-1], values[2:-2]
    smooth = (middle < 0.0) & (beside < 0.25 * middle) & (np.abs(rate) <= -middle)
    return float(np.max(top[smooth] - 0.5 * rate[smooth] ** 2 / middle[smooth], initial=-np.inf))
