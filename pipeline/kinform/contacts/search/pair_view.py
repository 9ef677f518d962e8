"""Two parts as their pair sees them: the facets and surfaces of each that come near the other, in the frame of the
pair.

The frame of a pair is the part frame of the one that has more facets, so that moving a whole assembly changes
nothing, and a large part is never placed anew for each of its neighbours. `PairView` is what all questions about a pair
take; `SurfacePair` one surface of either part that may touch.
"""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise

import numpy as np

from kinform.contacts.constants import MATING_REACH
from kinform.foundation.algebra.displacements import inverse
from kinform.foundation.meshes.boxes import boxes_within, facet_boxes, meeting_box
from kinform.foundation.meshes.mesh_index import MeshIndex, MeshStore
from kinform.foundation.meshes.near_facets import near_boxes
from kinform.foundation.meshes.probes import Region
from kinform.foundation.meshes.surface_table import SurfaceTable
from kinform.foundation.sorting import heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Part
from kinform.model.names import PartName
from kinform.model.surfaces import KINDS, MeshSurfaces, SurfaceKind
from kinform.model.tolerances import Tolerances

CLEARANCE_SHARE = 0.03
"""Share of its radius that a shaft may be smaller than its bore, where that is more than the contact tolerance. Chosen,
not measured."""
MOST_SURFACES = 3000
"""Surfaces of one part that a pair looks at: a bound of memory for crumpled meshes."""


@dataclass(frozen=True, eq=False)
class PartView:
    """A part with all its facets in the frame of the pair (m)."""

    part: Part
    index: MeshIndex
    surfaces: MeshSurfaces
    table: SurfaceTable
    X_FP: Array
    """(4, 4) pose of the part frame in the frame of the pair."""
    at_home: bool
    """Whether the frame of the pair is the part's own."""
    vertices: Array
    """(V, 3)."""
    low: Array
    high: Array
    """(3,) bounding box."""
    region: Region
    """The facets that probes of the pair can meet."""
    clear: float
    """m: no other facet is nearer than this to a facet of the other part."""

    @property
    def faces(self) -> Ints:
        """(F, 3)."""
        return self.index.mesh.faces

    @property
    def probed(self) -> Ints:
        """(n,) facets of the region, ascending."""
        facets = self.region.facets
        return np.arange(len(self.faces)) if facets is None else facets

    def corners(self, facets: Ints) -> Array:
        """(n, 3, 3) m of facets (n,), in the frame of the pair."""
        return np.asarray(self.vertices.take(self.faces.take(facets, axis=0), axis=0))

    def normals(self, facets: Ints) -> Array:
        """(n, 3) unit, outward, of facets (n,), in the frame of the pair."""
        normals = self.index.normals(facets)
        return normals + 0.0 if self.at_home else np.asarray(normals @ self.X_FP[:3, :3].T)

    def depths(self, points: Array) -> tuple[Array, Ints]:
        """Distance (n,) m to the mesh of points (n, 3) on the other part, and the nearest facets (n,).

        Points are in the frame of the pair. Facets outside the region are asked only about points that they may be
        nearest to.
        """
        if self.region.empty:
            return self.index.whole().depths(self.to_part(points))
        distance, facet = self.region.depths(self.to_part(points))
        if self.region.facets is not None:
            far = distance > self.clear
            if far.any():
                distance[far], facet[far] = self.index.whole().depths(self.to_part(points[far]))
        return distance, facet

    def to_part(self, points: Array) -> Array:
        """Points (n, 3) of the frame of the pair in the part frame."""
        if self.at_home:
            return points + 0.0
        return np.asarray((points - self.X_FP[:3, 3]) @ self.X_FP[:3, :3])

    def turn_to_part(self, directions: Array) -> Array:
        """Directions (n, 3) of the frame of the pair in the part frame."""
        if self.at_home:
            return directions + 0.0
        return np.asarray(directions @ self.X_FP[:3, :3])


def _part_view(part: Part, index: MeshIndex, surfaces: MeshSurfaces, X_FP: Array | None) -> PartView:
    """The part at pose `X_FP` (4, 4) in the frame of the pair; None: that frame is the part's own."""
    table = index.table(surfaces)
    region = Region(index, np.zeros(0, np.int64))
    if X_FP is None:
        vertices, low, high = index.mesh.vertices, index.low, index.high
    else:
        R_FP = X_FP[:3, :3]
        vertices = index.mesh.vertices @ R_FP.T + X_FP[:3, 3]
        columns = np.ascontiguousarray(vertices.T)
        low, high = columns.min(axis=1), columns.max(axis=1)
    pose = np.eye(4) if X_FP is None else X_FP
    return PartView(part, index, surfaces, table, pose, X_FP is None, vertices, low, high, region, 0.0)


