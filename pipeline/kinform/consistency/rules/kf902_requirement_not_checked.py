"""The function states a requirement that kinform does not check yet.

The rule is inconclusive as long as there is one: a requirement that nobody checked is not met.

Why it matters: silence would look like a pass.

What to do: check the requirement by other means until its kind is supported.

Example: `[[function.require]]` with `kind = "reach"`.
"""

from __future__ import annotations

from kinform.consistency._context import Context
from kinform.consistency._rule import Outcome, Rule, inconclusive, skipped
from kinform.consistency._words import counted

__all__ = ["RULE"]


def check(context: Context) -> Outcome:
    """Every requirement."""
    requirements = context.function.requirements
    if not requirements:
        return skipped("the function states no requirement")
    findings = [
        RULE.finding(
            [requirement.name],
            f"the requirement '{requirement.name}' of kind {requirement.kind} is not checked yet",
            found="not checked",
            intended=requirement.kind,
            declared=requirement,
            remedy="Check it by other means.",
        )
        for requirement in requirements
    ]
    return inconclusive(f"{counted(len(requirements), 'requirement')} not checked", findings)


RULE = Rule("KF902", "requirement-not-checked", "note", __doc__, check)
