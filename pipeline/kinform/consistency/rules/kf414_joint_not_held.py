"""Contact leaves the intended joint free, and more: nothing in the geometry holds it.

The intended motion is possible, and so are others; or contact ends it in one sense, as the bottom of a bore ends the
stroke of a ram, and lets the parts leave by it. Where the function states all joints (`complete = true`), the joint
is then taken as stated, and everything that follows from it says so; one that is stated as fixed makes its sides one
body, and is found here where contact alone would let them turn as a joint does. Contact that forbids the joint is
KF402. Where a part between the two has play, less than the contact tolerance to either side, it may hold what else is
free, and the rule is inconclusive.

Why it matters: parts that only lie against each other slide off. In many assemblies the pin or the bearing is just not
modelled: then say so by `complete = true`, or model it.

What to do: `kinform show F.h5 joints` shows the evidence. A revolute joint that comes out cylindrical lacks a shoulder;
one that comes out planar lacks the journal.

Example: a pitch axis whose shaft can slide out is cylindrical, not revolute.
"""

from __future__ import annotations

from kinform.consistency.comparisons.comparison import Comparison, leaves_more
from kinform.consistency.comparisons.missing_pin import missing_pin
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.questions.proofs import opening
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, direction, quoted
from kinform.kinematics.joints.bodies.stated_joints import joint_twists
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.model.findings import Finding, Witness
from kinform.model.kinematics import FREEDOMS, Reading


def check(context: Context) -> Outcome:
    """Intended joints that contact leaves free without holding them."""
    loose = [c for c in context.comparisons if leaves_more(c) or (c.left_free and not c.afloat) or c.loose]
    doubts = [f"'{c.intended.name}': {c.afloat}" for c in context.comparisons if c.afloat and c.touch]
    return settled([_finding(context, c, missing_pin(context, c)) for c in loose], "; ".join(doubts))


def _finding(context: Context, c: Comparison, pin: tuple[str, str] | None) -> Finding:
    intended = c.intended
    reading = c.joint.readings[0] if c.state == "taken" and c.joint is not None else None
    found = reading.type if reading is not None else c.type
    freedoms = reading.freedoms if reading is not None else c.freedoms
    axis = reading.axis if reading is not None else c.axis
    through = f" (through {quoted(c.through)})" if c.through else ""
    more = freedoms - FREEDOMS.get(intended.type, 0)
    beside = (
        counted(more, "freedom") + " too many" if more > 0 else "contact only ends the intended motion in one sense"
    )
    word = found if found != "general" else f"general with {counted(freedoms, 'freedom')}"
    return RULE.finding(
        [intended.name],
        f"joint '{intended.name}' is {word}{through} by contact, intended is {intended.type}: {beside}"
        + (f"; {pin[0]}" if pin else ""),
        found=word + (f" about {direction(axis)}" if axis is not None else "") + (f", {pin[0]}" if pin else ""),
        intended=intended.type + (f" about {direction(intended.axis)}" if intended.axis is not None else ""),
        place=c.point if c.point is not None else intended.point,
        declared=intended,
        remedy=pin[1] if pin else _remedy(intended.type, found, taken=c.state == "taken" or c.loose),
        witness=_witness(context, c, reading),
    )


def _witness(context: Context, c: Comparison, reading: Reading | None) -> Witness | None:
    """A motion that contact leaves free beside the intended one."""
    if context.lacks("contacts") is not None:
        return None
    found = c.twists
    if reading is not None:
        known = reading.type == "fixed" or (reading.axis is not None and reading.point is not None)
        found = twists_of(reading.type, reading.axis, reading.point, reading.pitch) if known else found
    meant = joint_twists(c.intended)
    if found is None or meant is None:
        return None
    first, second = _sides(context, c)
    loose = [context.kinematics.named_bodies[name].parts for name in c.through]
    return opening(context, first, second, found, meant, loose)


def _sides(context: Context, c: Comparison) -> tuple[frozenset[str], frozenset[str]]:
    """Parts of both sides; of one body, those that the joint names."""
    if c.bodies[0].name == c.bodies[1].name:
        first, second = (frozenset(map(str, context.assembly.parts_of(name))) for name in c.intended.between)
        return first, second
    first, second = (frozenset(map(str, body.parts)) for body in c.bodies)
    return first, second


def _remedy(wanted: str, found: str, *, taken: bool) -> str:
    shaft = wanted == "revolute" and found == "cylindrical"
    if wanted == "fixed" and taken:
        return "It is taken as stated. Model what holds it, or join the two by [[group]]; if it moves, say so."
    hold = "Give the shaft shoulders or clips that hold it along the axis" if shaft else "Model what holds the joint"
    if taken:
        return f'It is taken as stated. {hold}; if that is in no mesh, `[check.severity] KF414 = "note"`.'
    return f"{hold}." if shaft else f"{hold}, or state `complete = true` in [function] if it is in no mesh."


RULE = Rule("KF414", "joint-not-held", "error", __doc__, check, needs=("comparisons",))
