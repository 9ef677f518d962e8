"""Which polygon belongs to which surface.

First whole smooth pieces are tried at once, because most of them are one surface; what is left is searched
from seeds. Larger regions win; what nothing explains is a plane where it stands alone, else freeform.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.foundation.graphs.components import components
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import distinct, quantile
from kinform.surfaces.kinds.cone import Cone
from kinform.surfaces.kinds.cylinder import Cylinder
from kinform.surfaces.kinds.kind import Batch, Kind
from kinform.surfaces.kinds.sphere import Sphere
from kinform.surfaces.kinds.torus import Torus
from kinform.surfaces.polygons.curvature import Curvature, Links, continues, curvature, links
from kinform.surfaces.polygons.patchwork import Patchwork, Scale
from kinform.surfaces.regions.conformity import Ground
from kinform.surfaces.regions.growth import Found, absorb, pursue, whole

__all__ = ["CURVED", "Partition", "Region", "partition"]

CURVED: tuple[Kind, ...] = (Cylinder(), Cone(), Sphere(), Torus())
"""The curved kinds, simplest first. A new kind is one more entry."""

ROUNDS = 8
LEAST_BLEND = 8
"""Polygons of a piece that may bend both ways."""

WORTH = 2e-3
"""Share of the mesh's area that a round of searching must explain for another one to follow."""

BROAD = 2e-2
"""Share of the mesh's area above which a polygon is a plane of its own, whatever is beside it."""

GRAIN = 1e-4
"""Share of the mesh's area that the two polygons at a seed have at least: finer detail that is no piece of its
own stays freeform."""


@dataclass(frozen=True, eq=False)
class Region:
    """Polygons on one curved surface."""

    kind: Kind
    polygons: Ints
    params: Array
    """(8,)"""
    side: int
    tolerance: float


@dataclass(frozen=True, eq=False)
class Partition:
    """Every polygon in one curved region, one plane, or one freeform patch."""

    regions: tuple[Region, ...]
    owner: Ints
    """(P,) index into regions, or -1."""
    planes: Ints
    """(P,) number of the plane of each polygon, or -1."""
    freeform: Ints
    """(P,) number of the freeform patch of each polygon, or -1."""


def _pieces(work: Patchwork, link: Links, joined: Flags, free: Flags) -> tuple[Batch, Ints]:
    """Pieces of polygons that convex, and that concave, links among `joined` hold together, with their sides."""
    regions, polygons, sides = [], [], []
    count: int = 0
    sign = work.sign[link.edge]
    inside = joined & free[link.a] & free[link.b]
    for side in (1, -1):
        use = inside & (sign * side >= 0)
        label = components(link.a[use], link.b[use], work.count)
        turning = np.zeros(work.count, bool)
        mark = use & (sign == side)
        turning[link.a[mark]] = turning[link.b[mark]] = True
        present = np.flatnonzero(free & (np.bincount(label, turning, work.count)[label] >= 3))
        names, number = np.unique(label[present], return_inverse=True)
        regions.append(number + count)
        polygons.append(present)
        sides.append(np.full(len(names), side))
        count += len(names)
    return _sorted(work, np.concatenate(regions), np.concatenate(polygons), count), np.concatenate(sides)


def _blends(work: Patchwork, link: Links, joined: Flags, bent: Curvature, free: Flags) -> tuple[Batch, Ints]:
    """Pieces whose links may bend either way, with the side to which the stronger curvature bends."""
    use = joined & free[link.a] & free[link.b]
    label = components(link.a[use], link.b[use], work.count)
    size = np.bincount(label[free], minlength=work.count)
    present = np.flatnonzero(free & (size[label] >= LEAST_BLEND))
    names, number = np.unique(label[present], return_inverse=True)
    lean = np.bincount(number, work.area[present] * np.sign(bent.strong[present]), len(names))
    return _sorted(work, number, present, len(names)), np.where(lean >= 0, 1, -1).astype(np.int64)


def _sorted(work: Patchwork, region: Ints, polygon: Ints, count: int) -> Batch:
    order = np.lexsort((polygon, region))
    return Batch(work, region[order], polygon[order], count)


