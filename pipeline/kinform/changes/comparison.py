"""Two behaviours side by side: which joints changed, which axes moved, which freedoms and masses were gained or lost.

Bodies are matched by their parts, not by their names, so a part that renames a body hides nothing; joints by the
bodies that they join. An axis that moved is told by the angle between the lines and by their distance, whichever
way their directions point.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from kinform.changes.behaviours import Snapshot, snapshot
from kinform.changes.causes import Cause, Consequences, causes_of, grouped, renames
from kinform.changes.change import Change, Measure, freedoms_changed, quoted, signed
from kinform.changes.joints import joint_changes
from kinform.changes.masses import mass_changes
from kinform.changes.matching import Holders, new_names, same_bodies, with_names
from kinform.changes.tolerance import Tolerance
from kinform.design import Design
from kinform.frozen import dataclass

NEW = "ranges"
"""What earlier versions did not compute unasked: where only the later side knows it, it is new, not in doubt."""

PARTS = ("bodies", "joints", "ranges", "mobility", "masses", "interferences", "simulation", "findings")
"""What is compared, where both know it."""


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
    new: tuple[str, ...] = ()
    """What only the later one knows, and is said once: nothing could have been lost."""
    causes: tuple[Cause, ...] = ()
    """What was done to the parts, where the designs themselves are known."""
    groups: tuple[Consequences, ...] = ()
    """The changes by the causes that they follow from; empty without causes."""

    @property
    def code(self) -> int:
        """Exit code: 0 the same, 1 something changed, 2 not verified."""
        if self.changes:
            return 1
        return 2 if self.missing or not self.compared else 0


def compare(
    before: Snapshot, after: Snapshot, tolerance: Tolerance | None = None, other: Mapping[str, str] | None = None
) -> Comparison:
    """What of `before` is otherwise in `after`, beyond the tolerance; `other` has the names that parts have now, by
    those that they had, where these are known."""
    within = Tolerance() if tolerance is None else tolerance
    old, new = ({name for name in PARTS if getattr(side, name) is not None} for side in (before, after))
    both = [name for name in PARTS if name in old & new]
    lacking = old ^ new
    come: tuple[str, ...] = ()
    if NEW in new - old and both:
        lacking.remove(NEW)
        come = (NEW,) if any(joint.range_status != "unknown" for joint in after.joints or ()) else ()
    missing = [(name, "not computed " + ("before" if name in new else "after")) for name in PARTS if name in lacking]
    other = new_names(before, after) if other is None else other
    before = with_names(before, other)
    now = same_bodies(before, after)
    measure = Measure(within, after.units)
    ranged = before.ranges is not None and after.ranges is not None
    steps = {
        "bodies": lambda: _bodies(before, after, now, other),
        "joints": lambda: joint_changes(before, after, now, measure, ranged),
        "mobility": lambda: _mobility(before, after),
        "masses": lambda: mass_changes(before, after, now, measure),
        "interferences": lambda: _interferences(before, after, measure),
        "simulation": lambda: _simulation(before, after),
        "findings": lambda: _findings(before, after),
    }
    changes = tuple(change for name in both if name in steps for change in steps[name]())
    return Comparison(before.assembly, after.assembly, changes, tuple(missing), tuple(both), within, come)


def compare_designs(before: Design, after: Design, tolerance: Tolerance | None = None) -> Comparison:
    """As `compare`, of two designs: with what was done to the parts, and what follows from it."""
    old, new = snapshot(before), snapshot(after)
    other = renames(before, after, old, new)
    found = compare(old, new, tolerance, other)
    causes = causes_of(before, after, other)
    groups = grouped(found.changes, causes, (before, after), (old, new), other) if causes else ()
    return replace(found, causes=causes, groups=tuple(groups))


def _bodies(before: Snapshot, after: Snapshot, now: Mapping[str, str], other: Mapping[str, str]) -> Iterator[Change]:
    """Bodies that came, went, merged, were renamed or have other parts; parts with new names; the ground."""
    old, new = dict(before.bodies or ()), dict(after.bodies or ())
    held_before, held_after = Holders(old), Holders(new)
    for was, name in sorted(other.items(), key=lambda item: item[1]):
        yield Change("part-renamed", (name,), f"was named {quoted(was)}, with the same mesh", was, name)
    for name in sorted(old):
        if name not in now:
            into = held_after.of(old[name])
            if into is None:
                yield Change("body-gone", (name,), "is gone", ", ".join(old[name]), None)
            else:
                yield Change("body-merged", (name,), f"is part of {quoted(into)} now", name, into)
    came_from = {body: name for name, body in now.items()}
    for name in sorted(new):
        if name not in came_from:
            source = held_before.of(new[name])
            message = "is new" if source is None else f"was part of {quoted(source)}"
            yield Change("body-new", (name,), message, source, ", ".join(new[name]))
            continue
        was = came_from[name]
        if was != name and other.get(was) != name:
            yield Change("body-renamed", (name,), f"was named {quoted(was)}", was, name)
        added, lost = sorted(set(new[name]) - set(old[was])), sorted(set(old[was]) - set(new[name]))
        if added:
            yield Change("body-parts", (name,), f"has {quoted(*added)} in addition", None, ", ".join(added))
        if lost:
            yield Change("body-parts", (name,), f"no longer has {quoted(*lost)}", ", ".join(lost), None)
    if before.ground is not None and after.ground != now.get(before.ground, before.ground):
        message = f"is the ground instead of {quoted(before.ground)}"
        yield Change("ground", (after.ground or "–",), message, before.ground, after.ground)


def _mobility(before: Snapshot, after: Snapshot) -> Iterator[Change]:
    old = dict(before.mobility or ())
    for name, value in after.mobility or ():
        was = old.get(name)
        if was == value:
            continue
        label = name.replace("_", " ") + ("" if "mobility" in name else " mobility" if name in _FREEDOMS else "")
        amount = None if was is None or value is None else float(value - was)
        message = f"{label} was {_or_unknown(was)}, is {_or_unknown(value)}"
        if amount is not None and name == "effective":
            message += f": {freedoms_changed(int(amount))}"
        yield Change("mobility", (name,), message, _or_unknown(was), _or_unknown(value), amount, "freedoms")


_FREEDOMS = ("instantaneous", "finite", "effective")


def _interferences(before: Snapshot, after: Snapshot, measure: Measure) -> Iterator[Change]:
    old, new = dict(before.interferences or ()), dict(after.interferences or ())
    for pair in sorted(set(old) | set(new)):
        one, two = old.get(pair), new.get(pair)
        was, now = (None if depth is None else measure.length(depth) for depth in (one, two))
        if one is not None and two is None:
            message = "may still overlap" if pair in after.possible_overlaps else "no longer overlap"
            yield Change("interference-gone", pair, message, was, None, -one, "m")
        elif one is None and two is not None:
            yield Change("interference-new", pair, f"overlap by {now}", None, now, two, "m")
        elif one is not None and two is not None and not measure.within.lengths_agree(one, two):
            message = f"overlap {signed(two - one, measure.length)}"
            yield Change("interference", pair, message, was, now, two - one, "m")


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


def _or_unknown(value: int | None) -> str:
    return "unknown" if value is None else str(value)
