"""Suggestions pair by pair, each with its evidence. None of them is proof: holes line up across true joints too
(a servo's horn is bolted to its bracket), and of the confident errors on real robots most came from rims.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinform.fastening.bores import Cylinders, cylinders_of, lined_up, occupied
from kinform.model.assembly import Assembly, freeze
from kinform.model.contacts import Contacts, Patch, Suggestion
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces

__all__ = ["fastened", "suggest"]

Array = NDArray[np.float64]
Pair = tuple[PartName, PartName]

LEAST_AREA = 100.0
"""Least area, in squared contact tolerances, of a contact from which an axis is read."""
ALIKE = 0.02
"""Relative difference of radii and distances within which holes are of one pattern."""
WALL = 0.02
"""Cosine below which a face is parallel to a direction."""


def suggest(
    assembly: Assembly, surfaces: Mapping[str, MeshSurfaces], contacts: Contacts
) -> tuple[Suggestion, ...]:  # fmt: skip
    """Suggestions for all pairs in contact, sorted by part names, then kind."""
    if not contacts.patches:
        return ()
    cylinders = cylinders_of(assembly, surfaces)
    of_pair: dict[Pair, list[Patch]] = defaultdict(list)
    for patch in contacts.patches:
        of_pair[patch.parts].append(patch)
    found: list[Suggestion] = []
    for pair in sorted(of_pair):
        found += _of_pair(pair, of_pair[pair], cylinders, contacts.tolerance[pair])
    return tuple(sorted(found, key=lambda hint: (hint.parts, hint.kind)))


def _of_pair(
    pair: Pair, patches: list[Patch], cylinders: Mapping[PartName, Cylinders], tolerance: float
) -> list[Suggestion]:  # fmt: skip
    firm = [patch for patch in patches if not patch.one_sided]
    out = _pressed(pair, firm)
    planes = [patch for patch in firm if patch.kind == "plane"]
    if not planes:
        return out
    largest = max(planes, key=lambda patch: patch.area)
    a, b = cylinders[pair[0]], cylinders[pair[1]]
    others = [cylinders[name] for name in sorted(cylinders) if name not in pair]
    pattern = lined_up(a, b, largest, tolerance)
    holes = [
        (i, j, place)
        for i, j, place in pattern
        if a.sides[i] < 0 and b.sides[j] < 0
        and not occupied((a.axes[i], place, max(float(a.radii[i]), float(b.radii[j]))), others, tolerance)
    ]  # fmt: skip
    holes = _distinct(holes, tolerance)
    pivoted = any(patch.kind == "cylinder" and abs(float(patch.axis @ largest.axis)) > 1 - WALL for patch in firm)
    if len(holes) >= 2 and not pivoted:
        middle = np.mean([place for _, _, place in holes], axis=0)
        out.append(_hint(pair, "holes", f"{len(holes)} aligned empty holes", largest.axis, middle))
    out += _pocket(pair, firm)
    if all(patch.kind == "plane" and abs(patch.axis @ largest.axis) > 0.9999 for patch in patches):
        area = sum(patch.area for patch in planes)
        if area >= LEAST_AREA * tolerance**2:
            out += _axis(pair, pattern, holes, a, b, largest, tolerance)
    return out


def _hint(pair: Pair, kind: str, evidence: str, axis: Array, point: Array) -> Suggestion:
    size = np.abs(axis)
    first = int(np.flatnonzero(size > size.max() - 1e-3)[0])
    turned = axis if axis[first] >= 0 or kind == "pocket" else -axis
    return Suggestion(pair, kind, evidence, np.asarray(freeze(turned + 0.0)), np.asarray(freeze(point + 0.0)))


def _distinct(holes: list[tuple[int, int, Array]], tolerance: float) -> list[tuple[int, int, Array]]:
    """One for each place: counterbores and steps stand on one axis."""
    out: list[tuple[int, int, Array]] = []
    for hole in holes:
        if all(np.linalg.norm(hole[2] - other[2]) > tolerance for other in out):
            out.append(hole)
    return out


def _pressed(pair: Pair, firm: list[Patch]) -> list[Suggestion]:
    """A shaft that is larger than its bore."""
    tight = [patch for patch in firm if patch.kind == "cylinder" and patch.fit == "interference"]
    if not tight:
        return []
    patch = max(tight, key=lambda patch: patch.area)
    size = f"{-2e3 * patch.gap:.3g} mm in diameter {2e3 * min(patch.radii):.4g} mm"
    return [_hint(pair, "pressed", f"pressed together by {size}", patch.axis, patch.point)]


def _pocket(pair: Pair, firm: list[Patch]) -> list[Suggestion]:
    """Faces that let one part leave the other in a single direction: a floor, and flat walls all round. Round
    walls alone would let it turn."""
    flat = [patch for patch in firm if patch.kind == "plane"]
    for floor in sorted(flat, key=lambda patch: -patch.area):
        out = floor.axis
        walls = []
        for patch in firm:
            if patch.kind == "plane" and abs(float(patch.axis @ out)) < WALL:
                walls.append(patch.axis[None])
            elif patch.kind == "cylinder" and abs(float(patch.axis @ out)) > 1 - WALL:
                continue
            elif patch.kind != "plane" or float(patch.axis @ out) < 1 - WALL:
                break
        else:
            if walls and _surrounded(np.concatenate(walls), out):
                text = "in a pocket that it can leave one way only"
                return [_hint(pair, "pocket", text, out, floor.point)]
    return []


def _surrounded(normals: Array, out: Array) -> bool:
    """Whether normals (n, 3) across a direction leave no way aside: no gap of half a turn between them."""
    helper = np.eye(3)[np.argmin(np.abs(out))]
    x = np.cross(out, helper)
    x /= np.linalg.norm(x)
    angle = np.sort(np.arctan2(normals @ np.cross(out, x), normals @ x))
    gaps = np.diff(np.r_[angle, angle[:1] + 2 * math.pi])
    return bool(gaps.max() < math.pi - 0.05)


def _axis(
    pair: Pair, pattern: list[tuple[int, int, Array]], holes: list[tuple[int, int, Array]],
    a: Cylinders, b: Cylinders, plane: Patch, tolerance: float,
) -> list[Suggestion]:  # fmt: skip
    """The one axis about which both parts have round rims, or patterns of holes about one centre."""
    places = _distinct(pattern, tolerance)
    if len(places) == 1:
        i, j, place = places[0]
        sizes = f"{2e3 * a.radii[i]:.4g} and {2e3 * b.radii[j]:.4g} mm"
        return [_hint(pair, "rim", f"coaxial rims of diameter {sizes}", plane.axis, place)]
    if len(places) > 1:
        return []
    centres = [_bolt_circle(side, plane, tolerance) for side in (a, b)]
    first, second = centres
    if first is None or second is None or holes:
        return []
    if np.linalg.norm(first[0] - second[0]) > 0.2 * tolerance:
        return []
    text = f"bolt circles of {first[1]} and {second[1]} holes about one centre"
    return [_hint(pair, "bolt circle", text, plane.axis, first[0])]


def _bolt_circle(side: Cylinders, plane: Patch, tolerance: float) -> tuple[Array, int] | None:
    """Centre on the plane, and number, of the largest set of equal holes that are evenly spaced on a circle."""
    upright = (side.sides < 0) & (np.abs(side.axes @ plane.axis) > 0.9999) if len(side.radii) else np.zeros(0, bool)
    holes = side.chosen(upright)
    height = (holes.points - plane.point) @ plane.axis
    places = holes.points - height[:, None] * plane.axis
    near = np.abs(height) <= holes.halves + tolerance
    best: tuple[Array, int] | None = None
    for radius in np.unique(holes.radii[near]):
        some = places[near & (np.abs(holes.radii - radius) <= ALIKE * radius)]
        if len(some) < 3 or (best is not None and len(some) <= best[1]):
            continue
        centre = some.mean(axis=0)
        arms = np.linalg.norm(some - centre, axis=1)
        apart = 2 * arms.mean() * math.sin(math.pi / len(some))
        steps = np.sort(np.linalg.norm(some[:, None] - some[None], axis=2), axis=1)[:, 1]
        if np.ptp(arms) <= ALIKE * arms.mean() and np.abs(steps - apart).max() <= ALIKE * apart:
            best = (centre, len(some))
    return best


def fastened(suggestions: tuple[Suggestion, ...]) -> list[tuple[list[PartName], str]]:
    """Sets of parts that suggestions hold together, each with the evidence, sorted by part."""
    sets: list[tuple[set[PartName], list[str]]] = []
    for hint in suggestions:
        if not hint.fastens:
            continue
        touched = [entry for entry in sets if entry[0].intersection(hint.parts)]
        joined = (set(hint.parts).union(*(entry[0] for entry in touched)), [f"{'~'.join(hint.parts)}: {hint.evidence}"])
        for entry in touched:
            sets.remove(entry)
            joined[1][:0] = entry[1]
        sets.append(joined)
    return sorted((sorted(parts), "; ".join(evidence)) for parts, evidence in sets)