def _choose(found: list[Found], work: Patchwork, free: Flags) -> list[Region]:
    """Larger regions first, each without the polygons that were taken before it."""
    entries = []
    for order, result in enumerate(found):
        starts = np.searchsorted(result.batch.region, np.arange(result.batch.count + 1))
        for number in np.flatnonzero(np.diff(starts)):
            polygons = result.batch.polygon[starts[number] : starts[number + 1]]
            score = len(polygons) / result.kind.handicap
            entries.append((-score, order, int(polygons[0]), int(number), polygons))
    entries.sort(key=lambda entry: entry[:4])
    taken = ~free
    chosen = []
    for _, order, _, which, polygons in entries:
        result = found[order]
        fresh = polygons[~taken[polygons]]
        if len(fresh) < max(result.kind.least, 0.9 * len(polygons)):
            continue
        taken[fresh] = True
        chosen.append(
            Region(
                result.kind,
                fresh,
                result.params[which],
                int(result.side[which]),
                float(result.tolerance[which]),
            )
        )
    return chosen


def _seeds(ground: Ground, tried: Ints, side: int) -> Ints:
    """Smooth edges to start from: the longest in their surroundings, not used before."""
    work = ground.patchwork
    edges = np.flatnonzero(work.smooth)
    edges = edges[ground.free[work.a[edges]] & ground.free[work.b[edges]]]
    usable = edges[work.sign[edges] * side >= 0]
    start = usable[(work.sign[usable] == side) & (tried[usable] == 0)]
    rank = np.full(len(work.a), -1)
    rank[start[np.argsort(work.length[start], kind="stable")]] = np.arange(len(start))
    best = np.full(work.count, -1)
    np.maximum.at(best, work.a[usable], rank[usable])
    np.maximum.at(best, work.b[usable], rank[usable])
    reach = np.maximum(best[work.a[usable]], best[work.b[usable]])
    wider = best.copy()
    np.maximum.at(wider, work.a[usable], reach)
    np.maximum.at(wider, work.b[usable], reach)
    foremost: Ints = start[rank[start] >= np.minimum(wider[work.a[start]], wider[work.b[start]])]
    return foremost


