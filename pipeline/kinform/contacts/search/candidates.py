"""Which pairs of parts can touch at all: FCL's dynamic tree over boxes inflated by the contact tolerance."""

from __future__ import annotations

import fcl
import numpy as np

from kinform.contacts.constants import MATING_REACH
from kinform.model.assembly import Assembly
from kinform.model.names import PartName

Pair = tuple[PartName, PartName]


def excluded_pairs(assembly: Assembly) -> frozenset[Pair]:
    """Pairs (sorted names) that are not looked at: one group, or assumed not to touch."""
    excluded: set[Pair] = set()
    for group in assembly.groups:
        excluded |= {(a, b) for a in group.parts for b in group.parts if a < b}
    for assumption in assembly.assumptions:
        if assumption.ignore:
            first, second = (assembly.parts_of(name) for name in assumption.between)
            excluded |= {(min(a, b), max(a, b)) for a in first for b in second if a != b}
    return frozenset(excluded)


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
    excluded = excluded_pairs(assembly)
    pairs: dict[Pair, float] = {}
    for first, second in met:
        i, j = sorted((owner[first], owner[second]), key=lambda number: parts[number].name)
        pair = (parts[i].name, parts[j].name)
        tolerance = tolerances.contact_of(sizes[i], sizes[j])
        apart = np.maximum(lows[i] - highs[j], lows[j] - highs[i]).max()
        if pair not in excluded and apart <= MATING_REACH * tolerance:
            pairs[pair] = tolerance
    return dict(sorted(pairs.items()))
