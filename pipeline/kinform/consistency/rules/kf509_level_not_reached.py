"""The run has no forces, although what is stated lets expect them.

No `level` is asked for, and the highest that is known is below dynamic: a mass, the radius or the coefficient of a
friction, or a joint with the ground is missing. Inconclusive where drives, friction, springs, loads, losses of gears or
initial velocities are stated, as these did nothing in the run. A note where only motions are: they are as stated, and
without the efforts that they take. Nothing is said of bodies without meshes and masses that only follow motions. A
`level` that is asked for and not reached is refused: KF501.

Why it matters: friction that is left out brakes nothing, and the motion looks as if it had been simulated with it.

What to do: state what is missing, or ask for `level = "kinematic"` if forces do not matter.

Example: a slide with friction whose coefficient is not stated, between parts without material.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive
from kinform.consistency.rule import Rule
from kinform.foundation.words import by_cause, few
from kinform.function import needing_forces

SPEAKS_FOR = ("KF504", "KF506")


def check(context: Context) -> Outcome:
    """Why the run is below the level that is expected."""
    run, forces = context.attempt, needing_forces(context.assembly)
    if not run.not_dynamic or (run.level == "functional" and not forces and not _weighed(context)):
        return decided()
    why = by_cause(run.not_dynamic)
    told = f"{run.level} level, expected dynamic: {why}"
    left_out = f"; without effect: {few(forces)}" if forces else ""
    request = context.assembly.simulation
    finding = RULE.finding(
        tuple(dict.fromkeys(subject for subject, _ in run.not_dynamic)),
        f"the simulation is {run.level}, not dynamic: {why}{left_out}",
        found=told,
        intended="a dynamic simulation",
        declared=request if request is not None and request.file is not None else context.assembly.source,
        remedy='State what is missing, or ask for `level = "kinematic"` if forces do not matter.',
    )
    return inconclusive(told + left_out, [finding]) if forces else decided([finding])


def _weighed(context: Context) -> bool:
    """Whether any part has a mass of its own statement."""
    return any(part.override is not None for part in context.assembly.parts)


RULE = Rule("KF509", "level-not-reached", "note", __doc__, check, needs=("attempt",), speaks_for=SPEAKS_FOR)
