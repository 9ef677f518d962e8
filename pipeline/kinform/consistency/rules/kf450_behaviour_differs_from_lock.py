"""The derived behaviour is not the one that was accepted and locked.

A lock (`kinform lock F.h5 -o behaviour.lock.json`) keeps bodies, joints, axes, ranges, mobility, masses and overlaps
as a designer accepted them, with tolerances. `kinform check F.h5 --lock behaviour.lock.json` compares; without
`--lock` the rule does not apply.

Why it matters: a change of a mesh may turn a revolute joint into a cylindrical one, move an axis, or add a kilogram,
without anything in the stated function to contradict it.

What to do: repair the design; or, if the change is meant, write the lock anew and review its difference.

Example: a bore was moved by 0.3 mm, and so was the axis of the shoulder.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, skipped
from kinform.consistency.rule import Rule


def check(context: Context) -> Outcome:
    """Never applies by itself: the lock is compared where it is given (`kinform.changes`)."""
    del context
    return skipped("no lock is given (--lock)")


RULE = Rule("KF450", "behaviour-differs-from-lock", "error", __doc__, check)
