"""Bodies that no joint connects with ground although they interpenetrate others.

They count as free, but what interpenetrates may hold them: the mobility is doubtful.
"""

from __future__ import annotations

from collections.abc import Sequence

from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.words import quoted
from kinform.frozen import dataclass
from kinform.model.contacts import Contacts, Interference
from kinform.model.kinematics import Kinematics
from kinform.model.names import BodyName


@dataclass(frozen=True)
class Disconnected:
    """Bodies that joints connect with each other, but not with ground."""

    bodies: tuple[BodyName, ...]
    """In the order of the names."""
    overlap: Interference
    """The deepest with any other body."""


def disconnected_bodies(kinematics: Kinematics, contacts: Contacts) -> tuple[Disconnected, ...]:
    """All such bodies, by the names of the first."""
    names = [body.name for body in kinematics.bodies]
    node = {name: k for k, name in enumerate(names)}
    of_part = {part: node[body.name] for body in kinematics.bodies for part in body.parts}
    sets = UnionFind(len(names))
    for joint in kinematics.joints:
        sets.union(*(node[name] for name in joint.bodies))
    home = {sets.find(node[body.name]) for body in kinematics.bodies if body.ground}
    deepest: dict[int, Interference] = {}
    for overlap in contacts.interferences:
        roots = {sets.find(of_part[part]) for part in overlap.parts}
        for root in roots - home if len(roots) > 1 else ():
            if root not in deepest or overlap.depth > deepest[root].depth:
                deepest[root] = overlap
    found = [
        Disconnected(tuple(sorted(name for name in names if sets.find(node[name]) == root)), overlap)
        for root, overlap in deepest.items()
    ]
    return tuple(sorted(found, key=lambda one: one.bodies))


def disconnected_in_words(found: Sequence[Disconnected]) -> str:
    """The doubt about them, as a sentence without its full stop; of several, about the one with the deepest overlap."""
    worst = max(found, key=lambda one: one.overlap.depth)
    more = f" (and {len(found) - 1} more such)" if len(found) > 1 else ""
    return (
        f"what holds {quoted(worst.bodies)} is not known: {quoted(worst.overlap.parts)} overlap by "
        f"{1e3 * worst.overlap.depth:.2g} mm where nothing mates{more}"
    )