def _around(ground: Ground, seeds: Ints, side: Ints, straightness: float) -> Batch:
    """Both polygons of each seed and their neighbours across edges along the seed (all, when 0)."""
    work = ground.patchwork
    numbers = np.arange(len(seeds))
    polygon = np.r_[work.a[seeds], work.b[seeds]]
    region = np.r_[numbers, numbers]
    owner, edge = ground.links.expand(polygon)
    target = work.other(edge, polygon[owner])
    direction = work.vertices[work.ends[:, 1]] - work.vertices[work.ends[:, 0]]
    cosine = np.abs(np.einsum("ij,ij->i", direction[edge], direction[seeds[region[owner]]]))
    near = cosine >= straightness * work.length[edge] * work.length[seeds[region[owner]]]
    keep = near & ground.free[target] & (work.sign[edge] * side[region[owner]] >= 0)
    key = distinct(np.r_[region, region[owner][keep]] * np.int64(work.count) + np.r_[polygon, target[keep]])
    return Batch(work, key // work.count, key % work.count, len(seeds))


STRAIGHT = {"cylinder": 0.985, "cone": 0.85, "sphere": 0.0}
SLACK = 0.2
"""What the ratio of curvatures at a seed may be beyond the range of a kind."""


def _search(ground: Ground, tried: Ints, bent: Curvature) -> list[Found]:
    """One round of hypotheses from seeds, of all kinds and both sides."""
    found: list[Found] = []
    work = ground.patchwork
    both = [_seeds(ground, tried, side) for side in (1, -1)]
    seeds = np.concatenate(both)
    if not len(seeds):
        return found
    side = np.repeat(np.array([1, -1]), [len(s) for s in both])
    tried[seeds] = 1
    ratio = np.minimum(bent.ratio[work.a[seeds]], bent.ratio[work.b[seeds]])
    other = np.maximum(bent.ratio[work.a[seeds]], bent.ratio[work.b[seeds]])
    for kind in (kind for kind in CURVED if not kind.saddle):
        suits = np.flatnonzero((ratio <= kind.bends[1] + SLACK) & (other >= kind.bends[0] - SLACK))
        batch = _around(ground, seeds[suits], side[suits], STRAIGHT[kind.name])
        batch = batch.select((batch.size >= kind.least)[batch.region])
        if len(batch.region):
            found.append(pursue(ground, kind, batch, side[suits]))
    return found


def partition(work: Patchwork, scale: Scale) -> Partition:
    """Assigns every polygon."""
    regions: list[Region] = []
    free = np.ones(work.count, bool)
    ground = Ground.of(work, scale, free)
    link = links(work, free)
    bent = curvature(work, link)
    like = link.alike & continues(work, bent, link)
    simple = tuple(kind for kind in CURVED if not kind.saddle)
    for kinds, joined, both in ((CURVED, like, True), (simple, link.alike, False)):
        pieces = _blends(work, link, joined, bent, free) if both else _pieces(work, link, joined, free)
        found = [absorb(ground, item) for item in _explained(ground, *pieces, bent, kinds)]
        _take(regions, _choose(found, work, free), free)
    tried = np.zeros(len(work.a), np.int64)
    total = work.area.sum()
    inner = work.b >= 0
    tried[inner] = work.area[work.a[inner]] + work.area[work.b[inner]] < GRAIN * total
    for _ in range(ROUNDS):
        chosen = _choose(_search(ground, tried, bent), work, free)
        _take(regions, chosen, free)
        if sum(work.area[item.polygons].sum() for item in chosen) < WORTH * total:
            break
    owner = np.full(work.count, -1)
    for number, item in enumerate(regions):
        owner[item.polygons] = number
    planes, freeform = _remainder(work, owner < 0)
    return Partition(tuple(regions), owner, planes, freeform)


def _explained(
    ground: Ground, batch: Batch, side: Ints, bent: Curvature, kinds: tuple[Kind, ...]
) -> list[Found]:  # fmt: skip
    """Each kind on the pieces that bend as it does; what one kind explains whole, the later are not tried on."""
    found = []
    middle = quantile(batch.region, bent.ratio[batch.polygon], batch.count, 0.5)
    for kind in kinds:
        if not len(batch.region):
            break
        low, high = kind.bends
        suits = (middle >= low) & (middle <= high) & (batch.size >= kind.least)
        found.append(whole(ground, kind, batch.select(suits[batch.region]), side))
        explained = found[-1].batch.size >= 0.98 * batch.size
        batch = batch.select(~explained[batch.region])
    return found


def _take(regions: list[Region], chosen: list[Region], free: Flags) -> None:
    for item in chosen:
        free[item.polygons] = False
    regions.extend(chosen)


def _remainder(work: Patchwork, left: Flags) -> tuple[Ints, Ints]:
    """Numbers of the planes and of the freeform patches among what no curved surface explains."""
    edges = np.flatnonzero(work.smooth)
    edges = edges[left[work.a[edges]] & left[work.b[edges]]]
    a, b = work.a[edges], work.b[edges]
    neighbours = np.bincount(np.r_[a, b], minlength=work.count)
    nearby = np.bincount(np.r_[a, b], np.r_[work.area[b], work.area[a]], work.count)
    dominant = (work.area > 3 * nearby / np.maximum(neighbours, 1)) | (work.area > BROAD * work.area.sum())
    label = components(a, b, work.count)
    size = np.bincount(label[left], minlength=work.count)[label]
    loose = left & (size >= 4) & (neighbours >= 1) & ~dominant
    planes = np.full(work.count, -1)
    planes[left & ~loose] = np.arange(int((left & ~loose).sum()))
    inside = loose[a] & loose[b]
    patch = components(a[inside], b[inside], work.count)
    freeform = np.full(work.count, -1)
    _, freeform[loose] = np.unique(patch[loose], return_inverse=True)
    return planes, freeform
