"""Facets that enclose the other part, and of which no patch says anything.

A shaft whose vertices scatter is no cylinder any more, and its bore none; that no surface of one mates with one of the
other does not mean that nothing holds them. So facets of either part that face the other within the tolerance are
looked at once more. Where they oppose, in both senses, a motion that all patches leave, what they say is a patch of
kind "freeform": too coarse to decide, and enough to make the answer doubtful. What opposes a motion in one sense only
is a stop, and says nothing of what holds.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.contacts.constants import FACING_LEAST, MATING_REACH, PATCH_AREA, TOUCH, TOUCHING
from kinform.contacts.mating.constants import FREEFORM_ANGLE
from kinform.contacts.mating.facing import may_face
from kinform.contacts.mating.patches import classify_fit
from kinform.contacts.mating.unread import MotionsLeft, motions_left, unread_surfaces
from kinform.contacts.search.pair_view import PairView, boxes_of
from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.vectors import dot
from kinform.foundation.constants import SLIVER_WIDTH
from kinform.foundation.meshes.box_pairs import meeting_in_slabs
from kinform.foundation.meshes.boxes import meeting_box, middles
from kinform.foundation.meshes.probes import Region
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.foundation.sorting import among, distinct, heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch

ENCLOSING_PROBES = 20_000
"""Middles of facets of either part that are looked at, of those that may be near what they face: as good as all. Where
they were 600 of 700, evenly by area, none need have been on a pin, and which were hung on the pose. Contacts of robots
(so100, dog, sigmaban2019) take as long as then."""
ENCLOSING_SAMPLES = 600
"""Of the middles that face the other part, as many as a patch is made of. Chosen, not measured."""
STRAY_SHARE = 0.02
"""Share of the area of all patches below which facets that do not touch hold nothing on their own: what joints are
derived from leaves as much out."""
ENCLOSING_SPEED = 0.3
"""Speed along its normal, as a share of that of its place, from which on a facet opposes a motion: 17° from sliding.
Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class _Near:
    """Middles of facets of either part that face the other part."""

    points: Array
    """(n, 3) half-way between the two (m)."""
    normals: Array
    """(n, 3) out of a."""
    faced: Array
    """(n, 3) the same of the facet that each faces, towards which it goes."""
    gaps: Array
    areas: Array
    """(n,) m² that each stands for."""
    surfaces: Ints
    """(n, 2) of a and of b."""

    def turned(self) -> _Near:
        """As the other part sees them."""
        return _Near(self.points, -self.normals, -self.faced, self.gaps, self.areas, self.surfaces[:, ::-1])

    def few(self, count: int) -> _Near:
        """At most so many of them, evenly by area."""
        chosen, areas = _evenly(self.areas, count)
        near = _Near(*(getattr(self, name)[chosen] for name in _Near.__dataclass_fields__))
        return replace(near, areas=areas)


def enclosing_patches(pair: PairView, patches: list[Patch]) -> list[Patch]:
    """What encloses one of the parts beside these patches, as one patch at most.

    Beside none there is nothing to doubt. Cams and teeth, which touch along lines, come near each other elsewhere too.
    """
    patches = _without_strays(patches, pair.tolerance)
    kinds = {patch.kind for patch in patches}
    if not kinds or ("line" in kinds and kinds <= set(TOUCHING)):
        return []
    unread = unread_surfaces(pair, patches, MATING_REACH * pair.tolerance)
    if not may_face(pair, unread):
        return []
    near = _near(pair, unread)
    if near is None or not _encloses(near, patches, pair.tolerance):
        return []
    return [_patch(pair, near.few(ENCLOSING_SAMPLES))]


def _without_strays(patches: list[Patch], tolerance: float) -> list[Patch]:
    """The patches without the small ones of facets that pass near a surface without touching it: alone, such a patch
    holds nothing, while with the facets beside it, or on the other side, it may be what encloses a part."""
    little = STRAY_SHARE * sum(patch.area for patch in patches)
    return [
        patch for patch in patches if not (patch.one_sided and patch.area < little and patch.gap > TOUCH * tolerance)
    ]


