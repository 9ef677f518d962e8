"""A simulated value beside the limit that a requirement sets it.

What is simulated is known at output times: where it curves smoothly, the parabola through three of them says how high
the peak between them is; jumps and kinks have no such peak. What is shorter than the output step is not seen.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from kinform.foundation.rounding import SOLVED
from kinform.foundation.words import number, telling
from kinform.model.arrays import Array
from kinform.model.findings import Witness
from kinform.model.kinematics import Joint
from kinform.model.simulation import Simulation
from kinform.requirements.answer import Answer, Margin, met, undecided, violated
from kinform.requirements.bounds import Compared
from kinform.requirements.evidence import Evidence
from kinform.requirements.joints import single_joint

RATE_RESOLVED = 0.1
"""Share of the greatest rate by which a rate may miss what its derivatives at both ends of a step make of it; a sine is
within it from six output times a period."""

SIMULATE = "Ask for a simulation that runs to its end: [simulation], and a [[function.drive]] that moves the joints."
DYNAMIC = 'Ask for `level = "dynamic"`, with the mass of every moving part known.'
FINER = "Ask for a shorter `step` of the output."
SINGLE = ("revolute", "prismatic", "screw")
"""Types of joints with one coordinate."""


PeakProof = Callable[[int, float], Witness | None]
"""(output, value there) → the witness."""


class OfJoint(Protocol):
    """The record of a requirement of one joint."""

    @property
    def joint(self) -> str: ...


def simulated(evidence: Evidence, *, dynamic: bool = False) -> Simulation | Answer:
    """The simulation, or why it says nothing. One that stopped early is given: what it shows has happened."""
    lacking = evidence.lacking("simulation")
    if lacking is not None:
        return undecided(lacking, SIMULATE)
    simulation = evidence.simulation
    if simulation.status == "refused" or len(simulation.time) == 0:
        return undecided(f"the simulation was refused: {simulation.reason}", "See KF501.")
    if dynamic and simulation.level != "dynamic":
        return undecided(f"the simulation is {simulation.level}: it has no forces", DYNAMIC)
    unseen = evidence.lacking("forces" if dynamic else "motion") if simulation.dampings else None
    return simulation if unseen is None else undecided(unseen, "See KF508.")


def run_of_joint(
    evidence: Evidence, requirement: OfJoint, *, dynamic: bool = False
) -> tuple[Joint, Simulation, int] | Answer:
    """The joint of a requirement, the run, and the joint's column in it; or why there is none. Needs kinematics."""
    joint = single_joint(evidence, requirement.joint)
    if isinstance(joint, Answer):
        return joint
    simulation = simulated(evidence, dynamic=dynamic)
    if isinstance(simulation, Answer):
        return simulation
    if joint.name not in simulation.joint_names:
        return undecided(f"the simulation does not have the joint '{joint.name}'", "See KF501.")
    return joint, simulation, int(simulation.joint_offset[simulation.joint_names.index(joint.name)])


def window(simulation: Simulation, output: int) -> slice:
    """Up to five output times about one."""
    start = max(0, min(output - 2, len(simulation.time) - 5))
    return slice(start, start + 5)


def peak_beside_limit(
    compared: Compared, simulation: Simulation, values: Array, limit: float, proof: PeakProof | None = None
) -> Answer:
    """The greatest of the values (T,), which are not negative, beside the limit; unknown values are nan. `proof` makes
    the witness of the value at an output."""
    known = np.isfinite(values)
    intended = f"at most {telling(compared.shown)(limit)}"
    if known.any():
        k = int(np.nanargmax(np.where(known, values, -np.inf)))
        shown = telling(compared.shown, float(values[k]), limit)
        intended = f"at most {shown(limit)}"
        text = f"{compared.name} peaks at {shown(float(values[k]))} at t = {number(float(simulation.time[k]))} s"
        summit = max(float(values[k]), _highest_between(values))
        whole = known.all() and simulation.status == "done" and not coarse(simulation)
        margin = Margin(limit - summit, compared.unit) if whole else None
        if summit > limit >= values[k] and known.all():
            return undecided(
                f"{text}, and between the output times at about {shown(summit)}: too near to the limit",
                FINER, found=f"about {shown(summit)}", intended=intended,
            )  # fmt: skip
        if values[k] > limit:
            return violated(
                f"{text}, required is {intended}", found=shown(float(values[k])), intended=intended,
                place=compared.place, remedy=compared.remedy, margin=margin,
                witness=None if proof is None else proof(k, float(values[k])),
            )  # fmt: skip
    if not known.all():
        return undecided(
            f"{compared.name} is not known at all times of the simulation", "See the notes of the simulation."
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
    moving = np.maximum(fastest, (h * np.abs(a[1:])).max(axis=0, initial=0.0)) > SOLVED
    # Share of the steps that may miss by more: single kinks and jumps of a law are no reason to doubt. Chosen, not
    # measured: a law with a kink in every fifth output step is not resolved either.
    return bool(((missed.mean(axis=0) > 0.2) & moving).any())


def _highest_between(values: Array) -> float:
    """The highest vertex of the parabolas through three neighbours, where the curvature beside is much the same."""
    if len(values) < 5:
        return -np.inf
    bend = np.diff(values, 2)
    slope = 0.5 * (values[2:] - values[:-2])
    beside = np.minimum(bend[:-2], bend[2:])
    middle, rate, top = bend[1:-1], slope[1:-1], values[2:-2]
    # Share of its curvature that a peak's neighbours must have for a parabola to say how high it is. Chosen, not
    # measured: beside the peak of a sine with six output times a period, the coarsest that counts as resolved, it is a
    # half.
    smooth = (middle < 0.0) & (beside < 0.25 * middle) & (np.abs(rate) <= -middle)
    return float(np.max(top[smooth] - 0.5 * rate[smooth] ** 2 / middle[smooth], initial=-np.inf))
