"""A screw joint has another pitch than intended, or the other hand.

A finding when the pitches differ by more than 0.1 %.

Why it matters: every turn moves the nut by another distance, or the other way.

What to do: correct the thread, the assumption that states the joint, or `pitch` (positive: right-handed).

Example: an M6 lead screw with a pitch of 1 mm where 1.25 mm is intended.
"""

from __future__ import annotations

from kinform.consistency.comparisons.as_written import pitch_as_written
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import length


def check(context: Context) -> Outcome:
    """Pitches of screw joints."""
    findings, count = [], 0
    for c in context.comparisons:
        if c.other_pitch is None or c.pitch is None or c.intended.pitch is None:
            continue
        count += 1
        if c.other_pitch:
            pitch, intended = (f"{length(p, context.units)} a turn" for p in (c.pitch, c.intended.pitch))
            findings.append(
                RULE.finding(
                    [c.intended.name],
                    f"joint '{c.intended.name}' advances {pitch}, intended are {intended}",
                    found=pitch,
                    intended=intended,
                    place=c.point,
                    declared=c.intended,
                    remedy="Correct the thread, or the pitch of the intended joint (positive: right-handed)"
                    f"{pitch_as_written(context, c.intended, c.pitch)}.",
                )
            )
    return decided(findings) if count else skipped("no screw joint to compare")


RULE = Rule("KF405", "joint-pitch-differs", "error", __doc__, check, needs=("comparisons",))
