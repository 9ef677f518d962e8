"""Two behaviours side by side: which joints changed, which axes moved, which freedoms and masses were gained or lost.

Bodies are matched by their parts, not by their names, so a part that renames a body hides nothing; joints by the
bodies that they join. An axis that moved is told by the angle between the lines and by their distance, whichever
way their directions point.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from kinform.changes.matching import holder, matched, renamed, with_names
from kinform.changes.snapshot import Axis, BodyMass, JointState, Snapshot, Vector
from kinform.changes.tolerance import Tolerance
from kinform.words import angle, direction, length, number, place

__all__ = ["Change", "Comparison", "compare"]


@dataclass(frozen=True)
class _Said:
    """Lengths and places in the units of an assembly."""

    units: str

    def length(self, metres: float) -> str:
        return length(metres, self.units)

    def place(self, point: Vector) -> str:
        return place(point, self.units)

    def line(self, axis: Axis | None) -> str | None:
        if axis is None:
            return None
        return direction(axis.direction) + ("" if axis.point is None else f" through {self.place(axis.point)}")


PARTS = ("bodies", "joints", "ranges", "mobility", "masses", "interferences", "simulation", "findings")
"""What is compared, where both know it."""


@dataclass(frozen=True)
class Change:
    """One thing that is not as it was."""

    kind: str
    """Hyphenated: "joint-type", "axis-moved", "mass", …"""
    subject: tuple[str, ...]
    """Names as they are now, or were where it is gone."""
    message: str
    """Without the subject: "moved by 0.3 mm"."""
    before: str | None = None
    after: str | None = None
    amount: float | None = None
    """SI and radians, after less before, or how far."""
    unit: str | None = None
    place: Vector | None = None
    """m, world: where it is now, as far as it is known."""


@dataclass(frozen=True)
class Comparison:
    """All changes, sorted by kind of subject and name; and what could not be compared."""

    before: str
    after: str
    """Names of the assemblies."""
    changes: tuple[Change, ...]
    missing: tuple[tuple[str, str], ...]
    """(what, why) that only one side knows: not verified."""
    compared: tuple[str, ...]
    tolerance: Tolerance

    @property
    def code(self) -> int:
        """Exit code: 0 the same, 1 something changed, 2 not verified."""
        if self.changes:
            return 1
        return 2 if self.missing or not self.compared else 0


def compare(before: Snapshot, after: Snapshot, tolerance: Tolerance | None = None) -> Comparison:
    """What of `before` is otherwise in `after`, beyond the tolerance."""
    within = Tolerance() if tolerance is None else tolerance
    known = {name: (getattr(before, name) is not None, getattr(after, name) is not None) for name in PARTS}
    both = [name for name, (one, two) in known.items() if one and two]
    missing = [
        (name, "not computed " + ("before" if two else "after")) for name, (one, two) in known.items() if one != two
    ]
    other = renamed(before, after)
    before = with_names(before, other)
    now = matched(before, after)
    say = _Said(after.units)
    ranged = before.ranges is not None and after.ranges is not None
    steps = {
        "bodies": lambda: _bodies(before, after, now, other),
        "joints": lambda: _joints(before, after, now, within, say, ranged),
        "mobility": lambda: _mobility(before, after),
        "masses": lambda: _masses(before, after, now, within, say),
        "interferences": lambda: _interferences(before, after, within, say),
        "simulation": lambda: _simulation(before, after),
        "findings": lambda: _findings(before, after),
    }
    changes = tuple(change for name in both if name in steps for change in steps[name]())
    return Comparison(before.assembly, after.assembly, changes, tuple(missing), tuple(both), within)


def _bodies(before: Snapshot, after: Snapshot, now: Mapping[str, str], other: Mapping[str, str]) -> Iterator[Change]:
    old, new = dict(before.bodies or ()), dict(after.bodies or ())
    for was, name in sorted(other.items(), key=lambda item: item[1]):
        yield Change("part-renamed", (name,), f"was named {_q(was)}, with the same mesh", was, name)
    for name in sorted(old):
        if name not in now:
            into = holder(old[name], new)
            if into is None:
                yield Change("body-gone", (name,), "is gone", ", ".join(old[name]), None)
            else:
                yield Change("body-merged", (name,), f"is part of {_q(into)} now", name, into)
    came_from = {found: name for name, found in now.items()}
    for name in sorted(new):
        if name not in came_from:
            source = holder(new[name], old)
            told = "is new" if source is None else f"was part of {_q(source)}"
            yield Change("body-new", (name,), told, source, ", ".join(new[name]))
            continue
        was = came_from[name]
        if was != name and other.get(was) != name:
            yield Change("body-renamed", (name,), f"was named {_q(was)}", was, name)
        added, lost = sorted(set(new[name]) - set(old[was])), sorted(set(old[was]) - set(new[name]))
        if added:
            yield Change("body-parts", (name,), f"has {_list(added)} in addition", None, ", ".join(added))
        if lost:
            yield Change("body-parts", (name,), f"no longer has {_list(lost)}", ", ".join(lost), None)
    if before.ground is not None and after.ground != now.get(before.ground, before.ground):
        yield Change(
            "ground",
            (after.ground or "–",),
            f"is the ground instead of {_q(before.ground)}",
            before.ground,
            after.ground,
        )


def _joints(
    before: Snapshot, after: Snapshot, now: Mapping[str, str], within: Tolerance, say: _Said, ranged: bool
) -> Iterator[Change]:
    into = {name: now.get(name) or holder(parts, dict(after.bodies or ())) for name, parts in before.bodies or ()}
    new = {frozenset(joint.bodies): joint for joint in after.joints or ()}
    found = set()
    for joint in before.joints or ():
        ends = [into.get(name) for name in joint.bodies]
        pair = frozenset(str(end) for end in ends)
        if pair in new and len(pair) == 2:
            found.add(pair)
            turned = tuple(str(end) for end in ends) != new[pair].bodies
            yield from _joint(joint, new[pair], within, say)
            if ranged and joint.type == new[pair].type:
                yield from _range(joint, new[pair], turned, within, say)
        elif len(pair) == 1 and ends[0] is not None:
            yield Change(
                "joint-type", (joint.name,), f"became fixed: both are {_q(str(ends[0]))} now",
                joint.type, "fixed", -float(joint.freedoms), "freedoms",
            )  # fmt: skip
        else:
            yield Change("joint-gone", (joint.name,), f"is gone ({joint.type})", joint.type, None)
    for pair, joint in sorted(new.items(), key=lambda item: item[1].name):
        if pair not in found:
            yield Change("joint-new", (joint.name,), f"is new ({joint.type}, {joint.status})", None, joint.type)


def _joint(old: JointState, new: JointState, within: Tolerance, say: _Said) -> Iterator[Change]:
    subject = (new.name,)
    if old.type != new.type:
        less = new.freedoms - old.freedoms
        told = "" if not less else f", {_freedoms(abs(less))} {'gained' if less > 0 else 'lost'}"
        yield Change(
            "joint-type", subject, f"was {old.type}, is {new.type}{told}", old.type, new.type, float(less), "freedoms"
        )
        return
    if old.freedoms != new.freedoms:
        less = new.freedoms - old.freedoms
        told = f"{_freedoms(abs(less))} {'gained' if less > 0 else 'lost'}"
        yield Change("joint-freedoms", subject, told, str(old.freedoms), str(new.freedoms), float(less), "freedoms")
    if old.status != new.status:
        yield Change("joint-status", subject, f"was {old.status}, is {new.status}", old.status, new.status)
    yield from _axes(subject, "axis", old.axis, new.axis, within, say)
    yield from _axes(subject, "second axis", old.axis2, new.axis2, within, say)
    if old.centre is not None and new.centre is not None:
        away = float(np.linalg.norm(np.subtract(new.centre, old.centre)))
        if away > within.length:
            yield Change(
                "axis-moved", subject, f"centre moved by {say.length(away)}", say.place(old.centre),
                say.place(new.centre), away, "m", new.centre,
            )  # fmt: skip
    if (old.pitch is None) != (new.pitch is None) or (
        old.pitch is not None and new.pitch is not None and not within.lengths_agree(old.pitch, new.pitch)
    ):
        one, two = (None if pitch is None else say.length(pitch) for pitch in (old.pitch, new.pitch))
        yield Change("pitch", subject, "has another pitch", one, two)


def _axes(
    subject: tuple[str, ...], what: str, old: Axis | None, new: Axis | None, within: Tolerance, say: _Said
) -> Iterator[Change]:
    if old is None or new is None:
        if old is not new:
            told = f"{what} is {'known now' if old is None else 'no longer known'}"
            yield Change("axis-known", subject, told, say.line(old), say.line(new))
        return
    one, two = np.array(old.direction), np.array(new.direction)
    tilt = math.atan2(float(np.linalg.norm(np.cross(one, two))), abs(float(one @ two)))
    if tilt > within.angle:
        yield Change(
            "axis-tilted", subject, f"{what} tilted by {_deg(tilt)}", direction(one), direction(two), tilt, "rad"
        )
    if old.point is not None and new.point is not None:
        # how far the new axis is from where the old one was located
        arm = np.array(old.point) - np.array(new.point)
        away = float(np.linalg.norm(arm - two * float(two @ arm)))
        if away > within.length:
            yield Change(
                "axis-moved", subject, f"{what} moved by {say.length(away)}", say.place(old.point),
                say.place(new.point), away, "m", new.point,
            )  # fmt: skip


def _range(old: JointState, new: JointState, turned: bool, within: Tolerance, say: _Said) -> Iterator[Change]:
    """How far the joint goes. Its value is of the second body relative to the first, about the axis: exchanged bodies
    turn the range round, and so does an axis that has come to point the other way."""
    if old.axis is not None and new.axis is not None and np.dot(old.axis.direction, new.axis.direction) < 0.0:
        turned = not turned
    lower, upper = (new.lower, new.upper) if not turned else (_minus(new.upper), _minus(new.lower))
    subject = (new.name,)
    if old.range_status != new.range_status:
        told = f"range was {old.range_status}, is {new.range_status}"
        yield Change("range-status", subject, told, old.range_status, new.range_status)
    shown, agree, unit = (say.length, within.lengths_agree, "m") if old.slides else (_deg, within.angles_agree, "rad")
    for side, one, two in (("lower", old.lower, lower), ("upper", old.upper, upper)):
        if one is None or two is None:
            if one is not two and old.range_status == new.range_status:
                told = f"{side} end of the range was {_end(one, shown)}, is {_end(two, shown)}"
                yield Change("range", subject, told, _end(one, shown), _end(two, shown))
        elif agree(one, two):
            continue
        elif math.isfinite(one) and math.isfinite(two):
            told = f"{side} end of the range {_signed(two - one, shown)}"
            yield Change("range", subject, told, shown(one), shown(two), two - one, unit)
        else:
            told = f"{side} end of the range was {_end(one, shown)}, is {_end(two, shown)}"
            yield Change("range", subject, told, _end(one, shown), _end(two, shown))


def _mobility(before: Snapshot, after: Snapshot) -> Iterator[Change]:
    old = dict(before.mobility or ())
    for name, value in after.mobility or ():
        was = old.get(name)
        if was == value:
            continue
        label = name.replace("_", " ") + ("" if "mobility" in name else " mobility" if name in _FREEDOMS else "")
        amount = None if was is None or value is None else float(value - was)
        told = f"{label} was {_or_unknown(was)}, is {_or_unknown(value)}"
        if amount is not None and name == "effective":
            told += f": {_freedoms(abs(int(amount)))} {'gained' if amount > 0 else 'lost'}"
        yield Change("mobility", (name,), told, _or_unknown(was), _or_unknown(value), amount, "freedoms")


_FREEDOMS = ("instantaneous", "finite", "effective")


def _masses(
    before: Snapshot, after: Snapshot, now: Mapping[str, str], within: Tolerance, say: _Said
) -> Iterator[Change]:
    new = {body.name: body for body in after.masses or ()}
    for old in before.masses or ():
        name = now.get(old.name, old.name)
        if name in new:
            yield from _mass(old, new[name], within, say)


def _mass(old: BodyMass, new: BodyMass, within: Tolerance, say: _Said) -> Iterator[Change]:
    subject = (new.name,)
    if (old.mass is None) != (new.mass is None):
        told = "mass is no longer known" if new.mass is None else "mass is known now"
        yield Change("mass", subject, told, _kg(old.mass), _kg(new.mass))
    elif old.mass is not None and new.mass is not None and not within.masses_agree(old.mass, new.mass):
        told = f"mass {_signed(new.mass - old.mass, _grams)}"
        yield Change("mass", subject, told, _kg(old.mass), _kg(new.mass), new.mass - old.mass, "kg")
    if old.centre is not None and new.centre is not None:
        away = float(np.linalg.norm(np.subtract(new.centre, old.centre)))
        if away > within.length:
            told = f"centre of mass moved by {say.length(away)}"
            one, two = say.place(old.centre), say.place(new.centre)
            yield Change("centre-of-mass", subject, told, one, two, away, "m", new.centre)
    if old.moments is not None and new.moments is not None:
        largest = max(max(map(abs, old.moments)), max(map(abs, new.moments)))
        worst = max(abs(two - one) for one, two in zip(old.moments, new.moments, strict=True))
        if worst > within.share * largest:
            told = f"principal moments changed by up to {100.0 * worst / largest:.3g} %"
            yield Change("inertia", subject, told, _moments(old.moments), _moments(new.moments), worst, "kg·m²")
        elif old.tensor is not None and new.tensor is not None:
            turned = max(abs(two - one) for one, two in zip(old.tensor, new.tensor, strict=True))
            if turned > within.share * largest:
                told = (
                    f"axes of inertia turned: entries of the tensor changed by up to {100.0 * turned / largest:.3g} %"
                )
                yield Change("inertia-axes", subject, told, _moments(old.tensor), _moments(new.tensor), turned, "kg·m²")


def _interferences(before: Snapshot, after: Snapshot, within: Tolerance, say: _Said) -> Iterator[Change]:
    old, new = dict(before.interferences or ()), dict(after.interferences or ())
    for pair in sorted(set(old) | set(new)):
        one, two = old.get(pair), new.get(pair)
        shown = [None if depth is None else say.length(depth) for depth in (one, two)]
        if one is not None and two is None:
            yield Change("interference-gone", pair, "no longer overlap", shown[0], None, -one, "m")
        elif one is None and two is not None:
            yield Change("interference-new", pair, f"overlap by {shown[1]}", None, shown[1], two, "m")
        elif one is not None and two is not None and not within.lengths_agree(one, two):
            yield Change(
                "interference", pair, f"overlap {_signed(two - one, say.length)}", shown[0], shown[1], two - one, "m"
            )


def _simulation(before: Snapshot, after: Snapshot) -> Iterator[Change]:
    old, new = before.simulation, after.simulation
    if old is not None and new is not None and old != new:
        one, two = (" ".join(filter(None, (level, status))) for status, level in (old, new))
        yield Change("simulation", ("simulation",), f"was {one}, is {two}", one, two)


def _findings(before: Snapshot, after: Snapshot) -> Iterator[Change]:
    old = {(code, subject): (severity, count) for code, subject, severity, count in before.findings or ()}
    new = {(code, subject): (severity, count) for code, subject, severity, count in after.findings or ()}
    for key in sorted(set(old) | set(new)):
        code, subject = key
        if key not in new:
            yield Change("finding-gone", (code, *subject), f"{old[key][0]} is gone{_rule(code)}", old[key][0], None)
        elif key not in old:
            yield Change("finding-new", (code, *subject), f"{new[key][0]} is new{_rule(code)}", None, new[key][0])
        elif old[key] != new[key]:
            one, two = (f"{count} × {severity}" for severity, count in (old[key], new[key]))
            yield Change("finding", (code, *subject), f"was {one}, is {two}", one, two)


def _rule(code: str) -> str:
    """What is wrong, by the name of the rule: " (parts collide)"."""
    from kinform.consistency import RULES

    return next((f" ({rule.name.replace('-', ' ')})" for rule in RULES if rule.code == code), "")


def _q(name: str) -> str:
    return f"'{name}'"


def _list(names: list[str]) -> str:
    return ", ".join(map(_q, names))


def _freedoms(count: int) -> str:
    return f"{count} freedom" + ("" if count == 1 else "s")


def _minus(value: float | None) -> float | None:
    return None if value is None else -value


def _deg(radians: float) -> str:
    return angle(radians, 4)


def _grams(kilograms: float) -> str:
    return f"{number(1e3 * kilograms)} g"


def _kg(kilograms: float | None) -> str | None:
    return None if kilograms is None else f"{number(kilograms, 6)} kg"


def _signed(value: float, say: Callable[[float], str]) -> str:
    return say(value) if value < 0 else f"+{say(value)}"


def _end(value: float | None, say: Callable[[float], str]) -> str:
    if value is None:
        return "not known"
    return "unbounded" if math.isinf(value) else say(value)


def _or_unknown(value: int | None) -> str:
    return "unknown" if value is None else str(value)


def _moments(moments: Iterable[float]) -> str:
    return "(" + ", ".join(number(x) for x in moments) + ") kg·m²"
