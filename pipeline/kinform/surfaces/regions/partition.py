"""Which polygon belongs to which surface.

First whole smooth pieces are tried at once, because most of them are one surface; what is left is searched
from seeds. Larger regions win; what nothing explains is a plane where it stands alone, else freeform.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.graphs.components import components
from kinform.foundation.sorting import distinct, heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import quantile, renumbered, repeated
from kinform.surfaces.kinds.batch import Batch
from kinform.surfaces.kinds.cone import Cone
from kinform.surfaces.kinds.cylinder import Cylinder
from kinform.surfaces.kinds.kind import Kind
from kinform.surfaces.kinds.mixed import Mixed
from kinform.surfaces.kinds.sphere import Sphere
from kinform.surfaces.kinds.torus import Torus
from kinform.surfaces.polygons.curvature import SIMPLE_RATIO, Curvature, Links, bends_like, continues, curvature, links
from kinform.surfaces.polygons.noise import Scales
from kinform.surfaces.polygons.patchwork import Patchwork
from kinform.surfaces.regions.across import along
from kinform.surfaces.regions.chords import Rounds, decimated
from kinform.surfaces.regions.growth import Growth, absorb, pursue, whole
from kinform.surfaces.regions.territory import Territory

ROUNDS = 8
"""Most rounds of searching from seeds: each must explain something, and typical meshes need three. Chosen, not
measured."""
FRESH = 0.9
"""Least share of a region that no larger one has taken. Chosen, not measured."""
STRAIGHT = {"cylinder": 0.985, "cone": 0.85, "sphere": 0.0}
"""Cosine between a seed and the edges across which its surroundings lie, at least, for each kind."""
BEND_SLACK = 0.2
"""Amount by which the ratio of curvatures at a seed may leave the range of a kind: curvatures of coarse facets are
rough. Chosen, not measured."""
WORTH = 2e-3
"""Share of the area of the mesh that a round of searching must explain for another one to follow. Chosen, not
measured."""
GRAIN = 1e-4
"""Share of the mesh's area that the two polygons at a seed have at least: finer detail that is no piece of its
own stays freeform."""
BROAD = 2e-2
"""Share of the area of the mesh above which a polygon is a plane of its own, whatever is beside it. Chosen, not
measured."""
CHORD_FITS = (10.0, 100.0)
"""Fits, in multiples, to which closed rounds of strips are held once nothing else explains them. A shaft of 9 mm in a
decimated mesh of 78 mm has vertices 2 µm off its mean radius, where a fit is 1.6 µm."""


CYLINDER, CONE, TORUS = Cylinder(), Cone(), Torus()

CURVED: tuple[Kind, ...] = (CYLINDER, CONE, Sphere(), TORUS)
"""The curved kinds, simplest first. A new kind is one more entry."""

SIMPLE = tuple(kind for kind in CURVED if not kind.saddle)
"""Those that bend one way, or not at all."""


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
    planes: Ints
    """(P,) number of the plane of each polygon, or -1."""
    freeform: Ints
    """(P,) number of the freeform patch of each polygon, or -1."""


def partition(work: Patchwork, scales: Scales) -> Partition:
    """Assigns every polygon of one or more meshes; each mesh has the partition that it has alone."""
    regions: list[Region] = []
    territory = Territory.of(work, scales)
    link = links(work, territory.free)
    bent = curvature(work, link)
    like = link.alike & bends_like(bent, link)
    regions += _choose(_slender_tori(territory, link, like, bent), territory)
    like &= continues(work, bent, link)
    for kinds, both_ways in ((CURVED, True), (SIMPLE, False)):
        batch, side = _blends(territory, link, like, bent) if both_ways else _pieces(territory, link, link.alike)
        growths = [absorb(territory, growth) for growth in _whole_pieces(territory, batch, side, bent, kinds)]
        regions += _choose(growths, territory)
    tried = np.zeros(len(work.a), bool)
    of_edge = work.mesh[work.a]
    inner = work.b >= 0
    least = GRAIN * work.total[of_edge[inner]]
    tried[inner] = work.area[work.a[inner]] + work.area[work.b[inner]] < least
    last, asked = tried.copy(), np.zeros(len(work.a), bool)
    for _ in range(ROUNDS):
        before = tried.copy()
        chosen = _choose(_search(territory, tried, partial(_bends, work, bent)), territory)
        asked |= tried & ~before
        if not chosen:
            break
        regions += chosen
        tried |= (_gained(work, chosen) < WORTH * work.total)[of_edge]
    edges = territory.smooth
    ruled = _ruled(territory, edges.take((~last.take(edges) & (work.sign.take(edges) != 0)).nonzero()[0]))
    last[:] = True
    last[ruled] = False
    for number in range(1, ROUNDS):
        chosen = _choose(_search(territory, last, partial(_unasked, work, bent, asked)), territory)
        regions += chosen
        # two rounds at least: the longest generators come first, and hide those beside them until the second
        if number < 2:
            continue
        if not chosen:
            break
        last |= (_gained(work, chosen) < WORTH * work.total)[of_edge]
    del bent, like, tried, last, asked, before  # large, and needed no longer
    rounds: Rounds | None = None
    for factor in CHORD_FITS:
        rounds = rounds or Rounds.of(CYLINDER, *_pieces(territory, link, link.alike))
        chosen = _choose([decimated(territory, CYLINDER, rounds, factor)], territory)
        regions += chosen
        rounds = None if chosen else rounds
    return Partition(tuple(regions), *_remainder(territory))


def _pieces(territory: Territory, link: Links, joined: Flags) -> tuple[Batch, Ints]:
    """Pieces of polygons that convex, and that concave, links among `joined` hold together, with their sides."""
    work, free = territory.patchwork, territory.free
    keys, sides = [], []
    count: int = 0
    sign = work.sign[link.edge]
    inside = joined & free[link.a] & free[link.b]
    for side in (1, -1):
        use = np.flatnonzero(inside & (sign * side >= 0))
        a, b = link.a.take(use), link.b.take(use)
        label = components(a, b, work.count)
        turning = np.zeros(work.count, bool)
        mark = np.flatnonzero(sign.take(use) == side)
        turning[a.take(mark)] = turning[b.take(mark)] = True
        # a piece has at least three polygons beside edges that turn one way
        several = np.bincount(label, turning, work.count) >= 3
        present = np.flatnonzero(free & several[label])
        number, names = renumbered(label[present], work.count)
        keys.append((number + count) * np.int64(work.count) + present)
        sides.append(np.full(names, side))
        count += names
    return Batch.of_keys(work, np.sort(np.concatenate(keys)), count), np.concatenate(sides)


def _blends(territory: Territory, link: Links, joined: Flags, bent: Curvature) -> tuple[Batch, Ints]:
    """Pieces whose links may bend either way, with the side to which the stronger curvature bends."""
    work, free = territory.patchwork, territory.free
    use = np.flatnonzero(joined & free[link.a] & free[link.b])
    label = components(link.a.take(use), link.b.take(use), work.count)
    size = np.bincount(label[free], minlength=work.count)
    # fewer polygons that bend both ways determine no surface
    present = np.flatnonzero(free & (size[label] >= 8))
    number, names = renumbered(label[present], work.count)
    lean = np.bincount(number, work.area[present] * np.sign(bent.strong[present]), names)
    keys = np.sort(number * np.int64(work.count) + present)
    return Batch.of_keys(work, keys, names), np.where(lean >= 0, 1, -1).astype(np.int64)


def _slender_tori(territory: Territory, link: Links, joined: Flags, bent: Curvature) -> list[Growth]:
    """Tori that bend along their tube so little that each row of their facets, round it or along it, is a cylinder or a
    cone as well: the pieces that bend both ways alike, whatever their directions."""
    batch, side = _blends(territory, link, joined, bent)
    middle = quantile(batch.region, bent.ratio.take(batch.polygon), batch.count, 0.5)
    suits = (middle >= TORUS.bends[0]) & (middle < SIMPLE_RATIO) & (batch.size >= TORUS.least)
    pieces, number = batch.where(suits).compact()
    if not len(number):
        return []
    pieces.find_shared()
    return [absorb(territory, whole(territory, TORUS, pieces, side[number]))]


def _whole_pieces(
    territory: Territory, batch: Batch, side: Ints, bent: Curvature, kinds: tuple[Kind, ...]
) -> list[Growth]:  # fmt: skip
    """Each kind on the pieces that bend as it does; what one kind explains whole, the later are not tried on."""
    growths = []
    middle = quantile(batch.region, bent.ratio.take(batch.polygon), batch.count, 0.5)
    batch.find_shared()
    for kind in kinds:
        if not len(batch.region):
            break
        low, high = kind.bends
        suits = (middle >= low) & (middle <= high) & (batch.size >= kind.least)
        pieces, number = batch.where(suits).compact()
        growth = whole(territory, kind, pieces, side[number])
        growths.append(along(territory, CYLINDER, growth)[0] if kind is CYLINDER else growth)
        size = np.zeros(batch.count)
        size[number[growths[-1].origin]] = growths[-1].batch.size
        # Share of a piece that one kind explains, above which the others are not tried: it saves work. Chosen, not
        # measured.
        batch = batch.where(size < 0.98 * batch.size)
    return growths


def _choose(growths: list[Growth], territory: Territory) -> list[Region]:
    """Larger regions first, each without the polygons that were taken before it; they are free no longer."""
    entries = []
    for order, growth in enumerate(growths):
        starts = np.searchsorted(growth.batch.region, np.arange(growth.batch.count + 1))
        for number in np.flatnonzero(np.diff(starts)).tolist():
            polygons = growth.batch.polygon[starts[number] : starts[number + 1]]
            score = len(polygons) / growth.surfaces.kind.handicap
            entries.append((-score, order, int(polygons[0]), number, polygons))
    entries.sort(key=lambda entry: entry[:4])
    chosen = []
    for _, order, _, number, polygons in entries:
        surfaces = growths[order].surfaces
        fresh = polygons[territory.free[polygons]]
        if len(fresh) < max(surfaces.kind.least, FRESH * len(polygons)):
            continue
        territory.free[fresh] = False
        side, tolerance = int(surfaces.side[number]), float(surfaces.tolerance[number])
        chosen.append(Region(surfaces.kind, fresh, surfaces.params[number], side, tolerance))
    return chosen


def _gained(work: Patchwork, chosen: list[Region]) -> Array:
    """(M,) area of these regions on each mesh."""
    gained = np.zeros(len(work.total))
    for region in chosen:
        gained[work.mesh[region.polygons[0]]] += work.area[region.polygons].sum()
    return gained


def _search(territory: Territory, tried: Flags, suits: Callable[[Kind, Ints], Flags]) -> list[Growth]:
    """One round of hypotheses from seeds, of all kinds and both sides; the seeds are tried from now on. `suits` says
    which of the seeds (n,) a kind is tried at."""
    growths: list[Growth] = []
    edges = territory.smooth
    both = [_seeds(territory, edges, tried, side) for side in (1, -1)]
    seeds = np.concatenate(both)
    if not len(seeds):
        return growths
    side = np.repeat(np.array([1, -1]), [len(s) for s in both])
    tried[seeds] = True
    starts: list[tuple[Kind, Batch, Ints]] = []
    for kind in SIMPLE:
        here = np.flatnonzero(suits(kind, seeds))
        batch = _around(territory, seeds[here], side[here], STRAIGHT[kind.name])
        batch, number = batch.where(kind.enough(batch.size)).compact()
        starts.append((kind, batch, side[here[number]]))
    for kind, batch, facing in _ruled_together(starts):
        if len(batch.region):
            growths += pursue(territory, kind, batch, facing).each()
    return [_along_axes(territory, growth, tried) if growth.surfaces.kind is CYLINDER else growth for growth in growths]


def _along_axes(territory: Territory, growth: Growth, tried: Flags) -> Growth:
    """The growth without strips across bands round another axis, whose ridges are tried from now on."""
    kept, ridges = along(territory, CYLINDER, growth)
    tried[ridges] = True
    return kept


def _bends(work: Patchwork, bent: Curvature, kind: Kind, seeds: Ints) -> Flags:
    """(n,) whether the polygons beside these edges seem to bend as the kind does."""
    first, second = bent.ratio[work.a[seeds]], bent.ratio[work.b[seeds]]
    least, most = np.minimum(first, second), np.maximum(first, second)
    return np.asarray((least <= kind.bends[1] + BEND_SLACK) & (most >= kind.bends[0] - BEND_SLACK))


def _unasked(work: Patchwork, bent: Curvature, asked: Flags, kind: Kind, seeds: Ints) -> Flags:
    """(n,) whether a kind with generators was not tried at these edges when they were `asked` (E,): at the border of a
    narrow surface, a neighbour that leans away as little as its facets do makes it seem to bend both ways."""
    if kind not in (CYLINDER, CONE):
        return np.zeros(len(seeds), bool)
    return ~(asked[seeds] & _bends(work, bent, kind, seeds))


def _ruled_together(starts: list[tuple[Kind, Batch, Ints]]) -> list[tuple[Kind, Batch, Ints]]:
    """The kinds with their regions and sides, cylinders and cones as one."""
    (_, cylinders, of_cylinders), (_, cones, of_cones), *others = starts
    work, first = cylinders.patchwork, cylinders.count
    keys = np.concatenate([cylinders.keys, cones.keys + first * np.int64(work.count)])
    batch = Batch.of_keys(work, keys, first + cones.count)
    return [(Mixed(CYLINDER, CONE, first), batch, np.concatenate([of_cylinders, of_cones])), *others]


def _seeds(territory: Territory, edges: Ints, tried: Flags, side: int) -> Ints:
    """Those of the smooth edges to start from: the longest in their surroundings, not used before."""
    work, links = territory.patchwork, territory.links
    start = edges.take(np.flatnonzero((work.sign.take(edges) == side) & ~tried.take(edges)))
    if not len(start):
        return start
    rank = territory.rank.take(start)
    a, b, best = work.a.take(start), work.b.take(start), np.full(work.count, -1)
    np.maximum.at(best, a, rank)
    np.maximum.at(best, b, rank)
    here = (best >= 0).nonzero()[0]
    owner, edge = links.expand(here)
    target = work.other(edge, here.take(owner))
    open_ = territory.free.take(target)
    open_ &= work.sign.take(edge) != -side
    wider = best.copy()
    reach = np.where(open_, best.take(target), -1)
    wider[here] = np.maximum(best.take(here), np.maximum.reduceat(reach, heads(owner).nonzero()[0]))
    foremost: Ints = start.take((rank >= np.minimum(wider.take(a), wider.take(b))).nonzero()[0])
    return foremost


def _ruled(territory: Territory, edges: Ints) -> Ints:
    """Those of the smooth edges between free polygons that may be generators: both polygons have another smooth edge
    along them."""
    work, links = territory.patchwork, territory.links
    for polygons in (work.a, work.b):
        polygon = polygons.take(edges)
        # a polygon between two generators has few smooth edges
        few = (links.lengths(polygon) <= 32).nonzero()[0]
        owner, edge = links.expand(polygon.take(few))
        mine = few.take(owner)
        other = (edge != edges.take(mine)) & territory.free.take(work.other(edge, polygon.take(mine)))
        rows = other.nonzero()[0]
        mine, edge = mine.take(rows), edge.take(rows)
        seed = edges.take(mine)
        cosine = np.abs(dot(work.along(edge), work.along(seed)))
        along = cosine >= STRAIGHT["cone"] * work.length.take(edge) * work.length.take(seed)
        lined = np.zeros(len(edges), bool)
        lined[mine.take(along.nonzero()[0])] = True
        edges = edges.take(lined.nonzero()[0])
    return edges


def _around(territory: Territory, seeds: Ints, side: Ints, straightness: float) -> Batch:
    """Both polygons of each seed and their neighbours across edges along the seed (all, when 0)."""
    work = territory.patchwork
    numbers = np.arange(len(seeds))
    polygon = np.concatenate([work.a[seeds], work.b[seeds]])
    region = np.concatenate([numbers, numbers])
    owner, edge = territory.links.expand(polygon)
    target = work.other(edge, polygon.take(owner))
    mine = region.take(owner)
    lengths = territory.links.lengths(polygon)
    each = np.array([*work.along(seeds).T, work.length.take(seeds)])
    seed = repeated(np.concatenate([each, each], axis=1).T, lengths)
    cosine = np.abs(dot(work.along(edge), seed[:, :3]))
    near = cosine >= straightness * work.length.take(edge) * seed[:, 3]
    keep = near & territory.free.take(target) & (work.sign.take(edge) * side.take(mine) >= 0)
    keys = np.concatenate([region, mine[keep]]) * np.int64(work.count) + np.concatenate([polygon, target[keep]])
    return Batch.of_keys(work, distinct(keys), len(seeds))


def _remainder(territory: Territory) -> tuple[Ints, Ints]:
    """Numbers of the planes and of the freeform patches among what no curved surface explains."""
    work, left, edges = territory.patchwork, territory.free, territory.smooth
    a, b = work.a[edges], work.b[edges]
    neighbours = np.bincount(np.r_[a, b], minlength=work.count)
    nearby = np.bincount(np.r_[a, b], np.r_[work.area[b], work.area[a]], work.count)
    # a polygon much larger than its neighbours is a plane of its own
    dominant = work.area > 3 * nearby / np.maximum(neighbours, 1)
    dominant |= work.area > BROAD * work.total[work.mesh]
    label = components(a, b, work.count)
    size = np.bincount(label[left], minlength=work.count)[label]
    # fewer than four connected polygons are planes
    loose = left & (size >= 4) & (neighbours >= 1) & ~dominant
    planes = np.full(work.count, -1)
    planes[left & ~loose] = np.arange(int((left & ~loose).sum()))
    inside = loose[a] & loose[b]
    patch = components(a[inside], b[inside], work.count)
    freeform = np.full(work.count, -1)
    _, freeform[loose] = np.unique(patch[loose], return_inverse=True)
    return planes, freeform