def _near(pair: PairView, unread: Flags) -> _Near | None:
    """Middles of facets that face a facet of the other part within the tolerance, of surfaces flagged in `unread`."""
    found = [_facing(pair, unread), _facing(pair.swapped, unread.T)]
    sides = [
        near.turned() if turned else near for near, turned in zip(found, (False, True), strict=True) if near is not None
    ]
    if not sides:
        return None
    return _Near(*(np.concatenate([getattr(s, name) for s in sides]) for name in _Near.__dataclass_fields__))


def _facing(view: PairView, unread: Flags) -> _Near | None:
    """Those of the first part."""
    (own, other), (a, b) = view.near, view.parts
    reach = MATING_REACH * view.tolerance
    rows_ = np.flatnonzero(unread.any(axis=1))
    columns = np.flatnonzero(unread.any(axis=0))
    low = other.lows[columns].min(axis=0) - reach
    high = other.highs[columns].max(axis=0) + reach
    facets = np.concatenate([own.facets[k] for k in rows_])
    of_row = np.repeat(rows_, [len(own.facets[k]) for k in rows_])
    if a.region.facets is not None:
        beside = among(facets, a.region.facets).nonzero()[0]
        facets, of_row = facets[beside], of_row[beside]
    points = middles(a.vertices.take(a.faces.take(facets, axis=0), axis=0))
    inside = np.flatnonzero(meeting_box(points, points, low, high))
    inside = inside[a.index.areas(facets[inside]) > 0.0]
    if not len(inside):
        return None
    points, normals, of_row = points[inside], a.normals(facets[inside]), of_row[inside]
    areas = a.index.areas(facets[inside])
    column = np.full(len(b.table.areas), -1)
    column[other.ids] = np.arange(len(other.ids))
    able, region = _can_hit(view, points, normals, reach, unread, of_row, column)
    if not len(able):
        return None
    some, weight = _evenly(areas[able], ENCLOSING_PROBES)
    able = able[some]
    points, normals, of_row = points[able], normals[able], of_row[able]
    hits = region.cast(b.to_part(points), b.turn_to_part(normals), np.full(len(points), reach))
    of_column = column[b.surfaces.labels[hits.facet]]
    wanted = (hits.facing < -FACING_LEAST) & (of_column >= 0)
    wanted[wanted] = unread[of_row[hits.probe[wanted]], of_column[wanted]]
    kept = np.flatnonzero(wanted)
    if not len(kept):
        return None
    kept = kept[np.lexsort((hits.facet[kept], np.abs(hits.along[kept]), hits.probe[kept]))]
    probe, first = np.unique(hits.probe[kept], return_index=True)
    along, row, col = hits.along[kept[first]], of_row[probe], of_column[kept[first]]
    return _Near(
        points[probe] + 0.5 * along[:, None] * normals[probe],
        normals[probe],
        -b.normals(hits.facet[kept[first]]),
        along,
        0.5 * weight[probe],
        np.column_stack([own.ids[row], other.ids[col]]),
    )


def _can_hit(
    view: PairView, points: Array, normals: Array, reach: float, unread: Flags, of_row: Ints, column: Ints
) -> tuple[Ints, Region]:
    """Which probes along the normals of the first part at these points (n, 3), `reach` (m) to either side, have a facet
    in their box that faces them, of those surfaces of the second part that are `unread` (s, t) beside the probe's, at
    place `of_row` (n,); and these facets: no others need to be cast. `column` (surfaces,): places of the second part's
    surfaces, −1 of those that are not near."""
    b = view.b
    facets = np.arange(len(b.faces)) if b.region.facets is None else b.region.facets
    of_column = column.take(b.surfaces.labels.take(facets))
    asked = of_column >= 0
    asked &= np.logical_or.reduce(unread[distinct(of_row)], axis=0).take(of_column)
    facets, of_column = facets[asked], of_column[asked]
    half = reach * (np.abs(normals) + 2.0 * SLIVER_WIDTH)
    met = meeting_in_slabs((points - half, points + half), boxes_of(b, facets))
    if met is None:
        return np.arange(len(points)), b.region
    probes, hit = met
    facing = dot(normals.take(probes, axis=0), b.normals(facets.take(hit)))
    kept = unread[of_row.take(probes), of_column.take(hit)]
    kept &= facing < SOLVED - FACING_LEAST
    return distinct(probes[kept]), Region(b.index, facets[distinct(hit[kept])])


