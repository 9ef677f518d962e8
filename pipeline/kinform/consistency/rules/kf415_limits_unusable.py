"""The limits of a joint in a robot description are missing, exchanged, or nothing; or its effort or speed is zero.

An error where the lower limit is above the upper one, or a format that needs limits (URDF: revolute and prismatic) has
none. A warning where both limits are equal: the joint cannot move; and where those of a joint that turns are more than
four turns, and no more than 360: they are probably degrees. The reverse is a warning, too: where a file has degrees, as
MJCF does without `<compiler angle="radian"/>`, limits of a hinge within ±3.3° that would be a usual range in radians,
unless its parts stop it before these. One note names all joints whose effort or speed is limited to zero. Limits that
are exchanged, equal or missing are taken as not stated, and nothing that depends on them is compared.

Why it matters: loaders differ: some refuse the file, some lock the joint, some let it turn without end.

What to do: state `lower` and `upper` in radians or metres, ascending; a joint that turns without end is `continuous`,
one that does not move is `fixed`.

Example: `<limit lower="1.57" upper="-1.57" …/>` after an axis was turned round.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from kinform.consistency.comparisons.gathering import Ranked, gathered
from kinform.consistency.comparisons.ranges import RangeComparison, range_comparisons
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
RADIANS = 0.3, 1.05 * math.pi
"""Limits in degrees which are probably radians: the least span of them, and the greatest of them. Joints hardly go
beyond half a turn to a side, and flexures hardly are limited to a third of a degree. A choice."""

_INTENDED = {"degrees": "limits in radians", "radians": "limits in degrees"}

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
    ranked = [found for one in joints if (found := _of_joint(*one)) is not None]
    findings = list(gathered((*ranked, *_radians(context, [joint for joint, _ in joints])), "joint"))
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


def _radians(context: Context, joints: Sequence[DescribedJoint]) -> Iterator[Ranked]:
    """Hinges with limits in degrees that are probably radians, where nothing is known to stop them before these."""
    hinges = [(j, math.degrees(j.limits[0]), math.degrees(j.limits[1])) for j in joints if j.degrees and j.limits]
    small = [(j, a, b) for j, a, b in hinges if b - a >= RADIANS[0] and max(abs(a), abs(b)) <= RADIANS[1]]
    wide = max((entry for entry in hinges if entry not in small), key=lambda e: e[2] - e[1], default=None)
    known = {item.intended.name: item for item in range_comparisons(context)} if small else {}
    for joint, lower, upper in small:
        if joint.name in known and _stopped(known[joint.name], lower, upper):
            continue
        usual = f"{number(math.degrees(lower), 4)} {number(math.degrees(upper), 4)}"
        text = (
            f"joint '{joint.name}': its limits {number(lower)} and {number(upper)} are read as degrees, "
            f"{number(upper - lower, 3)}° in all"
        )
        remedy = 'State <compiler angle="radian"/>, if all angles of the file are radians'
        if wide is not None:
            text += f", and '{wide[0].name}' has {number(wide[2] - wide[1], 3)}°"
            remedy = f'State range="{usual}"'
        text += f": they are probably radians, which are {usual.replace(' ', '° to ')}°"
        yield _finding("radians", joint, text, f"{number(lower)}° to {number(upper)}°", remedy + ".")


def _stopped(item: RangeComparison, lower: float, upper: float) -> bool:
    """Whether parts stop the joint more than a tenth before these limits (rad)."""
    room = 0.1 * (upper - lower)
    low, high = (end.value if end is not None else None for end in (item.lower, item.upper))
    before = low is not None and item.sign * low > lower + room
    return before or (high is not None and item.sign * high < upper - room)


def _limits(lower: float, upper: float, format: str) -> str:
    """ ": `lower="-1" upper="1"`": limits as a URDF has them; "" in other formats."""
    return f': `lower="{number(lower, 6)}" upper="{number(upper, 6)}"`' if format == "urdf" else ""


def _finding(kind: str, joint: DescribedJoint, text: str, found: str, remedy: str) -> Ranked:
    finding = RULE.at("error" if kind == "error" else "warning").finding(
        [joint.name], text,
        found=found,
        intended=_INTENDED.get(kind, "a lower limit below the upper one"),
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
