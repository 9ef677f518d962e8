"""Suggestions pair by pair, each with its evidence. None of them is proof: holes line up across true joints too
(a servo's horn is bolted to its bracket), and of the confident errors on real robots most came from rims.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np

from kinform.contacts.fastening.bores import (
    AXES_COAXIAL,
    Cylinders,
    Holes,
    aligned_holes,
    all_cylinders,
    aside,
    cylinders_of,
    occupied,
)
from kinform.contacts.fastening.rims import rims_of
from kinform.contacts.presses import beyond_press
from kinform.foundation.algebra.vectors import canonical_sign, widest_gap
from kinform.model.arrays import Array, freeze
from kinform.model.assembly import Assembly, Part
from kinform.model.contacts import Contacts, Patch, Suggestion, SuggestionKind
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces

PATTERN_ALIKE = 0.02
"""Relative difference of radii and distances within which holes are of one pattern. Chosen, not measured."""
UPRIGHT_COSINE = 0.9999
"""Least cosine of planes that are parallel, and of holes that stand on one: 0.8°. Chosen, not measured."""
WALL_COSINE = 0.02
"""Cosine below which a face is parallel to a direction: 1.1°. Chosen, not measured."""


Pair = tuple[PartName, PartName]


class _Scene:
    """Parts and their cylinders; which parts are near each other."""

    def __init__(self, assembly: Assembly, surfaces: Mapping[str, MeshSurfaces], contacts: Contacts):
        self.parts: dict[PartName, Part] = {part.name: part for part in assembly.parts}
        self.surfaces = surfaces
        self._cylinders: dict[PartName, Cylinders] = {}
        self._rims: dict[tuple[PartName, int], list[tuple[Array, float]]] = {}
        self._near: dict[PartName, set[PartName]] = defaultdict(set)
        for first, second in contacts.candidates:
            self._near[first].add(second)
            self._near[second].add(first)

    def cylinders(self, name: PartName) -> Cylinders:
        """The cylinders of a part that go all round."""
        if name not in self._cylinders:
            self._cylinders[name] = cylinders_of(self.parts[name], self.surfaces)
        return self._cylinders[name]

    def beside(self, pair: Pair) -> Cylinders:
        """Cylinders of the other parts that come near one of the pair."""
        names = (self._near[pair[0]] | self._near[pair[1]]) - set(pair)
        return all_cylinders(self.cylinders(name) for name in sorted(names))

    def rims(self, name: PartName, plane: int) -> list[tuple[Array, float]]:
        """Rims of a plane surface of a part."""
        if (name, plane) not in self._rims:
            part = self.parts[name]
            assert part.mesh is not None
            self._rims[name, plane] = rims_of(part, self.surfaces[part.mesh.digest], plane)
        return self._rims[name, plane]


def suggest(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces],
    contacts: Contacts,
    earlier: Mapping[Pair, Sequence[Suggestion]] | None = None,
) -> tuple[Suggestion, ...]:
    """Suggestions for all pairs in contact, sorted by part names, then kind. Those of pairs in `earlier` are taken
    over: neither they nor any part near one of them changed.
    """
    if not contacts.patches:
        return ()
    scene = _Scene(assembly, surfaces, contacts)
    of_pair: dict[Pair, list[Patch]] = defaultdict(list)
    for patch in contacts.patches:
        of_pair[patch.parts].append(patch)
    hints: list[Suggestion] = []
    for pair in sorted(of_pair):
        if earlier is not None and pair in earlier:
            hints += earlier[pair]
        else:
            hints += _of_pair(pair, of_pair[pair], scene, contacts.tolerance[pair])
    return tuple(sorted(hints, key=lambda hint: (hint.parts, hint.kind)))


def _of_pair(pair: Pair, patches: list[Patch], scene: _Scene, tolerance: float) -> list[Suggestion]:
    """What the contacts of one pair hint at."""
    firm = [patch for patch in patches if not patch.one_sided]
    planes = sorted((patch for patch in firm if patch.kind == "plane"), key=lambda patch: -patch.area)
    out = _pressed(pair, firm) + _pocket(pair, firm)
    if not planes:
        return out
    pivoted = [_pivoted(plane, patches, tolerance) for plane in planes]
    ways: tuple[tuple[bool, SuggestionKind, str], ...] = ((False, "holes", ""), (True, "spigot", " round a journal"))
    for round_it, kind, where in ways:
        holes = _holes(pair, [p for p, yes in zip(planes, pivoted, strict=True) if yes == round_it], scene, tolerance)
        if len(holes.radii) >= 2:
            text = f"{len(holes.radii)} aligned empty holes{where}"
            out.append(_hint(pair, kind, text, holes.axes[0], holes.places.mean(axis=0)))
            return out
    largest = planes[0]
    flat = all(patch.kind == "plane" and abs(float(patch.axis @ largest.axis)) > UPRIGHT_COSINE for patch in patches)
    # no axis is read from a contact of less than ten by ten contact tolerances
    if flat and sum(patch.area for patch in planes) >= 100.0 * tolerance**2:
        out += _axis(pair, planes, scene, tolerance)
    return out


def _hint(pair: Pair, kind: SuggestionKind, evidence: str, axis: Array, point: Array) -> Suggestion:
    """A suggestion with the canonical sign of the axis; that of a pocket points out of it."""
    turned = axis if kind == "pocket" else canonical_sign(axis) * axis
    return Suggestion(pair, kind, evidence, np.asarray(freeze(turned + 0.0)), np.asarray(freeze(point + 0.0)))


def _holes(pair: Pair, planes: list[Patch], scene: _Scene, tolerance: float) -> Holes:
    """Aligned holes with nothing in them, across these planes."""
    holes = aligned_holes(scene.cylinders(pair[0]), scene.cylinders(pair[1]), planes, tolerance)
    if not len(holes.radii):
        return holes
    empty = ~occupied(holes, scene.beside(pair), tolerance)
    return Holes(holes.axes[empty], holes.places[empty], holes.radii[empty])


def _pivoted(plane: Patch, patches: list[Patch], tolerance: float) -> bool:
    """Whether the parts share one journal that stands on the plane: they may be meant to turn. Two journals side
    by side are dowels."""
    upright = [p for p in patches if p.kind == "cylinder" and abs(float(p.axis @ plane.axis)) > 1 - WALL_COSINE]
    if not upright:
        return False
    offset = np.array([p.point for p in upright]) - upright[0].point
    across = offset - (offset @ plane.axis)[:, None] * plane.axis
    return bool(np.linalg.norm(across, axis=1).max() <= tolerance)


def _pressed(pair: Pair, firm: list[Patch]) -> list[Suggestion]:
    """A shaft that is larger than its bore, by no more than can be pressed at any of their round patches."""
    tight = [patch for patch in firm if patch.kind == "cylinder" and patch.fit == "interference"]
    if not tight or any(beyond_press(patch) for patch in firm):
        return []
    patch = max(tight, key=lambda patch: patch.area)
    size = f"{-2e3 * patch.gap:.3g} mm in diameter {2e3 * min(patch.radii):.4g} mm"
    return [_hint(pair, "pressed", f"pressed together by {size}", patch.axis, patch.point)]


def _pocket(pair: Pair, firm: list[Patch]) -> list[Suggestion]:
    """Faces that let one part leave the other in a single direction: a floor, and flat walls all round. Round
    walls alone would let it turn."""
    flat = sorted((patch for patch in firm if patch.kind == "plane"), key=lambda patch: -patch.area)
    round_ = [patch for patch in firm if patch.kind != "plane"]
    if not flat or any(patch.kind != "cylinder" for patch in round_):
        return []
    normals = np.array([patch.axis for patch in flat])
    axes = np.array([patch.axis for patch in round_]).reshape(-1, 3)
    for floor in flat:
        along = normals @ floor.axis
        walls = normals[np.abs(along) < WALL_COSINE]
        if along.min() <= -WALL_COSINE or (np.abs(axes @ floor.axis) <= 1 - WALL_COSINE).any():
            continue
        # walls with no gap of half a turn between them leave no way out sideways
        if len(walls) and widest_gap(walls, floor.axis) < (math.pi - 0.05):
            text = "in a pocket that it can leave one way only"
            return [_hint(pair, "pocket", text, floor.axis, floor.point)]
    return []


def _axis(pair: Pair, planes: list[Patch], scene: _Scene, tolerance: float) -> list[Suggestion]:
    """The one axis about which both parts have rims at their contact, or patterns of holes about one centre."""
    near, normal = AXES_COAXIAL * tolerance, planes[0].axis
    coaxial: list[tuple[Array, float, float]] = []
    for patch in planes:
        rims = scene.rims(pair[0], patch.surfaces[0])
        others = scene.rims(pair[1], patch.surfaces[1]) if rims else []
        for centre, radius in rims:
            for other, size in others:
                if aside(centre, other, normal) <= near:
                    coaxial.append((centre, radius, size))
    if coaxial:
        centre, radius, size = max(coaxial, key=lambda rim: rim[1:])
        if any(aside(centre, other, normal) > tolerance for other, _, _ in coaxial):
            return []
        # a shaft that stands there has contacts of its own, which say more
        rim = Holes(normal[None], centre[None], np.array([max(radius, size)]))
        if occupied(rim, scene.beside(pair), tolerance).any():
            return []
        text = f"coaxial rims of diameter {2e3 * radius:.4g} and {2e3 * size:.4g} mm"
        return [_hint(pair, "rim", text, normal, centre)]
    first, second = (_bolt_circle(scene.cylinders(name), planes[0], tolerance) for name in pair)
    if first is None or second is None or np.linalg.norm(first[0] - second[0]) > near:
        return []
    text = f"bolt circles of {first[1]} and {second[1]} holes about one centre"
    return [_hint(pair, "bolt circle", text, normal, first[0])]


def _bolt_circle(side: Cylinders, plane: Patch, tolerance: float) -> tuple[Array, int] | None:
    """Centre on the plane, and number, of the largest set of equal holes that are evenly spaced on a circle."""
    upright = (
        (side.sides < 0) & (np.abs(side.axes @ plane.axis) > UPRIGHT_COSINE) if len(side.radii) else np.zeros(0, bool)
    )
    holes = side.chosen(upright)
    height = (holes.points - plane.point) @ plane.axis
    places = holes.points - height[:, None] * plane.axis
    near = np.abs(height) <= holes.halves + tolerance
    best: tuple[Array, int] | None = None
    for radius in np.unique(holes.radii[near]):
        alike = places[near & (np.abs(holes.radii - radius) <= PATTERN_ALIKE * radius)]
        if len(alike) < 3 or (best is not None and len(alike) <= best[1]):
            continue
        centre = alike.mean(axis=0)
        arms = np.linalg.norm(alike - centre, axis=1)
        apart = 2 * arms.mean() * math.sin(math.pi / len(alike))
        steps = np.sort(np.linalg.norm(alike[:, None] - alike[None], axis=2), axis=1)[:, 1]
        if np.ptp(arms) <= PATTERN_ALIKE * arms.mean() and np.abs(steps - apart).max() <= PATTERN_ALIKE * apart:
            best = (centre, len(alike))
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
