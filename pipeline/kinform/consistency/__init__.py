"""Compares form, behaviour and function, and reports every inconsistency with place, size and remedy.

`check` runs the rules of `RULES` on a design; each rule passes, fails, is inconclusive or is skipped
because it does not apply. `verdict_of` says what a report claims as a whole, with the exit code of
the gate; `explain` prints what a code means.

Sub-packages; each imports only those above it:

- `questions`: what several rules ask of a design, and nobody else
- `comparisons`: quantities of function and behaviour beside each other
- `causes`: one finding for each cause: what findings have in common, proved by asking again
- `rules`: one rule a file
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinform.foundation.lazy_imports import lazy_attributes

if TYPE_CHECKING:
    from kinform.consistency.baseline import Baseline, adopt, read_baseline, with_baseline
    from kinform.consistency.comparisons.comparison import Comparison
    from kinform.consistency.comparisons.intended_joints import compare_joints
    from kinform.consistency.documentation import UnknownRuleError, explain, rules_markdown
    from kinform.consistency.inspection import amended, check, margins
    from kinform.consistency.judgement import Verdict, verdict, verdict_of
    from kinform.consistency.outcome import Outcome
    from kinform.consistency.rule import Rule
    from kinform.consistency.rules import RULES

__all__ = [
    "CODE_VERSION",
    "RULES",
    "Baseline",
    "Comparison",
    "Outcome",
    "Rule",
    "UnknownRuleError",
    "Verdict",
    "adopt",
    "amended",
    "check",
    "compare_joints",
    "explain",
    "margins",
    "read_baseline",
    "rules_markdown",
    "verdict",
    "verdict_of",
    "with_baseline",
]

CODE_VERSION: int = 61
"""Bumped when results of this package change for the same input."""

__getattr__ = lazy_attributes(
    __name__,
    {
        "Baseline": "baseline",
        "adopt": "baseline",
        "read_baseline": "baseline",
        "with_baseline": "baseline",
        "Comparison": "comparisons.comparison",
        "compare_joints": "comparisons.intended_joints",
        "UnknownRuleError": "documentation",
        "explain": "documentation",
        "rules_markdown": "documentation",
        "amended": "inspection",
        "check": "inspection",
        "margins": "inspection",
        "Outcome": "outcome",
        "Rule": "rule",
        "RULES": "rules",
        "Verdict": "judgement",
        "verdict": "judgement",
        "verdict_of": "judgement",
    },
)