def _evenly(areas: Array, count: int) -> tuple[Ints, Array]:
    """At most `count` of the facets of these areas (n,), evenly by area, and the area that each stands for; all where
    they are no more."""
    if len(areas) <= count:
        return np.arange(len(areas)), areas
    reached = np.cumsum(areas)
    shares = (np.arange(count) + 0.5) / count * reached[-1]
    # those at which a share is reached
    passed = shares.searchsorted(reached, side="right")
    passed[-1] = count
    chosen = heads(passed).nonzero()[0]
    chosen = chosen if passed[0] else chosen[1:]
    ends = np.concatenate([[0], reached.searchsorted(reached.take(chosen), side="right"), [len(areas)]])
    following = np.repeat(np.arange(len(ends) - 1).clip(0, len(chosen) - 1), np.diff(ends))
    return chosen, np.bincount(following, areas, len(chosen)).astype(np.float64)


def _encloses(near: _Near, patches: list[Patch], tolerance: float) -> bool:
    """Whether they oppose a motion that the patches leave, in both senses, with areas that are no stray touch."""
    left = motions_left(patches, Frame.of(np.concatenate([near.points, *(patch.points for patch in patches)])))
    if not len(left) or _opens(near, left):
        return False
    velocities = left.velocities(near.points)
    turning = velocities[:, len(left.slides) :]
    turning /= float(np.sqrt((turning**2).sum(axis=2)).max(initial=0.0)) or 1.0
    # two facets that face each other oppose what both oppose: a round pin slides along a wall
    own, other = ((velocities * normals[:, None]).sum(axis=2) for normals in (near.normals, near.faced))
    _, _, motions = np.linalg.svd(np.sqrt(near.areas)[:, None] * (own + other), full_matrices=False)
    for motion in motions:
        along = np.stack([own @ motion, other @ motion])
        way = np.sqrt(((velocities * motion[:, None]).sum(axis=1) ** 2).sum(axis=1))
        large = np.abs(along).min(axis=0) > np.maximum(ENCLOSING_SPEED * way, SINGLE)
        senses = [float(near.areas[large & (along * sense > 0.0).all(axis=0)].sum()) for sense in (1.0, -1.0)]
        if min(senses) >= PATCH_AREA * tolerance**2:
            return True
    return False


def _opens(near: _Near, left: MotionsLeft) -> bool:
    """Whether some slide that is left takes the parts off each other everywhere: a wall, or two at a corner, enclose
    nothing."""
    slides = left.slides[:, 3:]
    mean = near.areas @ near.normals / near.areas.sum()
    away = slides.T @ (slides @ mean)
    if np.linalg.norm(away) < ENCLOSING_SPEED:
        return False
    along = near.normals @ (away / np.linalg.norm(away))
    # Speed up to which a facet may be approached by a translation that separates all others: 11.5° from sliding.
    # Chosen, not measured.
    against = float(near.areas[along < -0.2].sum())
    # 2 % of the area may be approached faster
    return against <= 0.02 * float(near.areas.sum())


def _patch(pair: PairView, near: _Near) -> Patch:
    """What encloses, as one patch, of the two surfaces that face each other most."""
    keys, number = np.unique(near.surfaces, axis=0, return_inverse=True)
    most = keys[int(np.argmax(np.bincount(number.ravel(), near.areas)))]
    chord = float(sum(part.table.slacks[k] for part, k in zip(pair.parts, most, strict=True)))
    area = float(near.areas.sum())
    return Patch(
        parts=pair.names,
        surfaces=(int(most[0]), int(most[1])),
        kind="freeform",
        one_sided=True,
        points=near.points,
        normals=near.normals,
        gaps=near.gaps,
        weights=near.areas,
        area=area,
        gap=float(near.areas @ near.gaps / area),
        axis=np.zeros(3),
        point=near.areas @ near.points / area,
        radii=(0.0, 0.0),
        misalignment=0.0,
        offset=0.0,
        uncertainty=(FREEFORM_ANGLE, chord),
        chord=chord,
        fit=classify_fit(near.gaps, chord, 0.0, pair.tolerance),
    )
