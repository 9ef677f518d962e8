"""The function states a coupling of joints that kinform does not check yet.

The rule is inconclusive as long as there is one.

Why it matters: whether the gears or racks of the geometry give this ratio is not known.

What to do: check the ratio by other means until couplings are supported.

Example: `ratio = -2.5` between the two shafts of a gear pair.
"""

from __future__ import annotations

from kinform.consistency._context import Context
from kinform.consistency._rule import Outcome, Rule, inconclusive, skipped
from kinform.consistency._words import counted, number, quoted

__all__ = ["RULE"]


def check(context: Context) -> Outcome:
    """Every coupling."""
    couplings = context.function.couplings
    if not couplings:
        return skipped("the function states no coupling")
    findings = [
        RULE.finding(
            coupling.joints,
            f"the coupling of {quoted(coupling.joints)} is not checked yet",
            found="not checked",
            intended=f"ratio {number(coupling.ratio, 6)}",
            declared=coupling,
            remedy="Check the ratio by other means.",
        )
        for coupling in couplings
    ]
    return inconclusive(f"{counted(len(couplings), 'coupling')} not checked", findings)


RULE = Rule("KF903", "coupling-not-checked", "note", __doc__, check)