def _facing(a: PartView, b: PartView, beside: tuple[_Boxed, _Boxed], margin: float) -> tuple[PartView, PartView]:
    """Both parts, with those of their facets `beside` each other that come within `margin` (m) of the other as those
    that probes can meet."""
    (facets_a, low_a, high_a), (facets_b, low_b, high_b) = beside
    # of fewer facets all count as near: to look closer takes as long as FCL's model of the rest
    if len(facets_a) + len(facets_b) > 1000 or not len(facets_a) or not len(facets_b):
        keep_a, keep_b = near_boxes(low_a, high_a, low_b, high_b, margin)
        facets_a, facets_b = facets_a[keep_a], facets_b[keep_b]
    a, b = _probed(a, facets_a, margin), _probed(b, facets_b, margin)
    for one, other, facets in ((a, b, facets_b), (b, a, facets_a)):
        if one.index.is_large and one.region.facets is None:
            one.index.expect(*facet_boxes(one.to_part(other.vertices), other.faces[facets]))
    return a, b


def _probed(part: PartView, facets: Ints, margin: float) -> PartView:
    """The part with these of its facets (n,) as those that probes can meet."""
    placed = part.X_FP, part.at_home, part.vertices, part.low, part.high
    return PartView(part.part, part.index, part.surfaces, part.table, *placed, part.index.region(facets), margin)


_Boxed = tuple[Ints, Array, Array]
"""Facets (n,), ascending, and lowest and highest corners (n, 3) of their boxes."""


def near_facets(placed: PartView, low: Array, high: Array) -> _Boxed:
    """Facets whose boxes meet the box from `low` to `high` (3,), ascending, and their boxes (n, 3)."""
    if placed.at_home:
        boxes = placed.index.boxes
        facets = boxes.meeting(low, high)
        return facets, boxes.low.take(facets, axis=0), boxes.high.take(facets, axis=0)
    vertices, faces = placed.vertices, placed.faces
    beside = np.zeros(len(vertices), np.uint8)
    for axis in range(3):
        column = vertices[:, axis]
        beside |= (column < low[axis]) * _BITS[axis]
        beside |= (column > high[axis]) * _BITS[3 + axis]
    a, b, c = (beside.take(corner) for corner in faces.T)
    a &= b
    a &= c
    facets = np.flatnonzero(a == 0)
    low_f, high_f = facet_boxes(vertices, faces.take(facets, axis=0))
    return facets, low_f, high_f


def boxes_of(placed: PartView, facets: Ints) -> tuple[Array, Array]:
    """Lower and upper corners (n, 3) of the boxes of these facets."""
    if placed.at_home:
        boxes = placed.index.boxes
        return boxes.low[facets], boxes.high[facets]
    return facet_boxes(placed.vertices, placed.faces[facets])


_BITS = np.array([1, 2, 4, 8, 16, 32], dtype=np.uint8)
"""One for each side of a box that a vertex can lie beyond."""


_NONE = np.zeros(0, np.int64)
"""No surfaces."""


@dataclass(frozen=True, eq=False)
class NearSurfaces(SurfaceTable):
    """Surfaces of one part with facets near the other part, in the frame of the pair."""

    ids: Ints
    """(s,) index of each surface in the part's MeshSurfaces."""
    lows: Array
    """(s, 3) box of the near facets."""
    highs: Array
    facets: tuple[Ints, ...]
    """Near facets of each surface."""

    def of_kind(self, *kinds: SurfaceKind) -> Ints:
        """Positions of the surfaces of these kinds."""
        if self.present.isdisjoint(kinds):
            return _NONE
        if len(kinds) == 1:
            return self._of_kind[kinds[0]]
        wanted = np.zeros(len(self.kinds), dtype=bool)
        for kind in kinds:
            wanted |= self.kinds == KINDS.index(kind)
        return np.flatnonzero(wanted)

    @cached_property
    def _of_kind(self) -> dict[str, Ints]:
        return {kind: np.flatnonzero(self.kinds == KINDS.index(kind)) for kind in self.present}

    @cached_property
    def present(self) -> frozenset[str]:
        """The kinds of the surfaces."""
        return frozenset(KINDS[number] for number in self.kinds.tolist())


