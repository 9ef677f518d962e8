"""Simulates an assembly at the level that is known: chooses, starts, runs, records."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kinform.behaviour import Behaviour, build
from kinform.model.assembly import Assembly
from kinform.model.function import SimulationRequest
from kinform.model.kinematics import Kinematics
from kinform.model.mass import MassReport
from kinform.model.simulation import Simulation
from kinform.simulation.actuation import Actuation
from kinform.simulation.assemble import assemble
from kinform.simulation.closure import rank_of
from kinform.simulation.dynamics import Dynamics
from kinform.simulation.integrate import run_dynamic
from kinform.simulation.kinematic import resting, run_kinematic
from kinform.simulation.levels import LEVELS, Choice, choose, notes_of_joints, notes_of_level
from kinform.simulation.mechanism import Mechanism
from kinform.simulation.record import Record, blank, publish
from kinform.simulation.settings import SolverSettings
from kinform.simulation.start import Start, begin, stated_values

__all__ = ["simulate"]

Array = NDArray[np.float64]
Failures = tuple[tuple[str, str], ...]
Progress = Callable[[int, int], None]


def simulate(
    assembly: Assembly,
    kinematics: Kinematics,
    mass: MassReport | None,
    *,
    level: str | None = None,
    progress: Progress | None = None,
    settings: SolverSettings | None = None,
) -> Simulation:
    """Poses, joint values, efforts and energy over time, SI and radians.

    `level` goes before that of the manifest; with neither the highest that is known is taken. What
    cannot be simulated is refused with the reasons in `failures`, and a run that cannot go on keeps
    what it has; neither raises. ValueError for a level that does not exist.
    """
    asked = level or (assembly.simulation.level if assembly.simulation else None)
    if asked is not None and asked not in LEVELS:
        raise ValueError(f'level "{asked}": expected one of {", ".join(LEVELS)}')
    if assembly.simulation is None and level is None and not assembly.function.drives:
        return blank("not requested", "there is neither [simulation] nor a drive")
    model = _model(assembly, kinematics, mass, asked)
    if isinstance(model, Simulation):
        return model
    chosen = settings or replace(SolverSettings(), free=assembly.tolerances.free)
    return _run(assembly, model, chosen, progress)


@dataclass(frozen=True, eq=False)
class _Model:
    """What is simulated, at which level, and what is assumed of it."""

    kinematics: Kinematics
    behaviour: Behaviour
    mechanism: Mechanism
    level: str
    notes: tuple[str, ...]


def _model(
    assembly: Assembly, kinematics: Kinematics, mass: MassReport | None, asked: str | None
) -> _Model | Simulation:
    """The model at the level asked for or known, or the refusal."""
    formless = all(part.mesh is None for part in assembly.parts)
    gears = formless or asked == "functional"
    if asked == "functional":
        from kinform.kinematics import functional

        kinematics = functional(assembly)
    if gears and not kinematics.joints:
        return _refuse(
            "nothing to simulate", (("[function]", "it states no joints, and there are no meshes to find them in"),)
        )
    if sum(body.ground for body in kinematics.bodies) != 1:
        return _refuse("there is no ground", (("ground", "not exactly one body is the ground"),))
    behaviour = build(assembly, kinematics, mass, gears=gears)
    if behaviour.failures:
        return _refuse("the model is not complete", behaviour.failures)
    mechanism, adrift = assemble(behaviour.system)
    choice: Choice = choose(asked, behaviour, mechanism, adrift, formless)
    if choice.failures:
        return _refuse(f"the {asked} level needs more than is known", choice.failures)
    notes = (
        *_of_request(assembly),
        *choice.notes,
        *notes_of_joints(kinematics),
        *notes_of_level(assembly, behaviour, choice.level, adrift, gears),
    )
    return _Model(kinematics, behaviour, mechanism, choice.level, notes)


def _run(assembly: Assembly, model: _Model, settings: SolverSettings, progress: Progress | None) -> Simulation:
    """Start and run the model."""
    request = assembly.simulation or SimulationRequest()
    mechanism, system = model.mechanism, model.behaviour.system
    dynamic = model.level == "dynamic"
    actuation = Actuation(mechanism, system, with_mass=dynamic)
    joints = {joint.subject: joint for joint in system.joints}
    stated, failures = stated_values(assembly, model.kinematics, joints, mechanism, request.initial)
    failures = (*actuation.conflicts, *failures)
    if failures:
        return _refuse("the drives or the initial values cannot be applied", failures)
    start = begin(mechanism, actuation, stated, settings, coasting=dynamic)
    if start.problem is not None:
        return _refuse("the mechanism cannot start", (start.problem,))
    overdriven, rank = _ranks(mechanism, actuation, start, settings)
    if overdriven:
        return _refuse("the drives cannot be followed", ((_driven(mechanism, actuation), overdriven),))
    notes = (*model.notes, *actuation.notes, *start.notes)
    times = _grid(request.duration, request.step)
    record: Record
    if dynamic:
        dynamics = Dynamics(mechanism, system, np.asarray(request.gravity, dtype=np.float64), actuation, rank)
        weightless = dynamics.weightless(start.q)
        if weightless:
            why = "its motion moves no mass: the acceleration is not determined"
            return _refuse("a free motion has no inertia", tuple((name, why) for name in weightless))
        record = run_dynamic(dynamics, start, times, settings, progress)
    else:
        notes = (*notes, *resting(mechanism, actuation, start, settings))
        record = run_kinematic(mechanism, actuation, start, times, settings, progress)
    return publish(mechanism, record, model.level, notes, settings.free)


def _of_request(assembly: Assembly) -> tuple[str, ...]:
    """The values that hold where the manifest has no [simulation]."""
    if assembly.simulation is not None:
        return ()
    default = SimulationRequest()
    gravity = ", ".join(f"{x:g}" for x in default.gravity)
    return (
        f"there is no [simulation]: duration {default.duration:g} s, step {default.step:g} s, "
        f"gravity ({gravity}) m/s², all joints at rest at the pose of the meshes",
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
    return (
        "the loops leave these drives no freedom at the start: there are too many of them, "
        "or the mechanism starts in a singular pose",
        rank,
    )


def _driven(mechanism: Mechanism, actuation: Actuation) -> str:
    led = set(actuation.led.tolist())
    return ", ".join(slot.name for slot in mechanism.slots if slot.v.start in led and slot.v.stop > slot.v.start)


def _refuse(reason: str, failures: Failures) -> Simulation:
    """Nothing is simulated, and why."""
    subject, why = failures[0]
    return blank("refused", f"{reason}: {subject}: {why}", failures)
