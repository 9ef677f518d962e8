"""Solves a port model through time: starts it, runs it at a level, and makes results of the run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from kinform.behaviour.components import System
from kinform.behaviour.faults import faults
from kinform.behaviour.nested import flat
from kinform.foundation.progress import Progress, Say
from kinform.model.arrays import Array
from kinform.model.simulation import Simulation
from kinform.simulation.mechanism.actuation import Actuation
from kinform.simulation.mechanism.assembly import assemble
from kinform.simulation.mechanism.closure import factor, rank_of, settle
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.modelled import blank
from kinform.simulation.outcome.balances import imbalance
from kinform.simulation.outcome.drives import uses
from kinform.simulation.outcome.reactions import Reactions, reactions
from kinform.simulation.outcome.record import Record, publish, spread
from kinform.simulation.solver.integration import run_dynamic
from kinform.simulation.solver.kinematic import resting, run_kinematic
from kinform.simulation.solver.settings import SolverSettings
from kinform.simulation.solver.start import Start, Stated, begin
from kinform.simulation.solver.stops import beyond

__all__ = ["Course", "refuse", "simulate_system", "solve"]

Failures = tuple[tuple[str, str], ...]
AHEAD = 0.03
"""Of a motion (rad, or lengths) from the start that shows whether the loops bear it."""
SNUG = 1e-8
"""Gap (m or rad) up to which loops count as closed: those that fit exactly stay a million times below."""
TRUSTED = 1e-5
"""Drift of the energy over the energy exchanged; runs at the default tolerances stay a hundred times below."""
SUMMED = 1e-8
"""Drift of the energy over the kinetic energy that is no sign of anything, ten times that of sound runs."""


@dataclass(frozen=True, eq=False)
class Course:
    """How long, at which output times, under which gravity, at which level."""

    duration: float
    """s."""
    step: float
    """s, of the output."""
    gravity: Array = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    """(3,) m/s²."""
    level: str = "dynamic"
    """kinematic (or functional), dynamic."""

    def __post_init__(self) -> None:
        """ValueError for times and gravity that are none."""
        object.__setattr__(self, "gravity", np.asarray(self.gravity, dtype=np.float64))
        if not (np.isfinite(self.duration) and self.duration >= 0.0):
            raise ValueError(f"the duration of a run is a finite time, not negative: {self.duration:g} s")
        if not (np.isfinite(self.step) and self.step > 0.0):
            raise ValueError(f"the step between output times is a finite positive time: {self.step:g} s")
        if self.gravity.shape != (3,) or not np.all(np.isfinite(self.gravity)):
            raise ValueError(f"gravity is three finite numbers, m/s²: {self.gravity.tolist()}")


def simulate_system(
    system: System,
    course: Course,
    *,
    initial: Mapping[str, tuple[float, float]] | None = None,
    settings: SolverSettings | None = None,
    progress: Progress | None = None,
    say: Say | None = None,
) -> Simulation:
    """Simulates a port model made by hand, of any depth; SI and radians.

    `initial`: (position, velocity) of joints with one freedom by what they are called; 0 is the pose in
    which the model is written. Refusals are in `failures` of what is returned, with the component.
    ValueError for initial values of joints that the system does not have, or that are no numbers.
    """
    system = flat(system)
    wrong = faults(system)
    if wrong:
        return refuse("the model is not complete", wrong)
    mechanism, adrift = assemble(system)
    slots = {slot.name: slot for slot in mechanism.slots}
    stated = []
    for name, (position, velocity) in (initial or {}).items():
        if name not in slots or slots[name].kind.rates != 1:
            single = [slot.name for slot in mechanism.slots if slot.kind.rates == 1]
            raise ValueError(f'there is no joint "{name}" with one freedom: there are {", ".join(single) or "none"}')
        if not np.all(np.isfinite([position, velocity])):
            raise ValueError(f'the initial value of "{name}" is not a finite number')
        stated.append(Stated(name, slots[name].q.start, slots[name].v.start, position, velocity))
    failures = tuple((name, "no joints connect this body with the ground") for name in adrift)
    if course.level == "dynamic":
        failures += unfit(system, mechanism)
    if failures:
        return refuse("the model is not complete", failures)
    return solve(system, mechanism, course, tuple(stated), (), settings or SolverSettings(), progress, say)


def unfit(system: System, mechanism: Mechanism) -> Failures:
    """(component, why) of moving bodies whose mass or inertia cannot be."""
    link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
    out = []
    for body in system.bodies:
        if link_of[body.subject] == 0:
            continue
        mass = getattr(body, "mass", None)
        if mass is None:
            out.append((body.subject, "its mass is not known"))
            continue
        values = np.concatenate([[mass], *np.atleast_2d(body.inertia), body.centre_of_mass])  # type: ignore[union-attr]
        if not np.all(np.isfinite(values)) or mass < 0.0:
            out.append((body.subject, "its mass, centre of mass or inertia is not a number, or negative"))
        elif not _inertial(np.asarray(body.inertia)):  # type: ignore[union-attr]
            out.append((body.subject, "its inertia is not symmetric, or turns it the wrong way: a moment is negative"))
    return tuple(out)


def _inertial(inertia: Array) -> bool:
    """Whether a tensor (3, 3) is symmetric without a negative moment, but for rounding."""
    size = float(np.abs(inertia).max())
    symmetric = float(np.abs(inertia - inertia.T).max()) <= 1e-9 * size
    return symmetric and float(np.linalg.eigvalsh(inertia).min()) >= -1e-9 * size


def solve(
    system: System,
    mechanism: Mechanism,
    course: Course,
    stated: tuple[Stated, ...],
    notes: tuple[str, ...],
    settings: SolverSettings,
    progress: Progress | None,
    say: Say | None,
) -> Simulation:
    """Start and run the system; `notes` are what is assumed already."""
    dynamic = course.level == "dynamic"
    actuation = Actuation(mechanism, system, with_mass=dynamic)
    if actuation.conflicts:
        return refuse("the drives or the initial values cannot be applied", tuple(actuation.conflicts))
    start = begin(mechanism, actuation, stated, settings, coasting=dynamic)
    if start.problem is not None:
        return refuse("the mechanism cannot start", (start.problem,))
    overdriven, rank = _ranks(mechanism, actuation, start, settings)
    if overdriven:
        return refuse("the drives cannot be followed", ((_driven(mechanism, actuation), overdriven),))
    notes = (*notes, *actuation.notes, *start.notes)
    times = _grid(course.duration, course.step)
    if not dynamic:
        notes = (*notes, *resting(mechanism, actuation, start, settings))
        record = _in_mesh(mechanism, system, run_kinematic(mechanism, actuation, start, times, settings, progress))
        return publish(mechanism, record, course.level, notes, settings.free)[0]
    stuck = _singular_start(mechanism, actuation, start, rank, settings)
    if stuck:
        why = (
            "the mechanism starts in a singular pose (a dead point): its loops could go on in several ways there, "
            "or in none; start it in another pose"
        )
        return refuse("the mechanism cannot start", ((stuck, why),))
    outside = beyond(actuation.stops, start.q)
    if outside:
        return refuse("the mechanism cannot start", outside)
    dynamics = Dynamics(mechanism, system, course.gravity, actuation, rank)
    weightless = dynamics.weightless(start.q)
    if weightless:
        why = "its motion moves no mass: the acceleration is not determined"
        return refuse("a free motion has no inertia", tuple((name, why) for name in weightless))
    record = _in_mesh(mechanism, system, run_dynamic(dynamics, start, times, settings, progress, say))
    return _with_forces(dynamics, record, course.level, notes, settings)


def _in_mesh(mechanism: Mechanism, system: System, record: Record) -> Record:
    """The record up to where the last teeth of a gear let go: from there on nothing couples its shafts."""
    slots = {slot.name: slot for slot in mechanism.slots}
    for gear in system.gears:
        joint = system.joint_at(gear.name, "a").subject
        value = record.q[:, slots[joint].q.start]
        beyond = np.flatnonzero((value < gear.lower) | (value > gear.upper))
        if len(beyond):
            end = int(beyond[0])
            limit = gear.lower if value[end] < gear.lower else gear.upper
            cut = {
                name: getattr(record, name)[:end]
                for name in ("time", "q", "v", "acceleration", "effort", "needed", "extra", "work")
            }
            why = (
                f"before t = {record.time[end]:.4g} s the last teeth of {gear.subject} let go of each other: "
                f"{joint} passes {limit:.5g} (rad or m)"
            )
            record = replace(record, **cut, stopped=why)
    return record


def _with_forces(
    dynamics: Dynamics, record: Record, level: str, notes: tuple[str, ...], settings: SolverSettings
) -> Simulation:
    """The results with energy, reactions, their balance, and what the drives did."""
    run, states = publish(dynamics.mechanism, record, level, notes, settings.free)
    kinetic, potential = dynamics.energy(record.q, states)
    found = reactions(dynamics, states, record.effort, settings.free)
    balance = imbalance(dynamics, states, found, record.effort)
    energy = np.column_stack([kinetic, potential, record.work])
    return replace(
        run,
        assumptions=(*run.assumptions, *_ajar(run.residual), *_drift(run.time, energy)),
        energy=energy,
        F_A=-found.on_second,
        F_B=found.on_second,
        undetermined=found.undetermined,
        **_passed_on(dynamics, found),
        balance=balance.greatest,
        balance_bodies=balance.bodies,
        balance_shafts=spread(dynamics.mechanism, balance.shafts),
        drives=uses(dynamics, record),
    )


def _passed_on(dynamics: Dynamics, found: Reactions) -> dict[str, Any]:
    """What gears do, as fields of the results."""
    if found.gears is None:
        return {}
    names = tuple(gear.subject for gear in dynamics.system.gears)
    return {"gear_names": names, "gear_effort": found.gears.efforts, "gear_force": found.gears.forces}


def _ajar(residual: Array) -> tuple[str, ...]:
    """What is to be said of redundant loops that the geometry does not let close exactly."""
    widest = float(residual.max(initial=0.0))
    if not widest > SNUG:
        return ()
    return (
        f"redundant loops open by up to {widest:.2g} (m or rad) as they move: the geometry fits no better, "
        "and the play that it needs is taken to be there",
    )


def _drift(times: Array, energy: Array) -> tuple[str, ...]:
    """What is to be said of an energy balance that is worse than every sound run's."""
    total = energy @ np.array([1.0, 1.0, -1.0])
    exchanged = float(np.ptp(energy, axis=0).max(initial=0.0)) if len(energy) else 0.0
    # Where bodies exchange energy only among each other, all that can be seen is that the sum of it stays.
    least = 1e-12 + SUMMED * float(np.abs(energy[:, 0]).max(initial=0.0))
    wrong = np.flatnonzero(np.abs(total - total[:1]) > TRUSTED * exchanged + least)
    if not len(wrong) or exchanged == 0.0:
        return ()
    share = float(np.abs(total - total[0]).max()) / exchanged
    return (
        f"from t = {times[wrong[0]]:.4g} s on the energy balance is off, at the end by {share:.2g} of the energy "
        "exchanged: the trajectory is not to be trusted from there on",
    )


