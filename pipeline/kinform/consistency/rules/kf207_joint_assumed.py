"""The manifest states by `[[assume]]` what geometry would otherwise decide.

Why it matters: it holds even when the geometry changes, and nothing checks it.

What to do: keep assumptions few and their `reason` true; remove those that geometry proves by now.

Example: a horn assumed fixed to a bracket because they are screwed together at assembly.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import quoted


def check(context: Context) -> Findings:
    """Every assumption of the manifest."""
    for assumption in context.assembly.assumptions:
        yield RULE.finding(
            assumption.between,
            f"{quoted(assumption.between)} are assumed "
            + ("not to touch" if assumption.ignore else f"to be joined: {assumption.type}")
            + (f" ({assumption.reason})" if assumption.reason else ""),
            found="ignored contact" if assumption.ignore else f"{assumption.type}, assumed",
            intended="what contact decides",
            place=assumption.point,
            declared=assumption.source,
            remedy="Nothing while the reason holds.",
        )


RULE = Rule("KF207", "joint-assumed", "note", __doc__, check, needs=("stated assumptions",))
