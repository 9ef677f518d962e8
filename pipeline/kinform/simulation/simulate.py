"""Simulates an assembly at the level that is known: chooses, starts, runs, records."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from kinform.behaviour import Behaviour, build
from kinform.model.assembly import Assembly
from kinform.model.function import SimulationRequest
from kinform.model.kinematics import Kinematics
from kinform.model.mass import MassReport
from kinform.model.simulation import Simulation
from kinform.simulation.assemble import assemble
from kinform.simulation.levels import (
    LEVELS,
    Choice,
    choose,
    notes_of_drives,
    notes_of_joints,
    notes_of_level,
    notes_of_teeth,
)
from kinform.simulation.mechanism import Mechanism
from kinform.simulation.record import blank
from kinform.simulation.settings import SolverSettings
from kinform.simulation.solve import Course, refuse, solve
from kinform.simulation.start import stated_values

__all__ = ["modelled", "simulate"]

Progress = Callable[[int, int], None]
Say = Callable[[str], None]


def simulate(
    assembly: Assembly,
    kinematics: Kinematics,
    mass: MassReport | None,
    *,
    level: str | None = None,
    progress: Progress | None = None,
    settings: SolverSettings | None = None,
    say: Say | None = None,
    behaviour: Behaviour | None = None,
) -> Simulation:
    """Poses, joint values, efforts and energy over time, SI and radians.

    `level` goes before that of the manifest; with neither the highest that is known is taken. What
    cannot be simulated is refused with the reasons in `failures`, and a run that cannot go on keeps
    what it has; neither raises. `say` is told what takes long besides; `behaviour` is what `modelled` made of the
    same values, where that is known already. ValueError for a level that does not exist.
    """
    asked = level or (assembly.simulation.level if assembly.simulation else None)
    if asked is not None and asked not in LEVELS:
        raise ValueError(f'level "{asked}": expected one of {", ".join(LEVELS)}')
    if assembly.simulation is None and level is None and not assembly.function.drives:
        return blank("not requested", "there is neither [simulation] nor a drive")
    model = _model(assembly, kinematics, mass, asked, behaviour)
    if isinstance(model, Simulation):
        return model
    chosen = settings or replace(SolverSettings(), free=assembly.tolerances.free)
    return _run(assembly, model, chosen, progress, say)


@dataclass(frozen=True, eq=False)
class _Model:
    """What is simulated, at which level, and what is assumed of it."""

    kinematics: Kinematics
    behaviour: Behaviour
    mechanism: Mechanism
    level: str
    notes: tuple[str, ...]


def modelled(
    assembly: Assembly, kinematics: Kinematics, mass: MassReport | None, *, level: str | None = None
) -> Behaviour:
    """The port model that `simulate` solves at that level, whatever is wrong with it."""
    asked = level or (assembly.simulation.level if assembly.simulation else None)
    return build(assembly, _seen(assembly, kinematics, asked), mass, gears=_geared(assembly, asked))


def _seen(assembly: Assembly, kinematics: Kinematics, asked: str | None) -> Kinematics:
    """The joints that are simulated: those of geometry, or of the function where that is asked for."""
    if asked != "functional":
        return kinematics
    from kinform.kinematics import functional

    return functional(assembly)


def _geared(assembly: Assembly, asked: str | None) -> bool:
    return asked == "functional" or all(part.mesh is None for part in assembly.parts)


def _model(
    assembly: Assembly, kinematics: Kinematics, mass: MassReport | None, asked: str | None, made: Behaviour | None
) -> _Model | Simulation:
    """The model at the level asked for or known, or the refusal."""
    gears = _geared(assembly, asked)
    kinematics = _seen(assembly, kinematics, asked)
    if gears and not kinematics.joints:
        return refuse(
            "nothing to simulate", (("[function]", "it states no joints, and there are no meshes to find them in"),)
        )
    if sum(body.ground for body in kinematics.bodies) != 1:
        return refuse("there is no ground", (("ground", "not exactly one body is the ground"),))
    behaviour = build(assembly, kinematics, mass, gears=gears) if made is None else made
    if behaviour.failures:
        return refuse("the model is not complete", behaviour.failures)
    mechanism, adrift = assemble(behaviour.system)
    formless = all(part.mesh is None for part in assembly.parts)
    choice: Choice = choose(asked, behaviour, mechanism, adrift, formless)
    if choice.failures:
        return refuse(f"the {asked} level needs more than is known", choice.failures)
    notes = (
        *_of_request(assembly),
        *choice.notes,
        *notes_of_joints(kinematics),
        *notes_of_teeth(kinematics),
        *(notes_of_drives(assembly.function.drives) if choice.level == "dynamic" else ()),
        *notes_of_level(assembly, kinematics, behaviour, choice.level, adrift, gears),
    )
    return _Model(kinematics, behaviour, mechanism, choice.level, notes)


def _run(
    assembly: Assembly, model: _Model, settings: SolverSettings, progress: Progress | None, say: Say | None
) -> Simulation:
    """Start and run the model."""
    request = assembly.simulation or SimulationRequest()
    system = model.behaviour.system
    joints = {joint.subject: joint for joint in system.joints}
    stated, failures = stated_values(assembly, model.kinematics, joints, model.mechanism, request.initial)
    if failures:
        return refuse("the drives or the initial values cannot be applied", failures)
    course = Course(request.duration, request.step, np.asarray(request.gravity, dtype=np.float64), model.level)
    return solve(system, model.mechanism, course, stated, model.notes, settings, progress, say)


def _of_request(assembly: Assembly) -> tuple[str, ...]:
    """The values that hold where the manifest states none."""
    request, default = assembly.simulation, SimulationRequest()
    gravity = ", ".join(f"{x:g}" for x in default.gravity)
    values = {
        "duration": f"duration {default.duration:g} s",
        "step": f"step {default.step:g} s",
        "gravity": f"gravity ({gravity}) m/s²",
    }
    if request is None:
        return (
            f"there is no [simulation]: {', '.join(values.values())}, all joints at rest at the pose of the meshes",
        )
    if not request.assumed:
        return ()
    return (f"[simulation] does not state: {', '.join(values[name] for name in values if name in request.assumed)}",)
