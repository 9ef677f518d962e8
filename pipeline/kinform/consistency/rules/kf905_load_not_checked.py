"""The function states a load, and no dynamic simulation has carried it.

Inconclusive: a load changes nothing below the dynamic level.

Why it matters: whether drives and joints bear the load is not known.

What to do: ask for `level = "dynamic"` and give every moving part a density or a mass.

Example: a force of 5 N on the gripper of an arm that is simulated kinematically.
"""

from __future__ import annotations

from kinform.consistency._context import Context
from kinform.consistency._rule import Outcome, Rule, decided, inconclusive, skipped
from kinform.words import counted, quoted

__all__ = ["RULE"]


def check(context: Context) -> Outcome:
    """Loads without a dynamic run that ended."""
    loads = context.function.loads
    if not loads:
        return skipped("the function states no load")
    simulation = context.design.simulation
    if simulation is not None and simulation.status == "done" and simulation.level == "dynamic":
        return decided(reason=f"{counted(len(loads), 'load')} carried by the dynamic simulation")
    findings = [
        RULE.finding(
            [load.part],
            f"the load on {quoted([load.part])} was not simulated",
            found="not simulated",
            intended="a dynamic simulation that carries the load",
            place=load.point,
            declared=load,
            remedy='Ask for `level = "dynamic"`, with the mass of every moving part known.',
        )
        for load in loads
    ]
    return inconclusive(f"{counted(len(loads), 'load')} not simulated", findings)


RULE = Rule("KF905", "load-not-checked", "note", __doc__, check)
