"""Which part and which body of one behaviour is which of another.

Bodies are matched by their parts, parts by their names; a part that is gone is one that is new where it alone has its
mesh.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import replace

from kinform.changes.behaviours import Snapshot


def new_names(before: Snapshot, after: Snapshot, known: Mapping[str, str] | None = None) -> dict[str, str]:
    """By part that is gone: the new part that alone has its mesh, where no other part that is gone has that mesh.
    `known`: parts that have been found already, and are left out."""
    found = {} if known is None else known
    old, new = ({part for _, parts in side.bodies or () for part in parts} for side in (before, after))
    gone = [(digest, part) for part, digest in before.shapes if part in old - new - set(found)]
    fresh = [(digest, part) for part, digest in after.shapes if part in new - old - set(found.values())]
    of_gone, of_fresh = Counter(digest for digest, _ in gone), Counter(digest for digest, _ in fresh)
    there = dict(fresh)
    return {part: there[digest] for digest, part in gone if of_gone[digest] == of_fresh[digest] == 1}


def with_names(before: Snapshot, other: Mapping[str, str]) -> Snapshot:
    """The behaviour before, its parts by the names that they have now."""
    if not other:
        return before

    def names(parts: Iterable[str]) -> tuple[str, ...]:
        return tuple(sorted(other.get(part, part) for part in parts))

    overlaps = tuple((names(pair), depth) for pair, depth in before.interferences or ())
    return replace(
        before,
        bodies=tuple((name, names(parts)) for name, parts in before.bodies or ()),
        interferences=None if before.interferences is None else tuple(((a, b), depth) for (a, b), depth in overlaps),
        findings=None
        if before.findings is None
        else tuple(
            (code, tuple(_now(name, other) for name in subject), severity, count)
            for code, subject, severity, count in before.findings
        ),
    )


def _now(name: str, other: Mapping[str, str]) -> str:
    """A part, or a joint of two bodies that are named by parts, by its name now."""
    return other.get(name) or "~".join(sorted(other.get(part, part) for part in name.split("~")))


def same_bodies(before: Snapshot, after: Snapshot) -> dict[str, str]:
    """By body before: the body after that holds most of its parts, where that is so the other way too."""
    old, new = dict(before.bodies or ()), dict(after.bodies or ())
    holders = Holders(new), Holders(old)
    there = {name: holders[0].of(parts) for name, parts in old.items()}
    back = {name: holders[1].of(parts) for name, parts in new.items()}
    return {name: body for name, body in there.items() if body is not None and back[body] == name}


class Holders:
    """Bodies, by name, and the parts that each holds."""

    def __init__(self, bodies: Mapping[str, tuple[str, ...]]):
        self._of: dict[str, list[str]] = {}
        for name, held in bodies.items():
            for part in sorted(set(held)):
                self._of.setdefault(part, []).append(name)

    def of(self, parts: tuple[str, ...]) -> str | None:
        """The body that holds most of the parts; None where none holds any."""
        shared = Counter(name for part in set(parts) for name in self._of.get(part, ()))
        return min(shared, key=lambda name: (-shared[name], name), default=None)
