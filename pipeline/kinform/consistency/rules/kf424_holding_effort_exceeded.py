"""The static effort that holds a joint in a pose exceeds its limit.

Gravity, loads and springs by virtual work, at each of the poses (joints that a pose does not name stay at the pose
of the meshes, or go where loops put them); other drives stand still; joints that close no loop are held. Friction
plays no part. An unknown mass, a loop in which it is not stated which joint holds, or a joint that shares the load
with other drives make the requirement inconclusive (KF902).

Why it matters: the arm sinks, or the motor overheats while it does nothing.

What to do: balance the joint, lighten what it carries, or take a stronger or self-locking drive.

Example: `kind = "hold"`, `joint = "shoulder"`, `limit = 1.5`, `poses = [{shoulder = 90, elbow = 0}]`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kinform.consistency.context import Context
from kinform.consistency.requirements import (
    Answer,
    effort,
    met,
    requirement_rule,
    resolved,
    shown_value,
    stated_as,
    undecided,
    violated,
)
from kinform.consistency.rule import Outcome
from kinform.foundation.words import counted, telling
from kinform.function import resolve
from kinform.function.configurations import Chain, mechanism_of
from kinform.function.holding import holding_effort, posed
from kinform.model.arrays import Array
from kinform.model.function import Requirement, SimulationRequest
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.mass import MassReport

__all__ = ["RULE", "judge"]


AT_END = 1e-6
"""rad or m: a pose at the very end of a range is inside."""
REMEDY = "Balance the joint, lighten what it carries, or take a stronger drive."
STATE = "State masses, drives and joints so that the load is determined."


def judge(context: Context, requirement: Requirement) -> Answer:
    """The greatest holding effort of all poses beside the limit."""
    values, name = requirement.values, requirement.values["joint"]
    found = resolved(context, name)
    if isinstance(found, Answer):
        return found
    joint, kinematics, mass = found[0], context.kinematics, context.mass
    if isinstance(mass, Outcome) or isinstance(kinematics, Outcome):
        return undecided("masses have not been computed", "Run `kinform mass`.")
    chain = mechanism_of(context.assembly, kinematics)
    if isinstance(chain, str):
        return undecided(chain, "See KF401 and KF901.")
    worst, where = -1.0, ""
    poses = values.get("poses") or [{}]
    for pose in poses:
        held = _held(context, kinematics, mass, chain, joint, pose)
        if isinstance(held, str):
            told = held.replace(f"'{joint.name}'", f"'{name}'")
            return undecided(f"at {_shown(context, kinematics, pose)}: {told}", STATE)
        if abs(held) > worst:
            worst, where = abs(held), _shown(context, kinematics, pose)
    shown = telling(lambda value, digits: effort(value, joint, digits), worst, values["limit"])
    text = f"joint '{name}' takes {shown(worst)} to hold {where}"
    limit = f"at most {shown(values['limit'])}"
    if worst > values["limit"]:
        return violated(
            f"{text}, required is {limit}", found=shown(worst), intended=limit, place=joint.point, remedy=REMEDY
        )
    return met(f"{text}, the most of {counted(len(poses), 'pose')}", found=shown(worst), intended=limit)


def _held(
    context: Context, kinematics: Kinematics, mass: MassReport, chain: Chain, joint: Joint, pose: dict[str, float]
) -> float | str:
    """The effort in one pose."""
    wanted: dict[str, float] = {}
    for name, value in pose.items():
        found = resolve(context.assembly, kinematics, name)
        if found.joint is None:
            return f"joint '{name}' is not found: {found.reason}"
        wanted[found.joint.name] = found.sign * value
    for coordinate in chain.coordinates:
        asked = wanted.get(coordinate.joint)
        if asked is not None and not coordinate.lower - AT_END <= asked <= coordinate.upper + AT_END:
            return f"joint '{stated_as(context, coordinate.joint)[0]}' would be outside of its range"
    q = posed(chain, wanted)
    if isinstance(q, str):
        return q
    values: dict[str, float] = {c.joint: float(x) / c.unit for c, x in zip(chain.coordinates, q, strict=True)}
    drives: list[str] = []
    springs: dict[str, float] = {}
    for drive in context.function.drives:
        found = resolve(context.assembly, kinematics, drive.joint)
        if found.joint is None:
            continue
        if drive.kind == "spring":
            rest = found.sign * drive.parameters.get("rest", 0.0) * drive.scale(found.joint.type != "prismatic")
            pull = drive.parameters["stiffness"] * (rest - values.get(found.joint.name, 0.0))
            springs[found.joint.name] = springs.get(found.joint.name, 0.0) + pull
        elif drive.kind != "damper":
            drives.append(found.joint.name)
    return holding_effort(chain, q, joint.name, drives, springs, _force(context, kinematics, mass))


def _force(
    context: Context, kinematics: Kinematics, mass: MassReport
) -> Callable[[str, Array], tuple[Array, Array] | None]:
    """Gravity and loads on a body that is displaced by X."""
    gravity = np.asarray((context.assembly.simulation or SimulationRequest()).gravity, dtype=np.float64)
    properties = {p.name: p for p in mass.bodies}
    loads = [
        (kinematics.body_of(context.assembly.parts_of(load.part)[0]).name, load) for load in context.function.loads
    ]

    def force(body: str, X: Array) -> tuple[Array, Array] | None:
        own = properties[body]
        if own.mass is None:
            return None
        R, p = X[:3, :3], X[:3, 3]
        total = own.mass * gravity
        moment = np.cross(R @ own.centre_of_mass + p, total)
        for name, load in loads:
            if name != body:
                continue
            turn = R if load.frame == "body" else np.eye(3)
            point = R @ (own.centre_of_mass if load.point is None else load.point) + p
            if load.force is not None:
                total = total + turn @ load.force
                moment = moment + np.cross(point, turn @ load.force)
            if load.torque is not None:
                moment = moment + turn @ load.torque
        return total, moment

    return force


def _shown(context: Context, kinematics: Kinematics, pose: dict[str, float]) -> str:
    """The pose in words."""
    if not pose:
        return "the pose of the meshes"
    shown = []
    for name, value in sorted(pose.items()):
        joint = resolve(context.assembly, kinematics, name).joint
        shown.append(f"{name} = {value:g}" if joint is None else f"{name} = {shown_value(value, joint, context.units)}")
    return ", ".join(shown)


RULE = requirement_rule("KF424", "holding-effort-exceeded", "hold", __doc__, judge)
