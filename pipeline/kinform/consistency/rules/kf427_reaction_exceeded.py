"""The reaction in a joint exceeds its limit of force or torque during the simulation.

The force that the two bodies exert on each other through the joint, and the torque about the joint's point, the
greatest of the output times; a smooth peak between them that would be above the limit makes the requirement inconclusive
(KF902), as do output times that are too few to follow the motion, and a shorter `step` decides. Components that redundant constraints leave undetermined, a simulation without
reactions, and one that did not run to its end make the requirement inconclusive (KF902).

Why it matters: the bearing, the pin or the screw is overloaded.

What to do: lighten or slow what moves, support it better, or take a larger bearing.

Example: `kind = "reaction"`, `joint = "elbow"`, `force = 250`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from kinform.consistency.comparisons.peaks import peak
from kinform.consistency.context import Context
from kinform.consistency.requirements import Answer, met, requirement_rule, simulated, undecided
from kinform.consistency.rule import Outcome
from kinform.foundation.words import number
from kinform.function import resolve
from kinform.model.function import Requirement
from kinform.model.simulation import Simulation

__all__ = ["RULE", "judge"]

REMEDY = "Lighten or slow what moves, support it better, or take a larger bearing."


def judge(context: Context, requirement: Requirement) -> Answer:
    """Peak force and torque beside their limits."""
    values, name = requirement.values, requirement.values["joint"]
    if "force" not in values and "torque" not in values:
        return undecided("it limits neither force nor torque", "State force, in N, or torque, in N·m.")
    kinematics = context.kinematics
    if isinstance(kinematics, Outcome):
        return undecided(kinematics.reason, "Run `kinform joints`.")
    joint = resolve(context.assembly, kinematics, name).joint
    if joint is None:
        return undecided(f"joint '{name}' is not found", "See KF401.")
    simulation = simulated(context, dynamic=True)
    if isinstance(simulation, Answer):
        return simulation
    wrenches = _wrenches(simulation, joint.name)
    if isinstance(wrenches, str):
        return undecided(wrenches, "Run the simulation with a version of kinform that computes reactions.")
    answers = []
    for key, unit, part in (("torque", "N·m", slice(0, 3)), ("force", "N", slice(3, 6))):
        if key not in values:
            continue
        if _open(simulation, joint.name)[part].any():
            return undecided(
                f"redundant constraints leave the {key} in joint '{name}' undetermined",
                "Remove the redundant constraints: see KF303.",
            )
        sizes = np.linalg.norm(wrenches[:, part], axis=1)
        answers.append(
            peak(
                simulation, sizes, values[key], f"the {key} in joint '{name}'",
                _in(unit), REMEDY, joint.point,
            )
        )  # fmt: skip
    for state in ("violated", "undecided"):
        for one in answers:
            if one.state == state:
                return one
    return met("; ".join(one.message for one in answers))


def _in(unit: str) -> Callable[[float, int], str]:
    return lambda value, digits: f"{number(value, digits)} {unit}"


def _wrenches(simulation: Simulation, joint: str) -> NDArray[np.float64] | str:
    """(T, 6) torque and force on the first body, or why they are not known."""
    every = getattr(simulation, "F_A", None)
    if every is None or len(every) != len(simulation.time):
        return "the simulation has no reactions"
    if joint not in simulation.joint_names:
        return f"the simulation does not have the joint '{joint}'"
    return np.asarray(every[:, simulation.joint_names.index(joint)])


def _open(simulation: Simulation, joint: str) -> NDArray[np.bool_]:
    """(6,) components that are not determined."""
    every = getattr(simulation, "undetermined", None)
    index = simulation.joint_names.index(joint)
    return np.zeros(6, dtype=np.bool_) if every is None or len(every) <= index else np.asarray(every[index])


RULE = requirement_rule("KF427", "reaction-exceeded", "reaction", __doc__, judge)
