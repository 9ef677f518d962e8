"""Simulates a port model: checks it, starts it, runs it through time at a level, and makes results of the run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field

import numpy as np

from kinform.behaviour.components import Ground, System
from kinform.behaviour.diagnosis import faults
from kinform.behaviour.nested import flat
from kinform.foundation.progress import Progress, Say
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.simulation import Simulation, SimulationLevel
from kinform.simulation.mechanism.actuation import Actuation
from kinform.simulation.mechanism.construction import assemble
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.outcome.results import publish, publish_dynamic, while_in_mesh
from kinform.simulation.outcome.sensing import Probe, with_readings
from kinform.simulation.settings import Conduct, SolverSettings
from kinform.simulation.solver.dynamic import run_dynamic
from kinform.simulation.solver.friction_determinacy import friction_not_determined
from kinform.simulation.solver.kinematic import notes_of_rest, run_kinematic
from kinform.simulation.solver.start import Stated, begin, loop_rank, torn_at_start
from kinform.simulation.solver.stick_slip import run_with_friction
from kinform.simulation.solver.stops import beyond
from kinform.simulation.subject import Failures, refuse

OUTPUT_NUMBERS = 100_000_000
"""Numbers that a run gives in all, at all output times: 800 MB in the results file, and three times that while they are
computed. A four-bar has a hundred at each time."""
OUTPUT_TIMES = 10_000_000
"""Output times of a run, whatever it gives at each: with ten numbers at each as many numbers as the above."""


@dataclass(frozen=True, eq=False)
class Course:
    """How long, at which output times, under which gravity, at which level."""

    duration: float
    """s."""
    step: float
    """s, of the output."""
    gravity: Array = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    """(3,) m/s²."""
    level: SimulationLevel = "dynamic"
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
    probes: Sequence[Probe] = (),
) -> Simulation:
    """Simulates a port model made by hand, of any depth; SI and radians.

    `initial`: (position, velocity) of joints with one freedom by what they are called; 0 is the pose in
    which the model is written. `probes`: what to follow; their columns are `readings` and `sensed`. Refusals are in
    `failures` of what is returned, with the component. ValueError for initial values of joints that the system does not
    have, or that are no numbers, and for probes on what it does not have.
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
    _check_probes(probes, mechanism)
    failures = tuple((name, "no joints connect this body with the ground") for name in adrift)
    if course.level == "dynamic":
        failures += _unfit(system, mechanism)
    if failures:
        return refuse("the model is not complete", failures)
    conduct = Conduct(settings or SolverSettings(), progress, say)
    return run_course(system, mechanism, course, tuple(stated), (), conduct, tuple(probes))


def _check_probes(probes: Sequence[Probe], mechanism: Mechanism) -> None:
    """Raise ValueError for probes on bodies or joints that are not there."""
    joints = [slot.name for slot in mechanism.slots]
    for probe in probes:
        needed = [] if probe.kind == "reaction" else [probe.body]
        needed += [name for name in (probe.other, probe.frame) if name]
        for name in needed:
            if name not in mechanism.bodies:
                raise ValueError(
                    f'probe "{probe.name}": there is no body "{name}": there are {", ".join(mechanism.bodies)}'
                )
        if probe.kind == "reaction" and probe.joint not in joints:
            raise ValueError(f'probe "{probe.name}": there is no joint "{probe.joint}": there are {", ".join(joints)}')


def _unfit(system: System, mechanism: Mechanism) -> Failures:
    """(component, why) of moving bodies whose mass or inertia cannot be."""
    link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
    out = []
    for body in system.bodies:
        if link_of[body.subject] == 0:
            continue
        if isinstance(body, Ground) or body.mass is None:
            out.append((body.subject, "its mass is not known"))
            continue
        values = np.concatenate([[body.mass], *np.atleast_2d(body.inertia), body.centre_of_mass])
        if not np.all(np.isfinite(values)) or body.mass < 0.0:
            out.append((body.subject, "its mass, centre of mass or inertia is not a number, or negative"))
        elif not _inertial(np.asarray(body.inertia)):
            out.append((body.subject, "its inertia is not symmetric, or turns it the wrong way: a moment is negative"))
    return tuple(out)


