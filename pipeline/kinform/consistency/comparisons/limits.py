"""A quantity beside the limit, or the bounds, that a requirement sets it.

What is weighed or measured has a bound of its error. What is simulated is known at output times: where it curves
smoothly, the parabola through three of them says how high the peak between them is; jumps and kinks have no such peak.
What is shorter than the output step is not seen.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, Margin, met, undecided, violated
from kinform.consistency.requirements import simulated, single_joint
from kinform.foundation.words import number, quoted, telling
from kinform.frozen import dataclass
from kinform.function.amounts import Amount, amount_of
from kinform.function.requirement_kinds import JointLimit, TorqueSpeed
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint
from kinform.model.simulation import Simulation

RATE_RESOLVED = 0.1
"""Share of the greatest rate by which a rate may miss what its derivatives at both ends of a step make of it; a sine is
within it from six output times a period."""
MOST_STEPS = 0.2
"""Share of the steps that may miss by more: single kinks and jumps of a law are no reason to doubt."""
QUIET = 1e-9
"""rad/s or m/s below which nothing moves."""
BENT_ALIKE = 0.25
"""Share of its curvature that a peak's neighbours must have for a parabola to say how high it is; a choice."""


WEIGH = "Give every part of it a density, a material or a mass, and a closed mesh."
FINER = "Ask for a shorter `step` of the output."
SINGLE = ("revolute", "prismatic", "screw")
"""Types of joints with one coordinate."""


@dataclass(frozen=True, eq=False)
class Quantity:
    """What is compared with a requirement, in words."""

    name: str
    """ "the mass of 'arm'"."""
    shown: Callable[[float, int], str]
    """A value of it, in SI, with so many significant digits."""
    remedy: str
    """What to do where it is out of bounds."""
    unit: str
    """In SI."""
    place: Iterable[float] | None = None
    """(3,) m."""
    cause: str = "by its facets"
    """What its error comes from."""
    cure: str = "Export a finer mesh."
    """What makes its error smaller."""


def beside_bounds(quantity: Quantity, value: float, error: float, low: float | None, high: float | None) -> Answer:
    """A value with a bound of its error beside the interval that is required."""
    if low is None and high is None:
        return undecided("it states neither minimum nor maximum", "State one of them.")
    shown = telling(quantity.shown, value, *(bound for bound in (low, high) if bound is not None))
    wanted, text = _interval(low, high, shown), f"{quantity.name} is {shown(value)}"
    low, high = -np.inf if low is None else low, np.inf if high is None else high
    margin = Margin(float(min(value - low, high - value)), quantity.unit)
    if value + error < low or value - error > high:
        return violated(
            f"{text}, required is {wanted}", found=shown(value), intended=wanted,
            remedy=quantity.remedy, place=quantity.place, margin=margin,
        )  # fmt: skip
    if value - error < low or value + error > high:
        return undecided(
            f"{text}, give or take {shown(error)} {quantity.cause}: too near to the bound",
            quantity.cure, found=shown(value), intended=wanted,
        )  # fmt: skip
    return met(text, found=shown(value), intended=wanted, margin=margin)


