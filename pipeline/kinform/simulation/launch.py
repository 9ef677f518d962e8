"""Chooses the level at which an assembly is simulated, starts its model and runs it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.behaviour import Behaviour, build
from kinform.foundation.progress import Progress, Say
from kinform.model.assembly import Assembly
from kinform.model.function import SimulationRequest
from kinform.model.kinematics import Kinematics
from kinform.model.mass import MassReport
from kinform.model.simulation import Simulation
from kinform.simulation.levels import (
    Choice,
    choose,
    notes_of_drives,
    notes_of_joints,
    notes_of_level,
    notes_of_teeth,
)
from kinform.simulation.mechanism.assembly import assemble
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.modelled import geared, seen
from kinform.simulation.solver.settings import SolverSettings
from kinform.simulation.solver.solution import Course, refuse, solve
from kinform.simulation.solver.start import stated_values

__all__ = ["launched"]


def launched(
    assembly: Assembly,
    kinematics: Kinematics,
    mass: MassReport | None,
    asked: str | None,
    settings: SolverSettings,
    progress: Progress | None,
    say: Say | None,
    behaviour: Behaviour | None,
) -> Simulation:
    """What `simulate` gives, at the level that is asked for, or, with None, at the highest that is known."""
    model = _model(assembly, kinematics, mass, asked, behaviour)
    return model if isinstance(model, Simulation) else _run(assembly, model, settings, progress, say)


@dataclass(frozen=True, eq=False)
class _Model:
    """What is simulated, at which level, and what is assumed of it."""

    kinematics: Kinematics
    behaviour: Behaviour
    mechanism: Mechanism
    level: str
    notes: tuple[str, ...]


def _model(
    assembly: Assembly, kinematics: Kinematics, mass: MassReport | None, asked: str | None, made: Behaviour | None
) -> _Model | Simulation:
    """The model at the level asked for or known, or the refusal."""
    gears = geared(assembly, asked)
    kinematics = seen(assembly, kinematics, asked)
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