def _near_surfaces(placed: PartView, beside: _Boxed, low: Array, high: Array) -> NearSurfaces:
    """Surfaces of the part that have facets whose boxes meet the box from `low` to `high` (3,), all among those
    `beside` it."""
    near, low_f, high_f = beside
    meets = meeting_box(low_f, high_f, low, high)
    if not meets.all():
        rows = np.flatnonzero(meets)
        near, low_f, high_f = near.take(rows), low_f.take(rows, 0), high_f.take(rows, 0)
    labels = placed.surfaces.labels.take(near)
    order = labels.argsort(kind="stable")
    near, labels, low_f, high_f = near.take(order), labels.take(order), low_f.take(order, 0), high_f.take(order, 0)
    starts = np.flatnonzero(heads(labels))
    ids = labels[starts]
    if len(ids) > MOST_SURFACES:
        # a crumpled mesh, every facet a surface of its own: the largest decide, and memory stays bounded
        largest = np.sort(np.lexsort((ids, -placed.table.areas[ids]))[:MOST_SURFACES])
        keep = np.isin(labels, ids[largest])
        near, labels, low_f, high_f = near[keep], labels[keep], low_f[keep], high_f[keep]
        starts = np.flatnonzero(heads(labels))
        ids = labels[starts]
    empty = np.zeros((0, 3))
    return NearSurfaces(
        **placed.table.placed(ids, placed.X_FP),  # type: ignore[arg-type]
        ids=ids.astype(np.int64),
        lows=np.minimum.reduceat(low_f, starts) if len(ids) else empty,
        highs=np.maximum.reduceat(high_f, starts) if len(ids) else empty,
        facets=tuple(near[start:end] for start, end in pairwise([*starts.tolist(), len(near)])) if len(ids) else (),
    )


@dataclass(frozen=True, eq=False)
class SurfacePair:
    """The surface of a at position `row` of its near surfaces, and that of b at position `column` of its own."""

    a: NearSurfaces
    b: NearSurfaces
    row: int
    column: int

    def both(self, name: str) -> tuple[float, float]:
        """A column of the table of surfaces by its name, for either surface."""
        return float(getattr(self.a, name)[self.row]), float(getattr(self.b, name)[self.column])

    @property
    def ids(self) -> tuple[int, int]:
        """Indices in the parts' MeshSurfaces."""
        return int(self.a.ids[self.row]), int(self.b.ids[self.column])

    @property
    def kinds(self) -> tuple[SurfaceKind, SurfaceKind]:
        """Of KINDS."""
        return KINDS[self.a.kinds[self.row]], KINDS[self.b.kinds[self.column]]

    @property
    def axes(self) -> tuple[Array, Array]:
        """(3,) unit."""
        return self.a.axes[self.row], self.b.axes[self.column]

    @property
    def points(self) -> tuple[Array, Array]:
        """(3,) m."""
        return self.a.points[self.row], self.b.points[self.column]

    @property
    def extents(self) -> tuple[Array, Array]:
        """(2,) m along the axis from the point."""
        return self.a.extents[self.row], self.b.extents[self.column]

    @property
    def facets(self) -> tuple[Ints, Ints]:
        """Near facets."""
        return self.a.facets[self.row], self.b.facets[self.column]

    @property
    def radii(self) -> tuple[float, float]:
        """m."""
        return self.both("radii")

    @property
    def sides(self) -> tuple[float, float]:
        """1 convex, −1 concave."""
        return self.both("sides")

    @property
    def turns(self) -> tuple[float, float]:
        """Standard uncertainty of the axes (rad)."""
        return self.both("axis_uncertainty")

    @property
    def shifts(self) -> tuple[float, float]:
        """Standard uncertainty of the points (m)."""
        return self.both("point_uncertainty")

    @property
    def chord(self) -> float:
        """m: greatest distances of facets from their surfaces, added."""
        return sum(self.both("chords"))

    @property
    def slack(self) -> float:
        """m by which facets of either side may stand off their surfaces, added."""
        return sum(self.both("slacks"))

    @property
    def swapped(self) -> SurfacePair:
        """As the other part sees it."""
        return SurfacePair(self.b, self.a, self.column, self.row)

    def box(self) -> tuple[Array, Array]:
        """Middle and size (3,) of the common box of the near facets."""
        low = np.maximum(self.a.lows[self.row], self.b.lows[self.column])
        high = np.minimum(self.a.highs[self.row], self.b.highs[self.column])
        return 0.5 * (low + high), np.maximum(high - low, 0.0)


