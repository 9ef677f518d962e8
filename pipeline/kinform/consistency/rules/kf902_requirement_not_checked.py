"""A requirement could not be decided: what it needs is not known, or the answer is too near to the limit.

The rule is inconclusive as long as there is one: a requirement that nobody checked is not met.

Why it matters: silence would look like a pass.

What to do: see the reason and the remedy of each: a range, a density or a simulation is missing, or a finer mesh
would decide. Or check the requirement by other means and ignore it with that reason.

Example: `[[function.require]]` with `kind = "torque"` where nothing drives the joint.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted

SPEAKS_FOR = tuple(f"KF{number}" for number in range(421, 434))
"""The rules of the kinds of requirements."""


def check(context: Context) -> Outcome:
    """Every requirement that is undecided."""
    if not context.answers:
        nothing = (
            "no requirement but limits of joints, and nothing drives them" if context.dormant else "no requirement"
        )
        return skipped(f"the function states {nothing}")
    undecided = {r: answer for r, answer in context.answers.items() if answer.state == "undecided"}
    if not undecided:
        return decided(reason=f"{counted(len(context.answers), 'requirement')} decided")
    findings = [
        RULE.finding(
            [requirement.name],
            f"the requirement '{requirement.name}' of kind {requirement.kind} could not be decided: {answer.message}",
            found=answer.found or "not checked",
            intended=answer.intended or requirement.kind,
            declared=requirement,
            remedy=answer.remedy,
        )
        for requirement, answer in undecided.items()
    ]
    return inconclusive(f"{counted(len(undecided), 'requirement')} not decided", findings)


RULE = Rule("KF902", "requirement-not-checked", "note", __doc__, check, speaks_for=SPEAKS_FOR)
