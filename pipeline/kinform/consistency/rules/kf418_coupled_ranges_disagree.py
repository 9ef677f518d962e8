"""The ranges of two coupled joints cannot both hold: the ratio takes one beyond its limits.

The range of the joint that leads is mapped by the ratio (`<mimic>` with multiplier and offset, `<equality>`,
`[[function.coupling]]`) and compared with the range of the joint that follows. An error where they share no more than
one position: neither joint can move then. A warning where the leader can use only a part of its range. Limits that are
wider than what the leader asks for are no finding; 1 % of the range counts as rounding. What meshes stop is KF412.

Why it matters: simulators that heed both limits stop the leader early or not at all; others let the follower through
its own limit.

What to do: correct the sign or the size of the ratio, or give the follower the range that the message names.

Example: `<mimic joint="left" multiplier="-1"/>` of a finger with `lower="0" upper="0.03"`, copied from the left one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from kinform.consistency.comparisons.as_written import range_as_written
from kinform.consistency.comparisons.ranges import shown
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided
from kinform.consistency.rule import Rule
from kinform.foundation.words import counted, number
from kinform.model.findings import Finding, Witness, stated
from kinform.model.function import Coupling, IntendedJoint

ROUNDED = 0.01
"""Share of the mapped range by which it may exceed the limits: ends are written with two digits and more. A choice."""


def check(context: Context) -> Outcome:
    """Every coupling of two joints with ranges."""
    joints = {joint.name: joint for joint in context.function.joints}
    pairs = [
        (coupling, joints[coupling.joints[0]], joints[coupling.joints[1]])
        for coupling in context.function.couplings
        if not coupling.others and coupling.ratio and all(name in joints for name in coupling.joints)
    ]
    ranged = [pair for pair in pairs if pair[1].range is not None and pair[2].range is not None]
    findings = [finding for pair in ranged for finding in _of_pair(context, *pair)]
    return decided(findings, f"{counted(len(ranged), 'coupling')} of joints with ranges")


def _of_pair(context: Context, coupling: Coupling, follower: IntendedJoint, leader: IntendedJoint) -> Iterator[Finding]:
    assert follower.range is not None and leader.range is not None
    offsets = (j.offset for d in context.assembly.descriptions for j in d.joints if j.name == follower.name)
    offset = next(offsets, 0.0)
    (low, high), (first, last) = follower.range, leader.range
    asked = _ends(coupling.ratio * first + offset, coupling.ratio * last + offset)
    shared = max(asked[0], low), min(asked[1], high)
    width = min(asked[1] - asked[0], high - low)
    if not math.isfinite(width) or width <= 0.0:
        return
    over = max(low - asked[0], asked[1] - high)
    if over <= ROUNDED * width:
        return
    usable = _ends((shared[0] - offset) / coupling.ratio, (shared[1] - offset) / coupling.ratio)
    mapped, limits = _between(context, follower, asked), _between(context, follower, (low, high))
    added = "" if not offset else f" {'+' if offset > 0.0 else '-'} {shown(abs(offset), follower, context.units)}"
    text = (
        f"'{follower.name}' = {number(coupling.ratio)} · '{leader.name}'{added}: the range of '{leader.name}', "
        f"{_between(context, leader, leader.range)}, takes '{follower.name}' to {mapped}, and its limits are {limits}"
    )
    stuck = shared[1] - shared[0] <= ROUNDED * width
    if not stuck:
        text += f": both hold only for '{leader.name}' at {_between(context, leader, usable)}"
    elif shared[1] < shared[0] - ROUNDED * width:
        text += ": they share nothing, and one of the two limits is always passed"
    else:
        text += f": they share only {shown(0.5 * sum(shared), follower, context.units)}, so neither joint can move"
    remedy = f"Give '{follower.name}' {range_as_written(context, follower, asked) or mapped}"
    flipped = _ends(offset - coupling.ratio * first, offset - coupling.ratio * last)
    if min(flipped[1], high) - max(flipped[0], low) >= (1.0 - ROUNDED) * (flipped[1] - flipped[0]):
        remedy += f", or turn the ratio round to {number(-coupling.ratio)}, with which the limits agree"
    elif not stuck:
        remedy += (
            f", or '{leader.name}' {range_as_written(context, leader, usable) or _between(context, leader, usable)}"
        )
    yield RULE.at("error" if stuck else "warning").finding(
        coupling.joints, text,
        found=limits,
        intended=mapped,
        place=follower.point,
        declared=coupling,
        remedy=remedy + ".",
        witness=_witness(context, leader) if stuck else None,
    )  # fmt: skip


def _witness(context: Context, leader: IntendedJoint) -> Witness | None:
    """That the limits of the leader stand where it is stated."""
    described = (j.limits for d in context.assembly.descriptions for j in d.joints if j.name == leader.name)
    limits = next(described, None) or ()
    return stated(leader, leader.name.rpartition("/")[2], *(repr(end) for end in limits if end is not None))


def _ends(one: float, other: float) -> tuple[float, float]:
    return (one, other) if one <= other else (other, one)


def _between(context: Context, joint: IntendedJoint, ends: tuple[float, float]) -> str:
    return " to ".join(shown(end, joint, context.units) for end in ends)


RULE = Rule(
    "KF418",
    "coupled-ranges-disagree",
    "warning",
    __doc__,
    check,
    needs=("stated couplings", "stated ranges"),
    also=("error",),
)