@dataclass(frozen=True, eq=False)
class PairView:
    """Two parts in the frame of their pair, what of each lies near the other, and how near they touch."""

    a: PartView
    b: PartView
    near: tuple[NearSurfaces, NearSurfaces]
    """Surfaces of a and of b with facets near the other part."""
    tolerance: float
    """m: surfaces further apart than this do not touch."""
    play: float
    """m: the same of round surfaces, as far as it does not hang on their radii."""
    tolerances: Tolerances
    apart: bool = False
    """Whether it is known that no facets of both are as near as parts that touch are."""

    @property
    def parts(self) -> tuple[PartView, PartView]:
        """a and b."""
        return self.a, self.b

    @property
    def names(self) -> tuple[PartName, PartName]:
        """Of a and b."""
        return self.a.part.name, self.b.part.name

    @cached_property
    def swapped(self) -> PairView:
        """With b first."""
        return PairView(self.b, self.a, self.near[::-1], self.tolerance, self.play, self.tolerances, self.apart)

    def surfaces(self, row: int, column: int) -> SurfacePair:
        """One near surface of either part, by their positions."""
        return SurfacePair(*self.near, int(row), int(column))

    def overlap(self, margin: float) -> Flags:
        """(s, t): the boxes of near surface s of a and t of b come within `margin` (m)."""
        a, b = self.near
        known = self._overlaps.get(margin)
        if known is None:
            known = boxes_within((a.lows, a.highs), (b.lows, b.highs), margin)
            # surfaces times surfaces up to which it is kept which come near each other: 0.2 MB
            if known.size > 200_000:
                return known
            self._overlaps[margin] = known
        return known.copy()

    @cached_property
    def _overlaps(self) -> dict[float, Flags]:
        """Those that were asked for, by margin."""
        return {}

    def of_kinds(self, overlap: Flags, *kinds: SurfaceKind) -> tuple[Ints, Ints, Flags]:
        """Positions of the near surfaces of these kinds of a (s,) and of b (t,), and the flags `overlap` of these (s,
        t)."""
        rows, columns = (side.of_kind(*kinds) for side in self.near)
        if not len(rows) or not len(columns):
            return rows, columns, np.zeros((len(rows), len(columns)), bool)
        return rows, columns, overlap[rows[:, None], columns]

    def common_box(self) -> tuple[Array, Array] | None:
        """Lowest and highest corner (3,) of where near facets of both come within the tolerance; None without
        facets."""
        a, b = self.near
        if not len(a.ids) or not len(b.ids):
            return None
        low = np.maximum(a.lows.min(axis=0), b.lows.min(axis=0)) - self.tolerance
        return low, np.minimum(a.highs.max(axis=0), b.highs.max(axis=0)) + self.tolerance


def pair_view(
    parts: tuple[Part, Part],
    surfaces: dict[str, MeshSurfaces],
    store: MeshStore,
    tolerance: float,
    tolerances: Tolerances,
) -> tuple[PairView, Array, float] | None:
    """Two meshed parts, the pose (4, 4) of the frame of the pair in the world, and how far apart surfaces of theirs
    that mate may be (m): clearances grow with the radius. None where no facets are that near. `surfaces` by mesh
    digest."""
    meshes = [part.mesh for part in parts]
    first, second = meshes
    assert first is not None
    assert second is not None
    home = parts[0] if len(first.faces) >= len(second.faces) else parts[1]
    a, b = (
        _part_view(
            part, store.index(mesh), surfaces[mesh.digest], None if part is home else inverse(home.X_WP) @ part.X_WP
        )
        for part, mesh in zip(parts, (first, second), strict=True)
    )
    play = max(tolerance, tolerances.radial_of(first.size, second.size))
    reach = MATING_REACH * max(play, CLEARANCE_SHARE * min(a.table.radius, b.table.radius))
    low, high = np.maximum(a.low, b.low) - reach, np.minimum(a.high, b.high) + reach
    if (low > high).any():
        return None
    margin = max(a.table.slack, b.table.slack)
    beside = near_facets(a, low - margin, high + margin), near_facets(b, low - margin, high + margin)
    a, b = _facing(a, b, beside, reach + margin)
    near = (_near_surfaces(a, beside[0], low, high), _near_surfaces(b, beside[1], low, high))
    return PairView(a, b, near, tolerance, play, tolerances), home.X_WP, reach
