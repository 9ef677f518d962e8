"""The reaction in a joint exceeds its limit of force or torque during the simulation.

The force that the two bodies exert on each other through the joint, and the torque about the joint's point, the
greatest of the output times; a smooth peak between them that would be above the limit makes the requirement
inconclusive (KF902), as do output times that are too few to follow the motion, and a shorter `step` decides.
Components that redundant constraints leave undetermined, a simulation without reactions, and one that did not run to
its end make the requirement inconclusive (KF902).

Why it matters: the bearing, the pin or the screw is overloaded.

What to do: lighten or slow what moves, support it better, or take a larger bearing.

Example: `kind = "reaction"`, `joint = "elbow"`, `force = 250`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from kinform.consistency.comparisons.limits import Quantity, peak_beside_limit
from kinform.consistency.context import Context
from kinform.consistency.outcome import Answer, met, undecided
from kinform.consistency.requirements import JOINTS, requirement_rule, simulated, worst_of
from kinform.foundation.words import number
from kinform.function import resolve_joint
from kinform.function.requirement_kinds import Reaction

REMEDY = "Lighten or slow what moves, support it better, or take a larger bearing."
COMPUTE = "Run the simulation with a version of kinform that computes reactions."


def judge(context: Context, requirement: Reaction) -> Answer:
    """Peak force and torque beside their limits."""
    name = requirement.joint
    limits = (("torque", "N·m", requirement.torque, slice(0, 3)), ("force", "N", requirement.force, slice(3, 6)))
    if all(limit is None for _, _, limit, _ in limits):
        return undecided("it limits neither force nor torque", "State force, in N, or torque, in N·m.")
    joint = resolve_joint(context.assembly, context.kinematics, name).joint
    if joint is None:
        return undecided(f"joint '{name}' is not found", "See KF401.")
    simulation = simulated(context, dynamic=True)
    if isinstance(simulation, Answer):
        return simulation
    if len(simulation.F_A) != len(simulation.time):
        return undecided("the simulation has no reactions", COMPUTE)
    if joint.name not in simulation.joint_names:
        return undecided(f"the simulation does not have the joint '{joint.name}'", COMPUTE)
    index = simulation.joint_names.index(joint.name)
    answers = []
    for key, unit, limit, part in limits:
        if limit is None:
            continue
        if len(simulation.undetermined) > index and simulation.undetermined[index, part].any():
            return undecided(
                f"redundant constraints leave the {key} in joint '{name}' undetermined",
                "Remove the redundant constraints: see KF303.",
            )
        quantity = Quantity(f"the {key} in joint '{name}'", _shown_in(unit), REMEDY, unit, joint.point)
        sizes = np.linalg.norm(simulation.F_A[:, index, part], axis=1)
        answers.append(peak_beside_limit(quantity, simulation, sizes, limit))
    margin = answers[0].margin if len(answers) == 1 else None
    return worst_of(answers) or met("; ".join(answer.message for answer in answers), margin=margin)


def _shown_in(unit: str) -> Callable[[float, int], str]:
    return lambda value, digits: f"{number(value, digits)} {unit}"


RULE = requirement_rule("KF427", "reaction-exceeded", Reaction, __doc__, judge, JOINTS)
