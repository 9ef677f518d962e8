"""All that one pair of parts has to say: its patches, and its overlap."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kinform.contacts.higher.edges import edge_contacts
from kinform.contacts.higher.points_and_lines import higher_pairs, pins_in_slots
from kinform.contacts.higher.profiles import profile_contacts
from kinform.contacts.mating.coaxial import cone_mates, cylinder_mates
from kinform.contacts.mating.freeform import freeform_patches
from kinform.contacts.mating.mates import EDGE, Mate, box_overlap
from kinform.contacts.mating.onesided import one_sided_mates, without_continuations
from kinform.contacts.mating.patches import mated_patches, placed_in_world
from kinform.contacts.mating.planes import plane_mates
from kinform.contacts.mating.spheres import sphere_mates
from kinform.contacts.mating.threads import threaded_patches
from kinform.contacts.overlap.interference import find_interference
from kinform.contacts.overlap.solids import SolidStore
from kinform.contacts.search.placed import NearSurfaces, PlacedPart, facing, near_surfaces, place
from kinform.foundation.meshes.index import MeshStore
from kinform.model.arrays import Array, freeze
from kinform.model.assembly import Part
from kinform.model.contacts import Interference, Patch
from kinform.model.surfaces import MeshSurfaces
from kinform.model.tolerances import Tolerances

__all__ = ["PairContacts", "pair_contacts"]


_STRIP = 0.02
"""Share of the area of a part below which a surface may be a facet of a curve."""


@dataclass(frozen=True, eq=False)
class PairContacts:
    """Contacts of one pair, in the world."""

    patches: tuple[Patch, ...]
    interference: Interference | None


def pair_contacts(
    first: Part,
    second: Part,
    surfaces: dict[str, MeshSurfaces],
    store: MeshStore,
    solids: SolidStore,
    tolerance: float,
    tolerances: Tolerances,
) -> PairContacts:
    """Contacts between two meshed parts (first < second by name), within `tolerance` (m)."""
    assert first.mesh is not None
    assert second.mesh is not None
    home = first if len(first.mesh.faces) >= len(second.mesh.faces) else second
    a, b = (
        place(part, store.index(mesh), surfaces[mesh.digest], None if part is home else _inverse(home.X_WP) @ part.X_WP)
        for part, mesh in ((first, first.mesh), (second, second.mesh))
    )
    reach = _reach(a, b, tolerance)
    low, high = np.maximum(a.low, b.low) - reach, np.minimum(a.high, b.high) + reach
    if (low > high).any():
        return PairContacts((), None)
    margin = max(a.table.slack, b.table.slack)
    a, b = facing(a, b, low - margin, high + margin, reach + margin)
    near = (near_surfaces(a, low, high), near_surfaces(b, low, high))
    mates = _mates(near, reach, tolerance, tolerances)
    overlap = box_overlap(*near, EDGE * tolerance)
    mates += one_sided_mates(a, b, near, overlap, tolerance, tolerances)
    patches = mated_patches(a, b, near, mates, tolerance, tolerances)
    screwed = threaded_patches(a, b, near, overlap, tolerance, tolerances)
    patches += freeform_patches(a, b, near, overlap, tolerance, tolerances)
    patches = [*_beside(patches, screwed), *screwed]
    patches = without_continuations(patches, a, b)
    patches = _with_higher(a, b, near, patches, tolerance, tolerances)
    if not any(patch.kind in ("line", "point") for patch in patches):
        patches += pins_in_slots(a, b, near, patches, tolerance, tolerances)
    patches.sort(key=lambda patch: (patch.surfaces, patch.one_sided, patch.kind))
    found = find_interference(a, b, patches, solids, tolerance)
    if found is not None:
        at = home.X_WP[:3, :3] @ found.place + home.X_WP[:3, 3]
        found = replace(found, place=np.asarray(freeze(at)))
    return PairContacts(tuple(placed_in_world(patch, home.X_WP) for patch in patches), found)


def _beside(patches: list[Patch], screwed: list[Patch]) -> list[Patch]:
    """The patches without those of facets that lie on a thread which mates: its flanks say what they say, better."""
    if not screwed:
        return patches
    own = [{patch.surfaces[k] for patch in screwed} for k in (0, 1)]
    loose = [patch.one_sided or patch.kind == "other" for patch in patches]
    on = [patch.surfaces[0] in own[0] or patch.surfaces[1] in own[1] for patch in patches]
    return [patch for patch, drop, thread in zip(patches, loose, on, strict=True) if not (drop and thread)]


def _with_higher(
    a: PlacedPart,
    b: PlacedPart,
    near: tuple[NearSurfaces, NearSurfaces],
    patches: list[Patch],
    tolerance: float,
    tolerances: Tolerances,
) -> list[Patch]:
    """The patches with points and lines of contact, where those are to be looked for.

    Beside a real patch, surfaces that merely pass close to each other are many. Cams and teeth are looked for
    beside patches of facets, which say less than they do, beside planes across them, which leave them free, and
    beside single facets of the curves that happen to face each other.
    """
    firm = [patch for patch in patches if not patch.one_sided and not _strip(patch, a, b)]
    along = firm[0].axis if firm else None
    if along is not None and not all(_across(patch, along) for patch in firm):
        return patches
    profiles, pieces = profile_contacts(a, b, near, tolerance, tolerances, along)
    if not profiles:
        if patches:
            return patches
        touches = higher_pairs(a, b, near, tolerance, tolerances)
        known = frozenset(patch.surfaces for patch in touches)
        return touches + edge_contacts(a, b, near, tolerance, tolerances, known)
    rest = [patch for patch in patches if _across(patch, profiles[0].axis)]
    # facets that face each other well apart say nothing beside curves that touch
    least = max(patch.gap for patch in profiles) + 0.12 * tolerance
    others = [patch for patch in patches if not (patch.one_sided or patch in rest or patch.gap > least)]
    if not all(i in pieces[0] and j in pieces[1] for i, j in (patch.surfaces for patch in others)):
        return patches
    return rest + profiles + ([] if rest else higher_pairs(a, b, near, tolerance, tolerances, pieces))


def _across(patch: Patch, along: Array) -> bool:
    """Whether it is of planes that leave motion across the direction `along` free."""
    return patch.kind == "plane" and float(np.linalg.norm(np.cross(patch.axis, along))) < 1e-3


def _strip(patch: Patch, a: PlacedPart, b: PlacedPart) -> bool:
    """Whether it is of planes of which one is so small a piece of its part that it may be a facet of a curve."""
    areas = [
        float(part.table.areas[k] / part.table.areas.sum()) for part, k in zip((a, b), patch.surfaces, strict=True)
    ]
    return patch.kind == "plane" and min(areas) < _STRIP


def _inverse(X: Array) -> Array:
    inverse = np.eye(4)
    inverse[:3, :3] = X[:3, :3].T
    inverse[:3, 3] = -X[:3, :3].T @ X[:3, 3]
    return inverse


def _reach(a: PlacedPart, b: PlacedPart, tolerance: float) -> float:
    """How far apart mating surfaces of the two parts may be: clearances grow with the radius."""
    return EDGE * max(tolerance, 0.03 * min(a.table.radius, b.table.radius))


def _mates(
    near: tuple[NearSurfaces, NearSurfaces], reach: float, tolerance: float, tolerances: Tolerances
) -> list[Mate]:
    overlap = box_overlap(*near, reach)
    mates: list[Mate] = []
    for kind in (plane_mates, cylinder_mates, cone_mates, sphere_mates):
        mates += kind(*near, overlap, tolerance, tolerances)
    return mates