def _grid(duration: float, step: float) -> Array:
    """Multiples of the step from zero, and the end itself."""
    times = np.arange(int(np.floor(duration / step + 1e-9)) + 1, dtype=np.float64) * step
    if duration - times[-1] > 1e-9 * step:
        return np.append(times, duration)
    times[-1] = duration
    return times


def _ranks(mechanism: Mechanism, actuation: Actuation, start: Start, settings: SolverSettings) -> tuple[str, int]:
    """Why the drives cannot be followed ("" when they can), and the rank of the loops without them."""
    rows = mechanism.closure(mechanism.screws(mechanism.poses(start.q)))
    free, scale = actuation.free, mechanism.scale
    rank = rank_of(rows[:, free], scale[free], settings.free)
    if rank == rank_of(rows, scale, settings.free):
        return "", rank
    ties = "the loops and couplings" if len(mechanism.gear_v) else "the loops"
    return (
        f"{ties} leave these drives no freedom at the start: there are too many of them, "
        "or the mechanism starts in a singular pose",
        rank,
    )


def _singular_start(
    mechanism: Mechanism, actuation: Actuation, start: Start, rank: int, settings: SolverSettings
) -> str:
    """Joints that seem free to move at the start, but tear the loops when they do; "" when none does."""
    free = actuation.free
    rows = mechanism.closure(mechanism.screws(mechanism.poses(start.q)))[:, free]
    null = factor(rows, mechanism.scale[free], rank).null
    if not mechanism.closed or not null.shape[1]:
        return ""
    # Each motion alone, and all at once: where branches meet, their sum lies on none.
    for motion in (*null.T, null.sum(axis=1)):
        step = np.zeros(mechanism.rates)
        step[free] = AHEAD * motion / np.abs(motion / mechanism.scale[free]).max()
        _, gap, _ = settle(mechanism, mechanism.advance(start.q, step), free, rank, settings)
        if gap > 0.01 * AHEAD**2:
            moving = free[np.abs(motion) > 1e-6 * np.abs(motion).max()]
            return ", ".join(s.name for s in mechanism.slots if np.any((moving >= s.v.start) & (moving < s.v.stop)))
    return ""


def _driven(mechanism: Mechanism, actuation: Actuation) -> str:
    led = set(actuation.led.tolist())
    return ", ".join(slot.name for slot in mechanism.slots if slot.v.start in led and slot.v.stop > slot.v.start)


def refuse(reason: str, failures: Failures) -> Simulation:
    """Nothing is simulated, and why."""
    subject, why = failures[0]
    return blank("refused", f"{reason}: {subject}: {why}", failures)
