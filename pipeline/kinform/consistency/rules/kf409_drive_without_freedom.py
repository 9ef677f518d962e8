"""A drive acts on a joint that is not there, or on one of several freedoms, and which is not clear.

Of a joint with several freedoms the one is driven that `freedom` names, or that the type of the intended joint means,
or that the rest of the assembly leaves: a round ram slides where pins hold its spin, or where its spin is idle.

Inconclusive when the joint is ambiguous, general, or carried by loose parts between its two bodies, or by a part that
has play there.

Why it matters: the drive moves nothing, or it is not clear what it moves.

What to do: correct `joint` of the drive, say `freedom`, or correct the geometry of the joint; see KF401 and KF402.

Example: a drive on the elbow of an arm whose elbow is welded by a group.
"""

from __future__ import annotations

from kinform.consistency.comparisons.actuated import without_freedom
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome
from kinform.consistency.rule import Rule


def check(context: Context) -> Outcome:
    """The freedom of every drive."""
    remedy = "Correct `joint` of the drive, or the geometry of the joint."
    return without_freedom(context, RULE, context.function.drives, lambda drive: f"{drive.kind} drive on", remedy)


RULE = Rule("KF409", "drive-without-freedom", "error", __doc__, check, needs=("stated drives", "kinematics"))
