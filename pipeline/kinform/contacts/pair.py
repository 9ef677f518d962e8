"""All that one pair of parts has to say: its patches, and its overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.contacts.constants import MATING_REACH, PARALLEL_SINE, TOUCH
from kinform.contacts.higher.beside_patches import holding_touches
from kinform.contacts.higher.edges import edge_contacts
from kinform.contacts.higher.points_and_lines import higher_pairs, pins_in_slots, tubes_for_facets
from kinform.contacts.higher.profiles import profile_contacts
from kinform.contacts.higher.rims import rim_contacts, seats
from kinform.contacts.higher.rollers import lines_beside_flanges
from kinform.contacts.higher.sharp import convex_edges
from kinform.contacts.higher.unknown import unknown_touches
from kinform.contacts.mating.analytic import analytic_mates
from kinform.contacts.mating.coarse import rounded
from kinform.contacts.mating.enclosing import enclosing_patches
from kinform.contacts.mating.freeform import freeform_patches
from kinform.contacts.mating.one_sided import one_sided_mates, without_continuations
from kinform.contacts.mating.patches import in_world, mated_patches_of
from kinform.contacts.mating.threads import threaded_patches
from kinform.contacts.overlap.interference import find_interference
from kinform.contacts.overlap.solids import SolidStore
from kinform.contacts.search.apart import far_apart
from kinform.contacts.search.pair_view import PairView, pair_view
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.meshes.mesh_index import MeshStore
from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, freeze
from kinform.model.assembly import Part
from kinform.model.contacts import Interference, Patch
from kinform.model.surfaces import MeshSurfaces
from kinform.model.tolerances import Tolerances


@dataclass(frozen=True, eq=False)
class PairContacts:
    """Contacts of one pair, in the world."""

    patches: tuple[Patch, ...]
    interference: Interference | None
    possible_overlap: Interference | None


@dataclass(frozen=True, eq=False)
class Mated:
    """A pair, and the patches of its surfaces that mate."""

    pair: PairView
    X_WF: Array
    """(4, 4) pose of the frame of the pair in the world."""
    reach: float
    """m that surfaces that mate may be apart."""
    overlap: Flags
    """(s, t) near surfaces of either part that come within the tolerance."""
    patches: list[Patch]
    """In the frame of the pair."""


def mated_pairs(
    wanted: Sequence[tuple[tuple[Part, Part], float]],
    surfaces: dict[str, MeshSurfaces],
    store: MeshStore,
    tolerances: Tolerances,
) -> list[Mated | None]:
    """What mates of several pairs of meshed parts (sorted by name), within a tolerance (m) each, at once; None of a
    pair of which no facets are near each other. `surfaces` by mesh digest. What comes of a pair does not depend on
    the others."""
    views = [pair_view(parts, surfaces, store, tolerance, tolerances) for parts, tolerance in wanted]
    met = [view for view in views if view is not None]
    overlaps = [pair.overlap(MATING_REACH * pair.tolerance) for pair, _, _ in met]
    mates = [
        analytic_mates(pair, reach) + one_sided_mates(pair, overlap)
        for (pair, _, reach), overlap in zip(met, overlaps, strict=True)
    ]
    patches = mated_patches_of([(pair, own) for (pair, _, _), own in zip(met, mates, strict=True)])
    asked = [k for k, own in enumerate(patches) if not own]
    apart = {k for k, far in zip(asked, far_apart([met[k][0] for k in asked]), strict=True) if far}
    found = iter(
        [
            Mated(replace(pair, apart=True) if k in apart else pair, X_WF, reach, flags, own)
            for k, ((pair, X_WF, reach), flags, own) in enumerate(zip(met, overlaps, patches, strict=True))
        ]
    )
    return [None if view is None else next(found) for view in views]


def touching(mates: Mated) -> list[Patch]:
    """All patches of a pair of which it is known what mates, in its frame, but narrow ones and unknown touches."""
    pair, reach, overlap, mated = mates.pair, mates.reach, mates.overlap, mates.patches
    if pair.apart and not rounded(pair, [], reach):
        return []
    patches = [patch for patch in mated if not patch.narrow]
    screwed = threaded_patches(pair, overlap)
    patches += freeform_patches(pair, overlap)
    patches = [*_beside(patches, screwed), *screwed]
    patches = rounded(pair, patches, reach)
    patches = without_continuations(pair, patches)
    patches = tubes_for_facets(pair, patches)
    patches = _with_higher(pair, patches)
    if not any(patch.kind in ("line", "point") for patch in patches):
        patches += lines_beside_flanges(pair, patches)
    if not any(patch.kind in ("line", "point") for patch in patches):
        patches += pins_in_slots(pair, patches)
    if any(_firm(pair, patch) for patch in patches):
        patches += seats(pair, patches)
    patches += holding_touches(pair, patches)
    patches += enclosing_patches(pair, patches)
    alone = all(_strip(pair, patch) for patch in patches)
    patches = [_of_scattered(pair, patch, alone) for patch in patches]
    patches.sort(key=_place_in_list)
    return patches


def pair_contacts(mates: Mated, patches: list[Patch], crosses: bool | None, solids: SolidStore) -> PairContacts:
    """Contacts of a pair, of its mates and all patches that are `touching`, in the world; `crosses` is whether
    their boundaries cross."""
    pair, X_WF, mated = mates.pair, mates.X_WF, mates.patches
    interference, possible = find_interference(pair, patches, solids, crosses)
    if not patches and interference is None and not pair.apart:
        patches = unknown_touches(pair)
    # Share of the contact of a pair below which overlaps narrower than such lenses say nothing: corners cross by
    # chance. Of 38 kinds of clean random assemblies one was in doubt without this (1e-4); the shoulder that it is for
    # has 3e-2.
    least = 5e-4 * sum(patch.area for patch in patches)
    if patches:
        narrow = [patch for patch in mated if patch.narrow and patch.area >= least]
        patches = sorted([*patches, *narrow], key=_place_in_list)
    placed = tuple(in_world(patch, X_WF) for patch in patches)
    return PairContacts(placed, _placed(interference, X_WF), _placed(possible, X_WF))


def _placed(overlap: Interference | None, X_WF: Array) -> Interference | None:
    """An overlap in the world."""
    if overlap is None:
        return None
    return replace(overlap, place=np.asarray(freeze(X_WF[:3, :3] @ overlap.place + X_WF[:3, 3])))


def _place_in_list(patch: Patch) -> tuple[tuple[int, int], bool, str]:
    return patch.surfaces, patch.one_sided, patch.kind


def _beside(patches: list[Patch], screwed: list[Patch]) -> list[Patch]:
    """The patches without those of facets that lie on a thread which mates: its flanks say what they say, better."""
    if not screwed:
        return patches
    flanks = [{patch.surfaces[k] for patch in screwed} for k in (0, 1)]
    loose = [patch.one_sided or patch.kind == "other" for patch in patches]
    on = [patch.surfaces[0] in flanks[0] or patch.surfaces[1] in flanks[1] for patch in patches]
    return [patch for patch, drop, thread in zip(patches, loose, on, strict=True) if not (drop and thread)]


def _with_higher(pair: PairView, patches: list[Patch]) -> list[Patch]:
    """The patches with points and lines of contact, where those are to be looked for.

    Beside a real patch, surfaces that merely pass close to each other are many. Cams and teeth are looked for
    beside patches of facets, which say less than they do, beside planes across them, which leave them free, and
    beside single facets of the curves that happen to face each other.
    """
    firm = [patch for patch in patches if _firm(pair, patch)]
    along = firm[0].axis if firm else None
    if along is not None and not all(_across(patch, along) for patch in firm):
        return patches
    profiles, pieces = profile_contacts(pair, along)
    if not profiles:
        if patches:
            return patches
        return _touching(pair)
    rest = [patch for patch in patches if _across(patch, profiles[0].axis)]
    # facets that face each other well apart say nothing beside curves that touch
    least = max(patch.gap for patch in profiles) + TOUCH * pair.tolerance
    others = [patch for patch in patches if not (patch.one_sided or patch in rest or patch.gap > least)]
    if not all(i in pieces[0] and j in pieces[1] for i, j in (patch.surfaces for patch in others)):
        return patches
    return rest + profiles + ([] if rest else higher_pairs(pair, pieces))


def _touching(pair: PairView) -> list[Patch]:
    """Points and lines where nothing else touches."""
    touches = higher_pairs(pair)
    convex = convex_edges(pair)
    if convex is None:
        return touches
    met = frozenset(patch.surfaces for patch in touches)
    return touches + edge_contacts(pair, convex, met) + rim_contacts(pair, convex)


def _of_scattered(pair: PairView, patch: Patch, alone: bool) -> Patch:
    """The patch, where vertices of a mesh scatter: points and lines of contact are of facets, and of no known curves;
    facets that lie on a curved surface of the other part have no curve of their own, and may lean on it by as much as
    they scatter; so may planes, of which one facet alone would be exact; and a narrow plane, where narrow planes are
    all that touches (`alone`), may be a facet of a curve."""
    scatter = [part.surfaces.noise for part in pair.parts]
    if not any(
        noise > pair.tolerances.fit * part.index.mesh.size.span for noise, part in zip(scatter, pair.parts, strict=True)
    ):
        return patch
    if patch.kind in ("point", "line"):
        return replace(patch, one_sided=True, bends=False)
    if alone and patch.kind == "plane" and _strip(pair, patch):
        return replace(patch, kind="freeform")
    if patch.kind == "plane" or (patch.one_sided and patch.kind in ("cylinder", "cone", "sphere")):
        lean = max(scatter) / max(float(np.sqrt(patch.area)), TINY)
        (turn, shift), (tilt, offset) = patch.uncertainty, patch.mismatch
        return replace(patch, uncertainty=(max(turn, lean), shift), mismatch=(max(tilt, lean), offset))
    return patch


def _across(patch: Patch, along: Array) -> bool:
    """Whether it is of planes that leave motion across the direction `along` free."""
    return patch.kind == "plane" and float(np.linalg.norm(cross(patch.axis, along))) < PARALLEL_SINE


def _firm(pair: PairView, patch: Patch) -> bool:
    """Whether both its surfaces are known, and no facets of curves."""
    return not patch.one_sided and not _strip(pair, patch)


def _strip(pair: PairView, patch: Patch) -> bool:
    """Whether it is of planes of which one is so small a piece of its part that it may be a facet of a curve."""
    areas = [
        float(part.table.areas[k] / part.table.areas.sum()) for part, k in zip(pair.parts, patch.surfaces, strict=True)
    ]
    # Share of the area of a part below which a plane may be a facet of a curve. Chosen, not measured.
    return patch.kind == "plane" and min(areas) < 0.02
