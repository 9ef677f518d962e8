"""Contact forbids the joint that the function intends: it gives one of another type.

Contact that leaves the intended motion free, and more, is KF414. Two sides that are one body have no motion and satisfy
only `fixed`. Joints that are ambiguous, and types that geometry does not always show (a screw without modelled threads,
universal), leave the rule inconclusive. Loose parts between the bodies that the function does not name, such as a pin,
take part in the decision.

Why it matters: the mechanism moves in a way that is not wanted, or does not move.

What to do: `kinform show F.h5 joints` shows the evidence. A revolute joint that comes out fixed is held by a
locator, a misaligned surface or a wrong `[[group]]`.

Example: a pitch axis whose shaft has a flat in its bore slides, and does not turn.
"""

from __future__ import annotations

from kinform.consistency.comparisons.comparison import Comparison, leaves_more
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, direction, quoted
from kinform.model.findings import Finding
from kinform.model.kinematics import FREEDOMS


def check(context: Context) -> Outcome:
    """Intended joints of which a type was found that forbids them."""
    present = [c for c in context.comparisons if c.state in ("found", "one body") and not c.loose]
    findings = [_finding(context, c) for c in present if not c.right_type and not leaves_more(c)]
    unknown = [f"'{c.intended.name}': {c.reason}" for c in context.comparisons if c.state == "undecided"]
    return settled(findings, "; ".join(unknown), f"{counted(len(present), 'joint')} compared")


def _finding(context: Context, c: Comparison) -> Finding:
    intended = c.intended
    derived = _derived_type(c)
    return RULE.finding(
        [intended.name],
        f"joint '{intended.name}' is {derived}, intended is {intended.type}{_consequence(c)}{_chain(context, c)}",
        found=derived + (f" about {direction(c.axis)}" if c.axis is not None else ""),
        intended=intended.type + (f" about {direction(intended.axis)}" if intended.axis is not None else ""),
        place=c.point if c.point is not None else intended.point,
        declared=intended,
        remedy=_remedy(c),
    )


def _chain(context: Context, c: Comparison) -> str:
    """Which parts hold the two sides together, where bodies follow from the function."""
    chains = {one.joint: one.parts for one in context.kinematics.unparted}
    parts = chains.get(c.intended.name, ())
    return f"; contact that it may not part holds its sides together: {' ~ '.join(parts)}" if parts else ""


def _derived_type(c: Comparison) -> str:
    if c.state == "one body":
        why = f" ({c.reason})" if c.reason else ""
        return f"fixed: {quoted(c.intended.between)} are parts of one body{why}"
    text = c.type if c.type != "general" else f"general with {counted(c.freedoms, 'freedom')}"
    return text + (f" (through {quoted(c.through)})" if c.through else "")


def _consequence(c: Comparison) -> str:
    """What the difference means, in freedoms."""
    wanted = FREEDOMS.get(c.intended.type)
    if wanted is None or wanted == c.freedoms:
        return ""
    more = c.freedoms - wanted
    return f": {counted(abs(more), 'freedom')} too {'many' if more > 0 else 'few'}"


def _remedy(c: Comparison) -> str:
    if c.state == "one body":
        return "Take the two sides out of the common [[group]], or see what fuses them: `kinform show F.h5 joints`."
    if c.intended.type == "revolute" and c.type == "cylindrical":
        return "Give the shaft shoulders or clips that hold it along the axis."
    if c.intended.type == "revolute" and c.type == "planar":
        return "Give the joint a journal and a bore; a flat face alone does not hold the axis."
    return "See the evidence with `kinform show F.h5 joints`; correct the mating surfaces, or the intended type."


RULE = Rule("KF402", "joint-wrong-type", "error", __doc__, check, needs=("comparisons",))
