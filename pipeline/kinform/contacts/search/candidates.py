"""Which pairs of parts can touch at all: FCL's dynamic tree over boxes inflated by the contact tolerance."""

from __future__ import annotations

import fcl
import numpy as np

from kinform.contacts.constants import MATING_REACH
from kinform.model.assembly import Assembly
from kinform.model.names import PartName

Pair = tuple[PartName, PartName]


class _Excluded:
    """Pairs that are not looked at: one group, or assumed not to touch. They are told from the names that stand for a
    part, not listed: a group of 10,000 parts has 50 million pairs."""

    def __init__(self, assembly: Assembly):
        self._group = {part: group.name for group in assembly.groups for part in group.parts}
        self._ignored: dict[str, set[str]] = {}
        for assumption in assembly.assumptions:
            if assumption.ignore:
                first, second = map(str, assumption.between)
                self._ignored.setdefault(first, set()).add(second)
                self._ignored.setdefault(second, set()).add(first)

    def __contains__(self, pair: Pair) -> bool:
        first, second = pair
        group = self._group.get(first)
        if group is not None and group == self._group.get(second):
            return True
        others = set(self._names(second))
        return any(not others.isdisjoint(self._ignored.get(name, ())) for name in self._names(first))

    def _names(self, part: PartName) -> tuple[str, ...]:
        """The names that stand for a part: its own, and that of its group."""
        group = self._group.get(part)
        return (str(part),) if group is None else (str(part), group)


def _collect(first: fcl.CollisionObject, second: fcl.CollisionObject, met: list[tuple[int, int]]) -> bool:
    """FCL's callback. The objects are new wrappers each time; only the geometry in a contact is ours."""
    result = fcl.CollisionResult()
    fcl.collide(first, second, fcl.CollisionRequest(num_max_contacts=1, enable_contact=False), result)
    met.extend((id(contact.o1), id(contact.o2)) for contact in result.contacts)
    return False


def candidate_pairs(assembly: Assembly) -> dict[Pair, float]:
    """Pairs of meshed parts whose boxes come within the contact tolerance, and that tolerance (m).

    Pairs are sorted by name, first < second. Pairs inside one group are one body and are left out,
    and so are pairs that an assumption declares not to touch.
    """
    tolerances = assembly.tolerances
    parts = [part for part in assembly.parts if part.mesh is not None and len(part.mesh.faces)]
    if len(parts) < 2:
        return {}
    owner: dict[int, int] = {}
    boxes, objects, lows, highs, sizes = [], [], [], [], []
    for number, part in enumerate(parts):
        assert part.mesh is not None
        low, high = part.mesh.placed_box(part.X_WP)
        size = part.mesh.size
        grow = 2.0 * MATING_REACH * tolerances.widest(size)
        box = fcl.Box(*(high - low + grow))
        boxes.append(box)
        objects.append(fcl.CollisionObject(box, fcl.Transform(0.5 * (low + high))))
        owner[id(box)] = number
        lows.append(low)
        highs.append(high)
        sizes.append(size)
    manager = fcl.DynamicAABBTreeCollisionManager()
    manager.registerObjects(objects)
    manager.setup()
    met: list[tuple[int, int]] = []
    manager.collide(met, _collect)
    excluded = _Excluded(assembly)
    pairs: dict[Pair, float] = {}
    for first, second in met:
        i, j = sorted((owner[first], owner[second]), key=lambda number: parts[number].name)
        pair = (parts[i].name, parts[j].name)
        tolerance = tolerances.contact_of(sizes[i], sizes[j])
        apart = np.maximum(lows[i] - highs[j], lows[j] - highs[i]).max()
        if pair not in excluded and apart <= MATING_REACH * tolerance:
            pairs[pair] = tolerance
    return dict(sorted(pairs.items()))
