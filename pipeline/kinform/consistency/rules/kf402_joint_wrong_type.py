"""Contact forbids the joint that the function intends: it gives one of another type.

The finding is made only where it is proven: a finite step of one of the intended motions makes the two sides
interpenetrate beyond the contact tolerance and the form error of their facets, in both senses. Its size, the place and
the depth are in the finding. A face that stops the motion in one sense forbids nothing, and neither does a clearance.
A manifest that fastens the two sides to each other, by a [[group]] or an assumption, contradicts the joint too.

Contact that leaves the intended motion free, and more, is KF414. Two sides that are one body have no motion and satisfy
only `fixed`. Joints that are ambiguous, types that geometry does not always show (a screw without modelled threads,
universal), and joints of which no step proves that they are blocked, leave the rule inconclusive. Loose parts between
the bodies that the function does not name, such as a pin, take part in the decision. In a robot description, what
blocks a joint within the radius of the hub about its own axis is often fastened to the output of an actuator that is
drawn in the mesh of the parent: a note says so.

Why it matters: the mechanism moves in a way that is not wanted, or does not move.

What to do: `kinform show F.h5 joints` shows the evidence. A revolute joint that comes out fixed is held by a
locator, a misaligned surface or a wrong `[[group]]`.

Example: a pitch axis whose shaft has a flat in its bore slides, and does not turn.
"""

from __future__ import annotations

from collections.abc import Iterable

from kinform.consistency.comparisons.comparison import Comparison
from kinform.consistency.comparisons.forbidden import AT_HUB, derived_type
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, settled
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, direction
from kinform.model.findings import Finding, Witness
from kinform.model.kinematics import FREEDOMS


def check(context: Context) -> Outcome:
    """Intended joints of which a type was found that forbids them, and of which that is proven."""
    present = [c for c in context.comparisons if c.state in ("found", "one body") and not c.loose]
    unknown = [f"'{c.intended.name}': {c.reason}" for c in context.comparisons if c.state == "undecided"]
    findings = []
    for c in present:
        judged = context.forbidden(c)
        if judged is None:
            continue
        if judged.witness is not None:
            findings.append(_finding(context, c, judged.witness, judged.words))
        else:
            findings += [_note(c)] if judged.at_hub else []
            unknown.append(f"'{c.intended.name}': {judged.doubt}")
    return settled(findings, "; ".join(unknown), f"{counted(len(present), 'joint')} compared")


def _note(c: Comparison) -> Finding:
    """What is said of a joint that is blocked at the hub of its actuator."""
    return RULE.at("note").finding(
        [c.intended.name],
        f"'{c.intended.name}': {AT_HUB}",
        found=derived_type(c),
        intended=c.intended.type,
        place=c.intended.point,
        declared=c.intended,
        remedy="Give the output of the actuator a link of its own, or leave it out of the mesh of its housing.",
    )


def _finding(context: Context, c: Comparison, witness: Witness, proof: str) -> Finding:
    intended = c.intended
    derived = derived_type(c)
    steps = (f"; {proof}" if proof else "") + _chain(context, c)
    return RULE.finding(
        [intended.name],
        f"joint '{intended.name}' is {derived}, intended is {intended.type}{_consequence(c)}{steps}",
        found=derived + (f" about {direction(c.axis)}" if c.axis is not None else ""),
        intended=intended.type + (f" about {direction(intended.axis)}" if intended.axis is not None else ""),
        place=_place(c, witness),
        declared=intended,
        remedy=_remedy(c),
        witness=witness,
    )


def _place(c: Comparison, witness: Witness) -> Iterable[float] | None:
    """Of the joint, else of what blocks it."""
    if c.point is not None or c.intended.point is not None:
        return c.point if c.point is not None else c.intended.point
    return witness.place_ahead


def _chain(context: Context, c: Comparison) -> str:
    """Which parts hold the two sides together, where bodies follow from the function."""
    chains = {one.joint: one.parts for one in context.kinematics.unparted}
    parts = chains.get(c.intended.name, ())
    return f"; contact that it may not part holds its sides together: {' ~ '.join(parts)}" if parts else ""


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


RULE = Rule("KF402", "joint-wrong-type", "error", __doc__, check, needs=("comparisons",), also=("note",))
