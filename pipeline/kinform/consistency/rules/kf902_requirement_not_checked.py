"""A requirement could not be decided: what it needs is not known, or the answer is too near to the limit.

The rule is inconclusive as long as there is one: a requirement that nobody checked is not met.

Why it matters: silence would look like a pass.

What to do: see the reason and the remedy of each: a range, a density or a simulation is missing, or a finer mesh
would decide. Or check the requirement by other means and ignore it with that reason.

Example: `[[function.require]]` with `kind = "torque"` where nothing drives the joint.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.control import selected
from kinform.consistency.requirements import Judge, answer
from kinform.consistency.rule import Outcome, Rule, decided, inconclusive, skipped
from kinform.consistency.rules import (
    kf421_region_not_reached,
    kf422_path_not_followed,
    kf423_clearance_too_small,
    kf424_holding_effort_exceeded,
    kf425_torque_exceeded,
    kf426_speed_exceeded,
    kf427_reaction_exceeded,
    kf428_mass_out_of_bounds,
    kf429_centre_of_mass_off,
    kf430_inertia_out_of_bounds,
    kf431_unbalanced,
    kf432_not_retained,
    kf433_fit_out_of_bounds,
)
from kinform.foundation.words import counted
from kinform.model.function import Requirement

__all__ = ["JUDGES", "RULE", "RULES_OF"]

RULES_OF: dict[str, Rule] = {
    "reach": kf421_region_not_reached.RULE,
    "follow": kf422_path_not_followed.RULE,
    "clear": kf423_clearance_too_small.RULE,
    "hold": kf424_holding_effort_exceeded.RULE,
    "torque": kf425_torque_exceeded.RULE,
    "speed": kf426_speed_exceeded.RULE,
    "reaction": kf427_reaction_exceeded.RULE,
    "mass": kf428_mass_out_of_bounds.RULE,
    "centre_of_mass": kf429_centre_of_mass_off.RULE,
    "inertia": kf430_inertia_out_of_bounds.RULE,
    "balance": kf431_unbalanced.RULE,
    "retained": kf432_not_retained.RULE,
    "fit": kf433_fit_out_of_bounds.RULE,
}
"""By kind of requirement: the rule that reports what is violated."""
JUDGES: dict[str, Judge] = {
    "reach": kf421_region_not_reached.judge,
    "follow": kf422_path_not_followed.judge,
    "clear": kf423_clearance_too_small.judge,
    "hold": kf424_holding_effort_exceeded.judge,
    "torque": kf425_torque_exceeded.judge,
    "speed": kf426_speed_exceeded.judge,
    "reaction": kf427_reaction_exceeded.judge,
    "mass": kf428_mass_out_of_bounds.judge,
    "centre_of_mass": kf429_centre_of_mass_off.judge,
    "inertia": kf430_inertia_out_of_bounds.judge,
    "balance": kf431_unbalanced.judge,
    "retained": kf432_not_retained.judge,
    "fit": kf433_fit_out_of_bounds.judge,
}


def check(context: Context) -> Outcome:
    """Every requirement that is undecided."""
    requirements = [r for r in context.function.requirements if _asked(context, r)]
    if not requirements:
        return skipped("the function states no requirement")
    answers = [(requirement, answer(context, requirement, JUDGES[requirement.kind])) for requirement in requirements]
    open_ = [(requirement, found) for requirement, found in answers if found.state == "undecided"]
    findings = [
        RULE.finding(
            [requirement.name],
            f"the requirement '{requirement.name}' of kind {requirement.kind} could not be decided: {found.message}",
            found=found.found or "not checked",
            intended=found.intended or requirement.kind,
            declared=requirement,
            remedy=found.remedy,
        )
        for requirement, found in open_
    ]
    if not open_:
        return decided(reason=f"{counted(len(requirements), 'requirement')} decided")
    return inconclusive(f"{counted(len(open_), 'requirement')} not decided", findings)


def _asked(context: Context, requirement: Requirement) -> bool:
    """Not where [check] selects neither this rule nor that of the requirement's kind."""
    settings = context.assembly.check
    return selected(RULE, settings) or selected(RULES_OF[requirement.kind], settings)


RULE = Rule("KF902", "requirement-not-checked", "note", __doc__, check)
