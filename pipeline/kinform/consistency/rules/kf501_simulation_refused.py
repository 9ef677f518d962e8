"""The simulation that was asked for, or a part of it, cannot be run.

The rule is then inconclusive: what depends on motion or forces is not verified. Joints that are
ambiguous, general or missing, bodies without mass, and elements that are not supported yet are the usual
reasons; where one of them is a mistake of the design, another rule reports it as such.

Why it matters: a run that did not happen proves nothing.

What to do: remove the cause that is given, or ask for a lower `level`.

Example: `level = "dynamic"` for an arm of which one joint came out ambiguous.
"""

from __future__ import annotations

from kinform.consistency._context import Context
from kinform.consistency._rule import Outcome, Rule, decided, inconclusive
from kinform.consistency._words import quoted

__all__ = ["RULE"]


def check(context: Context) -> Outcome:
    """Refusals, of the whole simulation or of single elements."""
    simulation = context.simulation
    if isinstance(simulation, Outcome):
        return simulation
    if simulation.status != "refused" and not simulation.failures:
        return decided()
    request = context.assembly.simulation
    failures = simulation.failures or ((context.assembly.name, simulation.reason),)
    findings = [
        RULE.finding(
            [subject],
            f"{quoted([subject])} is not simulated: {reason}",
            declared=request if request is not None and request.file is not None else context.assembly.source,
            remedy="Remove the cause, or ask for a lower `level`.",
        )
        for subject, reason in failures
    ]
    reasons = "; ".join(f"{subject}: {reason}" for subject, reason in failures)
    return inconclusive(simulation.reason or reasons, findings)


RULE = Rule("KF501", "simulation-refused", "note", __doc__, check)
