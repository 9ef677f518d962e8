"""A simulation needs forces, and a moving part has no mass.

An error when the manifest asks for `level = "dynamic"`, or for no level but for efforts, springs,
dampers, friction, servos, motors, loads, losses of gears or initial velocities, which only dynamics can answer. A
note when only motions are asked for: they are then simulated without forces. Parts of a stated ground need no mass.
A mesh that is not watertight has no mass either: that is KF101.

Why it matters: a mass that is guessed gives torques that look right and are not.

What to do: give the part a `material` or a `density`, or state `mass`, `centre_of_mass` and `inertia`.
Stick bodies and parts with `solid = false` need the latter.

Example: an arm with `level = "dynamic"` whose gripper has no material.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import quoted
from kinform.function import needing_forces
from kinform.model.assembly import Part


def check(context: Context) -> Outcome:
    """Parts without density or stated mass where a simulation needs forces."""
    request = context.assembly.simulation
    if not context.simulation_requested:
        return skipped("no simulation is requested")
    level = request.level if request is not None else None
    if level in ("functional", "kinematic"):
        return skipped(f"the requested level is {level}: it needs no mass")
    severity = "error" if level == "dynamic" or needing_forces(context.assembly) else "note"
    demand = "a dynamic simulation needs it" if severity == "error" else "motion is simulated without forces"
    ground = _ground(context)
    return decided(
        RULE.at(severity).finding(
            [part.name],
            f"{quoted([part.name])} has no mass ({_lack(part)}): {demand}",
            found=_lack(part),
            intended="a density, or mass with centre of mass and inertia",
            place=part.X_WP[:3, 3],
            declared=part.source,
            remedy="Give the part a `material` or `density`."
            if part.mesh is not None and part.solid
            else "State `mass`, `centre_of_mass` and `inertia` of the part.",
        )
        for part in context.assembly.parts
        if _lack(part) and part.name not in ground and part.name not in context.assembly.weighed
    )


def _ground(context: Context) -> frozenset[str]:
    """Parts of the ground that the manifest names, with those fused to it where that is known."""
    name = context.assembly.ground
    if name is None:
        return frozenset()
    kinematics = context.design.kinematics
    if kinematics is None:
        return frozenset(context.assembly.parts_of(name))
    return frozenset(part for body in kinematics.bodies if body.ground for part in body.parts)


def _lack(part: Part) -> str:
    """Why the part has no mass, where a density or an override would give one; "" otherwise."""
    if part.override is not None:
        return ""
    if part.mesh is None:
        return "a stick body without stated mass"
    if not part.solid:
        return "surfaces only, without stated mass"
    return "" if part.density is not None else "no material and no density"


RULE = Rule("KF120", "density-missing", "error", __doc__, check, also=("note",))
