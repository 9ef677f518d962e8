"""The static effort that holds a joint in a pose exceeds its limit.

Gravity, loads and springs by virtual work, at each of the poses (joints that a pose does not name stay at the pose
of the meshes, or go where loops put them); other drives stand still; joints that close no loop are held. Where
friction is stated (drives of kind friction) it is the least effort that holds the joint with all that friction at
rest can hold, and what it would take without is told beside it. An unknown mass, a loop in which it is not stated
which joint holds, or a joint that shares the load with other drives make the requirement inconclusive (KF902).

Why it matters: the arm sinks, or the motor overheats while it does nothing.

What to do: balance the joint, lighten what it carries, or take a stronger or self-locking drive.

Example: `kind = "hold"`, `joint = "shoulder"`, `limit = 1.5`, `poses = [{shoulder = 90, elbow = 0}]`.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from kinform.consistency.comparisons.driving import AT_END, driven_in, pose_words, worst
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, Margin, met, undecided, violated
from kinform.consistency.requirements import (
    SINGLE,
    effort,
    requirement_rule,
    single_joint,
    stated_as,
    unit_of_effort,
)
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.words import counted, telling
from kinform.function import resolve_joint
from kinform.function.configurations import Chain, mechanism_of
from kinform.function.holding import Force, configuration_at, holding_effort
from kinform.function.requirement_kinds import Hold
from kinform.model.arrays import Array
from kinform.model.function import SimulationRequest
from kinform.model.kinematics import Joint

REMEDY = "Balance the joint, lighten what it carries, or take a stronger drive."
STATE = "State masses, drives and joints so that the load is determined."


def judge(context: Context, requirement: Hold) -> Answer:
    """The greatest holding effort of all poses beside the limit."""
    name = requirement.joint
    joint = single_joint(context, name)
    if isinstance(joint, Answer):
        return joint
    if context.lacks("mass"):
        return undecided("masses have not been computed", "Run `kinform mass`.")
    if context.function.rubs:
        return _with_friction(context, requirement)
    chain = mechanism_of(context.assembly, context.kinematics)
    if isinstance(chain, str):
        return undecided(chain, "See KF401 and KF901.")
    most, where = -1.0, ""
    poses = requirement.poses or [{}]
    for pose in poses:
        held = _held(context, chain, joint, pose)
        if isinstance(held, str):
            why = held.replace(f"'{joint.name}'", f"'{name}'")
            return undecided(f"at {pose_words(context, pose)}: {why}", STATE)
        if abs(held) > most:
            most, where = abs(held), pose_words(context, pose)
    shown = telling(lambda value, digits: effort(value, joint, digits), most, requirement.limit)
    text = f"joint '{name}' takes {shown(most)} to hold {where}"
    limit = f"at most {shown(requirement.limit)}"
    margin = Margin(requirement.limit - most, unit_of_effort(joint))
    if most > requirement.limit:
        return violated(
            f"{text}, required is {limit}", found=shown(most), intended=limit, place=joint.point, remedy=REMEDY,
            margin=margin,
        )  # fmt: skip
    text = f"{text}, the most of {counted(len(poses), 'pose')}"
    return met(text, found=shown(most), intended=limit, margin=margin)


def _with_friction(context: Context, requirement: Hold) -> Answer:
    """The same where friction helps to hold."""
    name = requirement.joint
    found = driven_in(context, name, requirement.poses)
    if isinstance(found, Answer):
        return found
    where, driving, joint = worst(found, lambda one: one.least)
    shown = telling(lambda value, digits: effort(value, joint, digits), driving.least, requirement.limit)
    without = f"{shown(abs(driving.without))} without friction"
    text = f"joint '{name}' takes {shown(driving.least)} to hold {where}, with friction at rest ({without})"
    limit = f"at most {shown(requirement.limit)}"
    margin = Margin(requirement.limit - driving.least, unit_of_effort(joint))
    if driving.least > requirement.limit:
        return violated(
            f"{text}, required is {limit}", found=shown(driving.least), intended=limit, place=joint.point,
            remedy=REMEDY, margin=margin,
        )  # fmt: skip
    text = f"{text}, the most of {counted(len(found), 'pose')}"
    return met(text, found=shown(driving.least), intended=limit, margin=margin)


def _held(context: Context, chain: Chain, joint: Joint, pose: Mapping[str, float]) -> float | str:
    """The effort in one pose, or why it is not determined."""
    assembly, kinematics = context.assembly, context.kinematics
    if context.function.springs:
        return "springs between two points are not reckoned with: only a dynamic run with the joint held shows it"
    if any(load.law is not None for load in context.function.loads):
        return "a load changes over time: only a dynamic run with the joint held shows it"
    wanted: dict[str, float] = {}
    for name, value in pose.items():
        resolution = resolve_joint(assembly, kinematics, name)
        if resolution.joint is None:
            return f"joint '{name}' is not found: {resolution.reason}"
        wanted[resolution.joint.name] = resolution.sign * value
    for coordinate in chain.coordinates:
        asked = wanted.get(coordinate.joint)
        if asked is not None and not coordinate.lower - AT_END <= asked <= coordinate.upper + AT_END:
            return f"joint '{stated_as(context, coordinate.joint)[0]}' would be outside of its range"
    q = configuration_at(chain, wanted)
    if isinstance(q, str):
        return q
    values: dict[str, float] = {c.joint: float(x) / c.unit for c, x in zip(chain.coordinates, q, strict=True)}
    drives: list[str] = []
    springs: dict[str, float] = {}
    for drive in context.function.drives:
        resolution = resolve_joint(assembly, kinematics, drive.joint)
        driven = resolution.joint
        if driven is None:
            continue
        if drive.kind == "spring":
            rest = resolution.sign * drive.parameters.get("rest", 0.0) * drive.scale(driven.type != "prismatic")
            pull = drive.parameters["stiffness"] * (rest - values.get(driven.name, 0.0))
            springs[driven.name] = springs.get(driven.name, 0.0) + pull
        elif drive.kind != "damper":
            drives.append(driven.name)
    return holding_effort(chain, q, joint.name, drives, springs, _force(context))


def _force(context: Context) -> Force:
    """Gravity and loads on a body that is displaced by X."""
    kinematics = context.kinematics
    gravity = np.asarray((context.assembly.simulation or SimulationRequest()).gravity, dtype=np.float64)
    properties = {p.name: p for p in context.mass.bodies}
    loads = [
        (kinematics.body_of(context.assembly.parts_of(load.part)[0]).name, load) for load in context.function.loads
    ]

    def force(body: str, X: Array) -> tuple[Array, Array] | None:
        weight = properties[body]
        if weight.mass is None:
            return None
        R, p = X[:3, :3], X[:3, 3]
        total = weight.mass * gravity
        moment = cross(R @ weight.centre_of_mass + p, total)
        for name, load in loads:
            if name != body:
                continue
            turn = R if load.frame == "body" else np.eye(3)
            point = R @ (weight.centre_of_mass if load.point is None else load.point) + p
            if load.force is not None:
                total = total + turn @ load.force
                moment = moment + cross(point, turn @ load.force)
            if load.torque is not None:
                moment = moment + turn @ load.torque
        return total, moment

    return force


RULE = requirement_rule("KF424", "holding-effort-exceeded", Hold, __doc__, judge, SINGLE)
