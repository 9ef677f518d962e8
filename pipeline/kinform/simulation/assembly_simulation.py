"""Simulates an assembly: makes its port model, chooses the level, and runs it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from kinform.behaviour import Behaviour, JointComponent, build, one_freedom
from kinform.model.assembly import Assembly
from kinform.model.function import InitialValue, SimulationRequest
from kinform.model.kinematics import Kinematics
from kinform.model.mass import MassReport
from kinform.model.simulation import Simulation, SimulationLevel
from kinform.simulation.levels import (
    choose,
    notes_of_drives,
    notes_of_freedoms,
    notes_of_friction,
    notes_of_joints,
    notes_of_level,
    notes_of_stops,
    notes_of_teeth,
)
from kinform.simulation.mechanism.construction import assemble
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.mechanism.uncertainty import loop_uncertainty
from kinform.simulation.probes import probes_of
from kinform.simulation.settings import Conduct
from kinform.simulation.solver.start import Stated
from kinform.simulation.subject import Failures, are_gears_ideal, refuse, simulated_joints
from kinform.simulation.system_simulation import Course, run_course


def simulate_assembly(
    assembly: Assembly,
    kinematics: Kinematics,
    mass: MassReport | None,
    asked: SimulationLevel | None,
    behaviour: Behaviour | None,
    conduct: Conduct,
) -> Simulation:
    """What `simulate` gives, at the level that is asked for, or, with None, at the highest that is known."""
    gears = are_gears_ideal(assembly, asked)
    kinematics = simulated_joints(assembly, kinematics, asked)
    if gears and not kinematics.joints:
        return refuse(
            "nothing to simulate", (("[function]", "it states no joints, and there are no meshes to find them in"),)
        )
    if sum(body.ground for body in kinematics.bodies) != 1:
        return refuse("there is no ground", (("ground", "not exactly one body is the ground"),))
    if behaviour is None:
        behaviour = build(assembly, kinematics, mass, gears=gears)
    if behaviour.failures:
        reason = "the model is not complete"
        if all(_not_understood(kinematics, subject) for subject, _ in behaviour.failures):
            reason += " (partial = true in [simulation] holds what is not understood, and moves the rest)"
        return refuse(reason, behaviour.failures)
    mechanism, adrift = assemble(behaviour.system)
    mechanism = replace(mechanism, uncertain=loop_uncertainty(kinematics, mechanism.length))
    formless = all(part.mesh is None for part in assembly.parts)
    choice = choose(asked, behaviour, mechanism, adrift, formless)
    if choice.failures:
        return refuse(f"the {asked} level needs more than is known", choice.failures)
    notes = (
        *_notes_of_request(assembly),
        *notes_of_joints(kinematics),
        *notes_of_teeth(kinematics),
        *notes_of_freedoms(assembly, kinematics),
        *notes_of_stops(assembly, kinematics, behaviour.system),
        *(notes_of_drives(assembly.function.drives) if choice.level == "dynamic" else ()),
        *(notes_of_friction(behaviour.system) if choice.level == "dynamic" else ()),
        *notes_of_level(assembly, kinematics, behaviour, choice.level, adrift, gears),
    )
    request, system = assembly.simulation or SimulationRequest(), behaviour.system
    joints = {joint.subject: joint for joint in system.joints}
    stated, failures = _stated_values(assembly, kinematics, joints, mechanism, request.initial)
    if failures:
        return refuse("the drives or the initial values cannot be applied", failures)
    course = Course(request.duration, request.step, np.asarray(request.gravity, dtype=np.float64), choice.level)
    probes, silent = probes_of(assembly, kinematics, mass, joints, choice.level)
    run = run_course(system, mechanism, course, stated, (*notes, *silent), conduct, probes)
    run = replace(run, not_dynamic=choice.not_dynamic)
    return _partial(run, behaviour.held) if behaviour.held else run


def _not_understood(kinematics: Kinematics, subject: str) -> bool:
    """Whether it is a joint of geometry that a partial simulation holds."""
    return subject in [joint.name for joint in kinematics.joints]


def _partial(run: Simulation, held: Failures) -> Simulation:
    """The run for what it is: one of a mechanism in which these joints were held."""
    names = ", ".join(dict.fromkeys(subject for subject, _ in held))
    why = f"held, because not understood: {names}"
    if run.status == "done":
        return replace(run, status="partial", reason=why, failures=held)
    return replace(run, reason=f"{run.reason} ({why})", failures=(*run.failures, *held))


def _stated_values(
    assembly: Assembly,
    kinematics: Kinematics,
    joints: Mapping[str, JointComponent],
    mechanism: Mechanism,
    values: tuple[InitialValue, ...],
) -> tuple[tuple[Stated, ...], Failures]:
    """The stated values of joints with one freedom, and (subject, why) of those that have no such joint."""
    slots = {slot.name: slot for slot in mechanism.slots}
    stated: dict[str, Stated] = {}
    failures = []
    for value in values:
        on = one_freedom(assembly, kinematics, joints, value.joint, value.freedom)
        if isinstance(on, str) or not on.valued:
            why = on if isinstance(on, str) else "a ball's turn about one direction has a rate and no value"
            failures.append((value.joint, f"initial value: {why}"))
            continue
        joint = on.joint
        if joint.subject in stated:
            failures.append((value.joint, f'the joint "{joint.subject}" has two initial values'))
            continue
        unit = on.sign * (math.pi / 180.0 if on.turns else value.metres_per_unit)
        if not (math.isfinite(value.position) and math.isfinite(value.velocity)):
            failures.append((value.joint, "its initial value is not a number"))
            continue
        slot = slots[joint.subject]
        stated[joint.subject] = Stated(
            value.joint, slot.q.start + on.freedom, slot.v.start + on.freedom,
            unit * value.position, unit * value.velocity, value.solved,
        )  # fmt: skip
    return tuple(stated.values()), tuple(failures)


def _notes_of_request(assembly: Assembly) -> tuple[str, ...]:
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
