"""The manifest asks kinform to infer fasteners, which it does not do yet.

The rule is inconclusive: parts that fasteners hold together count as separate.

Why it matters: joints and mobility differ from what the designer expects.

What to do: say which parts are one body by `[[group]]`.

Example: `[fasteners] infer = true`.
"""

from __future__ import annotations

from kinform.consistency._context import Context
from kinform.consistency._rule import Outcome, Rule, inconclusive, skipped

__all__ = ["RULE"]


def check(context: Context) -> Outcome:
    """The request to infer fasteners."""
    if not context.assembly.infer_fasteners:
        return skipped("the manifest does not ask to infer fasteners")
    finding = RULE.finding(
        (context.assembly.name,),
        "fasteners are not inferred yet: parts that they hold together count as separate",
        declared=context.assembly.source,
        remedy="Say which parts are one body by [[group]].",
    )
    return inconclusive("fasteners are not inferred yet", [finding])


RULE = Rule("KF906", "fasteners-not-inferred", "note", __doc__, check)
