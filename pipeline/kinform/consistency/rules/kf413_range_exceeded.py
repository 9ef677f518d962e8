"""The simulated motion takes a joint beyond the range that the function states.

Positions at the output times count; what lies between them is not looked at. Inconclusive where a joint with a stated
range was not found as it is intended, directly between its two bodies, and where the output times are too far apart to
follow the motion.

Why it matters: nothing says that the device may be there. The drive, the initial value or the range is wrong.

What to do: drive the joint less far, add what stops it, or state the range that is used.

Example: a pan axis that is stated to turn by ±45° is driven by a sine of 50°.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from kinform.consistency.comparisons.ranges import joint_as_intended, shown
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive
from kinform.consistency.rule import Rule
from kinform.foundation.rounding import SINGLE
from kinform.foundation.words import number, quoted, telling
from kinform.model.findings import Finding
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint
from kinform.model.simulation import Simulation
from kinform.requirements.runs import coarse


def check(context: Context) -> Outcome:
    """Both sides of every stated range beside the run."""
    stated = sorted((j for j in context.function.joints if j.range is not None), key=lambda joint: joint.name)
    run = context.simulation
    joints = {item.intended.name: joint_as_intended(item) for item in context.intended}
    findings: list[Finding] = []
    unknown = []
    for intended in stated:
        match = joints[intended.name]
        if match is None or match[0].name not in run.joint_names:
            unknown.append(intended.name)
            continue
        findings += _beyond(context, run, intended, *match)
    if coarse(run):
        step = number(float(np.diff(run.time).max()))
        return inconclusive(
            f"output times {step} s apart are too few to follow the motion: state a smaller step", findings
        )
    if unknown:
        return inconclusive(f"{quoted(unknown)}: no such joint was found directly between its bodies", findings)
    return decided(findings)


def _beyond(context: Context, run: Simulation, intended: IntendedJoint, joint: Joint, sign: float) -> Iterator[Finding]:
    """A finding for each side that the motion passes."""
    values = sign * run.joint_position[:, int(run.joint_offset[run.joint_names.index(joint.name)])]
    lower, upper = intended.range or (-math.inf, math.inf)
    allowed = SINGLE * (upper - lower) if math.isfinite(upper - lower) else SINGLE
    for side, end, toward in (("lower", lower, -1.0), ("upper", upper, 1.0)):
        k = int((toward * values).argmax())
        value = float(values[k])
        if not toward * (value - end) > allowed:
            continue
        in_words = telling(lambda v, digits: shown(v, intended, context.units, digits), value, end)
        yield RULE.finding(
            (intended.name,),
            f"joint '{intended.name}' moves to {in_words(value)} at t = {number(float(run.time[k]))} s, beyond the "
            f"{side} end of its stated range, {in_words(end)}",
            found=in_words(value),
            intended=f"{'at least' if toward < 0.0 else 'at most'} {in_words(end)}",
            place=joint.point,
            declared=intended,
            remedy="Drive the joint less far, add what stops it, or state the range that is used.",
        )


RULE = Rule("KF413", "range-exceeded", "warning", __doc__, check, needs=("stated ranges", "motion", "intended joints"))