def _inertial(inertia: Array) -> bool:
    """Whether a tensor (3, 3) is symmetric without a negative moment, but for rounding."""
    size = float(np.abs(inertia).max())
    symmetric = float(np.abs(inertia - inertia.T).max()) <= SOLVED * size
    return symmetric and float(np.linalg.eigvalsh(inertia).min()) >= -SOLVED * size


def run_course(
    system: System,
    mechanism: Mechanism,
    course: Course,
    stated: tuple[Stated, ...],
    notes: tuple[str, ...],
    conduct: Conduct,
    probes: tuple[Probe, ...] = (),
) -> Simulation:
    """Start and run the system; `notes` are what is assumed already."""
    dynamic, settings = course.level == "dynamic", conduct.settings
    actuation = Actuation(mechanism, system, with_mass=dynamic, until=course.duration)
    if actuation.conflicts:
        return refuse("the drives or the initial values cannot be applied", tuple(actuation.conflicts))
    start = begin(mechanism, actuation, stated, settings, coasting=dynamic)
    if start.problem is not None:
        return refuse("the mechanism cannot start", (start.problem,))
    overdriven, rank = loop_rank(mechanism, actuation, start, settings)
    if overdriven:
        return refuse("the drives cannot be followed", ((", ".join(mechanism.joints_of(actuation.led)), overdriven),))
    notes = (*notes, *actuation.notes, *start.notes)
    excess = _excess(mechanism, course)
    if excess:
        return refuse("the run would give too much", (("[simulation]", excess),))
    times = _grid(course.duration, course.step)
    if not dynamic:
        notes = (*notes, *notes_of_rest(mechanism, actuation, start, settings))
        record = while_in_mesh(mechanism, system, run_kinematic(mechanism, actuation, start, times, conduct))
        run, states = publish(mechanism, record, course.level, notes, settings.free)
        return with_readings(run, states, mechanism, probes)
    stuck = torn_at_start(mechanism, actuation, start, rank, settings)
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
    unclear = friction_not_determined(dynamics, start.q, settings)
    if unclear:
        return refuse("the friction is not determined", unclear)
    weightless = dynamics.weightless(start.q)
    if weightless:
        why = "its motion moves no mass: the acceleration is not determined"
        return refuse("a free motion has no inertia", tuple((name, why) for name in weightless))
    solve = run_with_friction if actuation.frictions else run_dynamic
    record = while_in_mesh(mechanism, system, solve(dynamics, start, times, conduct))
    run, states = publish_dynamic(dynamics, record, course.level, notes, settings)
    return with_readings(run, states, mechanism, probes)


def _excess(mechanism: Mechanism, course: Course) -> str:
    """Why a run of this length is not begun; "" where it is."""
    times = course.duration / course.step + 1.0 if course.step * OUTPUT_TIMES >= course.duration else np.inf
    numbers = times * numbers_at_a_time(mechanism, course.level)
    if numbers <= OUTPUT_NUMBERS:
        return ""
    much = f"{numbers:.3g}" if np.isfinite(numbers) else f"more than {OUTPUT_NUMBERS:,}"
    return (
        f"its output would be {much} numbers, and {OUTPUT_NUMBERS:,} are the most: state a longer step, which is the "
        "time between outputs (the solver chooses its own steps), or a shorter duration"
    )


def numbers_at_a_time(mechanism: Mechanism, level: SimulationLevel) -> int:
    """How many numbers the results of a run have at each output time: see `Simulation`."""
    bodies, joints, rates = len(mechanism.bodies), len(mechanism.slots), mechanism.rates
    poses, coordinates, monitors = 7 * bodies, 4 * rates, 6
    wrenches = 12 * joints + bodies + rates + 1 + 3 * len(mechanism.gear_v)
    return poses + coordinates + monitors + (wrenches if level == "dynamic" else 0)


def _grid(duration: float, step: float) -> Array:
    """Multiples of the step from zero, and the end itself."""
    times = np.arange(int(np.floor(duration / step + SOLVED)) + 1, dtype=np.float64) * step
    if duration - times[-1] > SOLVED * step:
        return np.append(times, duration)
    times[-1] = duration
    return times
