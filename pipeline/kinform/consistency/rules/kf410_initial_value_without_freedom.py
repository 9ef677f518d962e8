"""An initial value is given for a joint that is not there, or for one of several freedoms, and which is not clear.

Inconclusive when the joint is ambiguous, general, or carried by loose parts between its two bodies.

Why it matters: the simulation begins in another pose than the one that is meant.

What to do: correct the name in `[simulation.initial.NAME]`, say `freedom`, or correct the geometry of the joint.

Example: `[simulation.initial.elbow]` where the elbow is a ball joint.
"""

from __future__ import annotations

from kinform.consistency.comparisons.actuated import without_freedom
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome
from kinform.consistency.rule import Rule


def check(context: Context) -> Outcome:
    """The freedom of every initial value."""
    request = context.assembly.simulation
    initial = () if request is None else request.initial
    remedy = "Correct the name in [simulation.initial], or the geometry of the joint."
    return without_freedom(context, RULE, initial, lambda _: "initial value of", remedy)


RULE = Rule(
    "KF410", "initial-value-without-freedom", "error", __doc__, check, needs=("stated initial values", "kinematics")
)
