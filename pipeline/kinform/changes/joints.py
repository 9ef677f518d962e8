"""Joints side by side: their types, axes and ranges."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from kinform.changes.behaviours import Axis, JointState, Snapshot
from kinform.changes.change import Change, Measure, freedoms_changed, quoted, signed
from kinform.changes.matching import Holders
from kinform.foundation.words import angle, direction


def joint_changes(
    before: Snapshot, after: Snapshot, now: Mapping[str, str], measure: Measure, ranged: bool
) -> Iterator[Change]:
    """Joints that came, went or changed; ranges where `ranged`: known on both sides."""
    holders = Holders(dict(after.bodies or ()))
    into = {name: now.get(name) or holders.of(parts) for name, parts in before.bodies or ()}
    new = {frozenset(joint.bodies): joint for joint in after.joints or ()}
    still = set()
    for joint in before.joints or ():
        ends = [into.get(name) for name in joint.bodies]
        pair = frozenset(str(end) for end in ends)
        if pair in new and len(pair) == 2:
            still.add(pair)
            turned = tuple(str(end) for end in ends) != new[pair].bodies
            yield from _joint(joint, new[pair], measure)
            if ranged and joint.type == new[pair].type:
                yield from _range(joint, new[pair], turned, measure)
        elif len(pair) == 1 and ends[0] is not None:
            yield Change(
                "joint-type", (joint.name,), f"became fixed: both are {quoted(str(ends[0]))} now",
                joint.type, "fixed", -float(joint.freedoms), "freedoms",
            )  # fmt: skip
        else:
            yield Change("joint-gone", (joint.name,), f"is gone ({joint.type})", joint.type, None)
    for pair, joint in sorted(new.items(), key=lambda item: item[1].name):
        if pair not in still:
            yield Change("joint-new", (joint.name,), f"is new ({joint.type}, {joint.status})", None, joint.type)


def _joint(old: JointState, new: JointState, measure: Measure) -> Iterator[Change]:
    """A joint that is still there: another type hides all else, as axes of different types do not compare."""
    subject = (new.name,)
    gain = new.freedoms - old.freedoms
    if old.type != new.type:
        message = f"was {old.type}, is {new.type}" + (f", {freedoms_changed(gain)}" if gain else "")
        yield Change("joint-type", subject, message, old.type, new.type, float(gain), "freedoms")
        return
    if gain:
        counts = str(old.freedoms), str(new.freedoms)
        yield Change("joint-freedoms", subject, freedoms_changed(gain), *counts, float(gain), "freedoms")
    if old.status != new.status:
        yield Change("joint-status", subject, f"was {old.status}, is {new.status}", old.status, new.status)
    yield from _axes(subject, "axis", old.axis, new.axis, measure)
    yield from _axes(subject, "second axis", old.axis2, new.axis2, measure)
    if old.centre is not None and new.centre is not None:
        away = float(np.linalg.norm(np.subtract(new.centre, old.centre)))
        yield from measure.displacement("axis-moved", subject, "centre", old.centre, new.centre, away)
    if (old.pitch is None) != (new.pitch is None) or (
        old.pitch is not None and new.pitch is not None and not measure.within.lengths_agree(old.pitch, new.pitch)
    ):
        one, two = (None if pitch is None else measure.length(pitch) for pitch in (old.pitch, new.pitch))
        yield Change("pitch", subject, "has another pitch", one, two)


def _axes(
    subject: tuple[str, ...], what: str, old: Axis | None, new: Axis | None, measure: Measure
) -> Iterator[Change]:
    """The angle between two lines, and how far the new one is from where the old one was located."""
    if old is None or new is None:
        if old is not new:
            message = f"{what} is {'known now' if old is None else 'no longer known'}"
            yield Change("axis-known", subject, message, measure.line(old), measure.line(new))
        return
    one, two = np.array(old.direction), np.array(new.direction)
    tilt = math.atan2(float(np.linalg.norm(np.cross(one, two))), abs(float(one @ two)))
    if tilt > measure.within.angle:
        yield Change(
            "axis-tilted", subject, f"{what} tilted by {_deg(tilt)}", direction(one), direction(two), tilt, "rad"
        )
    if old.point is not None and new.point is not None:
        # how far the new axis is from where the old one was located
        arm = np.array(old.point) - np.array(new.point)
        away = float(np.linalg.norm(arm - two * float(two @ arm)))
        yield from measure.displacement("axis-moved", subject, what, old.point, new.point, away)


def _range(old: JointState, new: JointState, turned: bool, measure: Measure) -> Iterator[Change]:
    """How far the joint goes. Its value is of the second body relative to the first, about the axis: exchanged bodies
    turn the range round, and so does an axis that has come to point the other way."""
    if old.axis is not None and new.axis is not None and np.dot(old.axis.direction, new.axis.direction) < 0.0:
        turned = not turned
    lower, upper = (
        (new.range_lower, new.range_upper) if not turned else (_minus(new.range_upper), _minus(new.range_lower))
    )
    subject = (new.name,)
    if old.range_status != new.range_status:
        message = f"range was {old.range_status}, is {new.range_status}"
        yield Change("range-status", subject, message, old.range_status, new.range_status)
    within = measure.within
    shown, agree, unit = (
        (measure.length, within.lengths_agree, "m") if old.slides else (_deg, within.angles_agree, "rad")
    )
    for side, one, two in (("lower", old.range_lower, lower), ("upper", old.range_upper, upper)):
        what, was, now = f"{side} end of the range", _end(one, shown), _end(two, shown)
        message, amount = f"{what} was {was}, is {now}", None
        if one is None or two is None:
            if one is two or old.range_status != new.range_status:  # the status says it
                continue
        elif agree(one, two):
            continue
        elif math.isfinite(one) and math.isfinite(two):
            message, amount = f"{what} {signed(two - one, shown)}", two - one
        yield Change("range", subject, message, was, now, amount, None if amount is None else unit)


def _end(value: float | None, say: Callable[[float], str]) -> str:
    if value is None:
        return "not known"
    return "unbounded" if math.isinf(value) else say(value)


def _minus(value: float | None) -> float | None:
    return None if value is None else -value


def _deg(radians: float) -> str:
    return angle(radians, 4)
