"""A drive acts on a joint that is not there, or that has not exactly one freedom.

Inconclusive when the joint is ambiguous, general, or carried by loose parts between its two bodies.

Why it matters: the drive moves nothing, or it is not clear what it moves.

What to do: correct `joint` of the drive, or the geometry of the joint; see KF401 and KF402.

Example: a drive on the elbow of an arm whose elbow is welded by a group.
"""

from __future__ import annotations

from kinform.consistency._actuated import actuated
from kinform.consistency._context import Context
from kinform.consistency._rule import Outcome, Rule, decided, inconclusive, skipped

__all__ = ["RULE"]


def check(context: Context) -> Outcome:
    """The freedom of every drive."""
    drives = context.function.drives
    if not drives:
        return skipped("the function states no drive")
    kinematics = context.kinematics
    if isinstance(kinematics, Outcome):
        return kinematics
    findings, unknown = [], []
    for drive in drives:
        state, reason = actuated(context, kinematics, drive.joint)
        if state == "unknown":
            unknown.append(reason)
        elif state == "absent":
            findings.append(
                RULE.finding(
                    [drive.joint],
                    f"the {drive.kind} drive on '{drive.joint}' has no freedom to act on: {reason}",
                    found=reason,
                    intended="a joint with one freedom",
                    declared=drive,
                    remedy="Correct `joint` of the drive, or the geometry of the joint.",
                )
            )
    return inconclusive("; ".join(dict.fromkeys(unknown)), findings) if unknown else decided(findings)


RULE = Rule("KF409", "drive-without-freedom", "error", __doc__, check)
