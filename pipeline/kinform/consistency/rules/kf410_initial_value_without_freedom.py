"""An initial value is given for a joint that is not there, or that has not exactly one freedom.

Inconclusive when the joint is ambiguous, general, or carried by loose parts between its two bodies.

Why it matters: the simulation begins in another pose than the one that is meant.

What to do: correct the name in `[simulation.initial.NAME]`, or the geometry of the joint.

Example: `[simulation.initial.elbow]` where the elbow is a ball joint.
"""

from __future__ import annotations

from kinform.consistency._actuated import actuated
from kinform.consistency._context import Context
from kinform.consistency._rule import Outcome, Rule, decided, inconclusive, skipped

__all__ = ["RULE"]


def check(context: Context) -> Outcome:
    """The freedom of every initial value."""
    request = context.assembly.simulation
    if request is None or not request.initial:
        return skipped("no initial value is stated")
    kinematics = context.kinematics
    if isinstance(kinematics, Outcome):
        return kinematics
    findings, unknown = [], []
    for value in request.initial:
        state, reason = actuated(context, kinematics, value.joint)
        if state == "unknown":
            unknown.append(reason)
        elif state == "absent":
            findings.append(
                RULE.finding(
                    [value.joint],
                    f"the initial value of '{value.joint}' has no freedom to act on: {reason}",
                    found=reason,
                    intended="a joint with one freedom",
                    declared=value,
                    remedy="Correct the name in [simulation.initial], or the geometry of the joint.",
                )
            )
    return inconclusive("; ".join(dict.fromkeys(unknown)), findings) if unknown else decided(findings)


RULE = Rule("KF410", "initial-value-without-freedom", "error", __doc__, check)