def peak_beside_limit(quantity: Quantity, simulation: Simulation, values: Array, limit: float) -> Answer:
    """The greatest of the values (T,), which are not negative, beside the limit; unknown values are nan."""
    known = np.isfinite(values)
    intended = f"at most {telling(quantity.shown)(limit)}"
    if known.any():
        k = int(np.nanargmax(np.where(known, values, -np.inf)))
        shown = telling(quantity.shown, float(values[k]), limit)
        intended = f"at most {shown(limit)}"
        text = f"{quantity.name} peaks at {shown(float(values[k]))} at t = {number(float(simulation.time[k]))} s"
        summit = max(float(values[k]), _highest_between(values))
        whole = known.all() and simulation.status == "done" and not coarse(simulation)
        margin = Margin(limit - summit, quantity.unit) if whole else None
        if summit > limit >= values[k] and known.all():
            return undecided(
                f"{text}, and between the output times at about {shown(summit)}: too near to the limit",
                FINER, found=f"about {shown(summit)}", intended=intended,
            )  # fmt: skip
        if values[k] > limit:
            return violated(
                f"{text}, required is {intended}", found=shown(float(values[k])), intended=intended,
                place=quantity.place, remedy=quantity.remedy, margin=margin,
            )  # fmt: skip
    if not known.all():
        return undecided(
            f"{quantity.name} is not known at all times of the simulation", "See the notes of the simulation."
        )
    step = number(float(np.diff(simulation.time).max(initial=0.0)))
    if coarse(simulation):
        too_few = f"{text}, but output times {step} s apart are too few to follow the motion"
        return undecided(too_few, FINER, intended=intended)
    if simulation.status != "done":
        return undecided(
            f"the simulation stopped at t = {number(float(simulation.time[-1]))} s: {simulation.reason}",
            "See KF502.", intended=intended,
        )  # fmt: skip
    apart = f", {step} s apart" if len(simulation.time) > 1 else ""
    more = f", and between them at about {shown(summit)}" if shown(summit) != shown(float(values[k])) else ""
    text = f"{text}, of {len(values)} output times{apart}{more}"
    return met(text, found=shown(float(values[k])), intended=intended, margin=margin)


def coarse(simulation: Simulation) -> bool:
    """Whether speeds and positions change between output times by other than speeds and accelerations there say, in
    many steps: single kinks and jumps of a law are no reason."""
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
    missed = np.abs(np.diff(v, axis=0) - 0.5 * h * (a[:-1] + a[1:])) > RATE_RESOLVED * fastest
    missed |= np.abs(np.diff(q, axis=0) - by_rates) > RATE_RESOLVED * h * fastest
    # Turning points fall on the outputs where their time is that of an oscillation: all rates vanish there,
    # accelerations do not.
    moving = np.maximum(fastest, (h * np.abs(a[1:])).max(axis=0, initial=0.0)) > QUIET
    return bool(((missed.mean(axis=0) > MOST_STEPS) & moving).any())


def run_of_joint(
    context: Context, requirement: JointLimit | TorqueSpeed, *, dynamic: bool = False
) -> tuple[Joint, Simulation, int] | Answer:
    """The joint of a requirement, the run, and the joint's column in it; or why there is none. Needs kinematics."""
    joint = single_joint(context, requirement.joint)
    if isinstance(joint, Answer):
        return joint
    simulation = simulated(context, dynamic=dynamic)
    if isinstance(simulation, Answer):
        return simulation
    if joint.name not in simulation.joint_names:
        return undecided(f"the simulation does not have the joint '{joint.name}'", "See KF501.")
    return joint, simulation, int(simulation.joint_offset[simulation.joint_names.index(joint.name)])


def amount(context: Context, name: str | None) -> Amount | Answer:
    """Mass, centre and inertia of a part, a group, or everything. Needs masses."""
    parts = [p.name for p in context.assembly.parts] if name is None else list(context.assembly.parts_of(name))
    result = amount_of(context.assembly, context.mass, parts)
    return undecided(result, WEIGH) if isinstance(result, str) else result


def whose(name: str | None) -> str:
    """What is weighed, in words."""
    return "the whole" if name is None else quoted([name])


def _interval(low: float | None, high: float | None, shown: Callable[[float], str]) -> str:
    """The interval that is required, in words; one end at least is stated."""
    if low is None or high is None:
        return f"at least {shown(low)}" if low is not None else f"at most {shown(high or 0.0)}"
    return f"{shown(low)} to {shown(high)}"


def _highest_between(values: Array) -> float:
    """The highest vertex of the parabolas through three neighbours, where the curvature beside is much the same."""
    if len(values) < 5:
        return -np.inf
    bend = np.diff(values, 2)
    slope = 0.5 * (values[2:] - values[:-2])
    beside = np.minimum(bend[:-2], bend[2:])
    middle, rate, top = bend[1:-1], slope[1:-1], values[2:-2]
    smooth = (middle < 0.0) & (beside < BENT_ALIKE * middle) & (np.abs(rate) <= -middle)
    return float(np.max(top[smooth] - 0.5 * rate[smooth] ** 2 / middle[smooth], initial=-np.inf))
