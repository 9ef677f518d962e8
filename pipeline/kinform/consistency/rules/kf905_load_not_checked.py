"""The function states a load, and no dynamic simulation has carried it.

Inconclusive: a load changes nothing below the dynamic level, and nothing at any level where it acts on the ground,
which is held.

Why it matters: whether drives and joints bear the load is not known.

What to do: ask for `level = "dynamic"` and give every moving part a density or a mass. Move a load on the ground to
what carries it, or make what the ground stands on a part of the design.

Example: a force of 5 N on the gripper of an arm that is simulated kinematically.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, quoted
from kinform.model.function import Load

MOVE = "Put it on a part that moves, or make what the ground stands on a part of the design."


def check(context: Context) -> Outcome:
    """Loads without a dynamic run that ended, or that no run feels."""
    loads = context.function.loads
    simulation = context.design.simulation
    carried = simulation is not None and simulation.status == "done" and simulation.level == "dynamic"
    findings = [
        RULE.finding(
            [load.part],
            f"the load on {quoted([load.part])} acts on the ground, which is held: what it does is not computed"
            if held
            else f"the load on {quoted([load.part])} was not simulated",
            found="without effect" if held else "not simulated",
            intended="a dynamic simulation that carries the load",
            place=load.point,
            declared=load,
            remedy=MOVE if held else 'Ask for `level = "dynamic"`, with the mass of every moving part known.',
        )
        for load in loads
        if (held := _on_ground(context, load)) or not carried
    ]
    doubt = f"{counted(len(findings), 'load')} not simulated" if findings else ""
    return settled(findings, doubt, f"{counted(len(loads), 'load')} carried by the dynamic simulation")


def _on_ground(context: Context, load: Load) -> bool:
    kinematics = context.design.kinematics
    return kinematics is not None and kinematics.body_of(context.assembly.parts_of(load.part)[0]).ground


RULE = Rule("KF905", "load-not-checked", "note", __doc__, check, needs=("stated loads",))
