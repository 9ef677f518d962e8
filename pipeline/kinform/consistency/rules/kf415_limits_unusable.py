"""The limits of a joint in a robot description are missing, exchanged, or nothing; or its effort or speed is zero.

An error where the lower limit is above the upper one, or a format that needs limits (URDF: revolute and prismatic) has
none. A warning where both limits are equal: the joint cannot move; and where those of a joint that turns are more than
four turns, and no more than 360: they are probably degrees. One note names all joints whose effort or speed is
limited to zero. The range is then taken as not stated, and nothing that depends on it is compared.

Why it matters: loaders differ: some refuse the file, some lock the joint, some let it turn without end.

What to do: state `lower` and `upper` in radians or metres, ascending; a joint that turns without end is `continuous`,
one that does not move is `fixed`.

Example: `<limit lower="1.57" upper="-1.57" …/>` after an axis was turned round.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from kinform.consistency.comparisons.gathering import Ranked, gathered
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, number, quoted
from kinform.model.assembly import Source
from kinform.model.descriptions import DescribedJoint, Description
from kinform.model.findings import Finding, Witness, stated

DEGREES = 8.0 * math.pi, 360.0
"""Limits of a joint that turns (rad) which are probably degrees, or stand for none: from four turns on, which hardly a
joint of a robot goes, to as many degrees as a turn has. A choice."""


TURNING = ("revolute", "hinge")
"""Joints that turn between limits, as formats call them."""


def check(context: Context) -> Outcome:
    """The limits of every joint of every description."""
    joints = [
        (joint, d.format)
        for d in context.assembly.descriptions
        for joint in d.joints
        if joint.needs_limits or joint.limits
    ]
    findings = list(gathered((ranked for one in joints if (ranked := _of_joint(*one)) is not None), "joint"))
    for description in context.assembly.descriptions:
        findings += _zeros(description)
    return decided(findings, f"limits of {counted(len(joints), 'joint')} looked at")


def _of_joint(joint: DescribedJoint, format: str) -> Ranked | None:
    if joint.limits is None:
        text, found = f"joint '{joint.name}' is {joint.kind} and states no limits", "no limits"
        return _finding("error", joint, text, found, "State <limit lower=… upper=… effort=… velocity=…/>.")
    lower, upper = joint.limits
    shown = f"{number(lower, 6)} and {number(upper, 6)}"
    if lower > upper:
        text = f"joint '{joint.name}': its lower limit {number(lower, 6)} is above the upper {number(upper, 6)}"
        return _finding(
            "error", joint, text, shown, f"Exchange them{_limits(upper, lower, format)}, or correct a sign."
        )
    if lower == upper:
        text = f"joint '{joint.name}': its limits are both {number(lower, 6)}, so it cannot move"
        return _finding("warning", joint, text, shown, "State its range, or make it fixed.")
    most = max(abs(lower), abs(upper))
    if joint.kind in TURNING and DEGREES[0] <= most <= DEGREES[1]:
        turns = number(most / (2.0 * math.pi), 3)
        text = f"joint '{joint.name}': its limits {shown} rad are {turns} turns: they are probably degrees"
        stated = _limits(math.radians(lower), math.radians(upper), format)
        remedy = f"State radians{stated}; or make it continuous, if it has no limits."
        return _finding("degrees", joint, text, shown, remedy)
    return None


def _limits(lower: float, upper: float, format: str) -> str:
    """ ": `lower="-1" upper="1"`": limits as a URDF has them; "" in other formats."""
    return f': `lower="{number(lower, 6)}" upper="{number(upper, 6)}"`' if format == "urdf" else ""


def _finding(kind: str, joint: DescribedJoint, text: str, found: str, remedy: str) -> Ranked:
    finding = RULE.at("error" if kind == "error" else "warning").finding(
        [joint.name], text,
        found=found,
        intended="limits in radians" if kind == "degrees" else "a lower limit below the upper one",
        place=joint.point,
        declared=Source(joint.file, joint.line),
        remedy=remedy,
        witness=_witness(joint),
    )  # fmt: skip
    return Ranked("none" if joint.limits is None else kind, abs(joint.span), finding)


def _witness(joint: DescribedJoint) -> Witness | None:
    """What its file states."""
    place = Source(joint.file, joint.line)
    if joint.limits is None:
        return stated(place, joint.name.rpartition("/")[2], lacks=("limit",))
    return stated(place, joint.name.rpartition("/")[2], *map(repr, joint.limits))


def _zeros(description: Description) -> Iterator[Finding]:
    """One note for all joints whose effort or speed is limited to zero."""
    zero = [
        joint
        for joint in description.joints
        if joint.needs_limits and any(v is not None and v <= 0.0 for v in (joint.effort, joint.speed))
    ]
    if zero:
        names = [joint.name for joint in zero]
        what = "limits its" if len(names) == 1 else "limit their"
        yield RULE.at("note").finding(
            names,
            f"{counted(len(names), 'joint')} ({quoted(names)}) {what} effort or speed to zero: controllers that "
            "heed it never move them",
            found="zero",
            intended="a positive effort and velocity",
            declared=Source(zero[0].file, zero[0].line),
            remedy="State the effort (N·m or N) and the velocity (rad/s or m/s) of the drive.",
        )


RULE = Rule(
    "KF415",
    "limits-unusable",
    "error",
    __doc__,
    check,
    needs=("descriptions", "described limits"),
    also=("warning", "note"),
)
