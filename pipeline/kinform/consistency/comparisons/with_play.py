"""Intended joints where contact is missing, or leaves too much, and a part with play may carry them all the same, or
contact of a kind that is not known."""

from __future__ import annotations

from dataclasses import replace

from kinform.consistency.comparisons.comparison import Comparison, leaves_more
from kinform.consistency.comparisons.known import Known
from kinform.consistency.questions.captive_parts import CaptivePart, may_carry, may_hold
from kinform.foundation.algebra.screws import Frame, scaled, span
from kinform.foundation.words import quoted
from kinform.kinematics.joints.bodies.stated_joints import joint_twists
from kinform.model.arrays import Array


def with_play(c: Comparison, known: Known) -> Comparison:
    """What a comparison comes to by parts with play: where one may carry the joint, or hold more of it, it is not
    denied, but undecided; of a joint that is taken as stated, `afloat` says so."""
    missing = c.state == "absent" or (c.state == "taken" and not c.touch)
    one = _afloat(c, known) if missing or c.left_free or leaves_more(c) else None
    words = _touching(c, known) if missing and one is None else ""
    if one is not None:
        words = one.words()
    return replace(c, state="taken" if c.state == "taken" else "undecided", reason=words, afloat=words) if words else c


def _touching(c: Comparison, known: Known) -> str:
    """In words, how two bodies that are in no contact that is known touch all the same; "" where they do not."""
    sides = [set(body.parts) for body in c.bodies]
    for patch in () if known.contacts is None else known.contacts.patches:
        if patch.unknown and any(patch.parts[0] in a and patch.parts[1] in b for a, b in (sides, sides[::-1])):
            return f"{quoted(patch.parts)} touch, in a way that is no contact that kinform knows"
    return ""


def _afloat(c: Comparison, known: Known) -> CaptivePart | None:
    """A part that may carry the joint of two bodies that do not touch, or hold more of that of two that do, also
    through loose bodies; None where it is sure that none does."""
    if known.afloat is None:
        return None
    first, second = (body.name for body in c.bodies)
    if not c.touch:
        return may_carry(known.afloat, known.kinematics, first, second, known.named)
    free = _free_beside(c, known.smaller(c.bodies))
    return may_hold(known.afloat, known.kinematics, (first, second, *c.through), known.named, free)


def _free_beside(c: Comparison, size: float) -> tuple[Array, Frame] | None:
    """What contact leaves free beside the intended motion, scaled columns (6, k); None where it is not known."""
    found, place = c.twists, c.intended.point if c.intended.point is not None else c.point
    if c.state == "taken" and c.joint is not None and c.joint.readings:
        left = c.joint.readings[0]
        found = joint_twists(replace(c.intended, type=left.type, axis=left.axis, point=left.point, pitch=left.pitch))
    wanted = joint_twists(c.intended)
    if found is None or wanted is None or place is None:
        return None
    frame = Frame(place, size)
    own, asked = span(scaled(found.T, frame)), span(scaled(wanted.T, frame))
    return span(own - asked @ (asked.T @ own)), frame
