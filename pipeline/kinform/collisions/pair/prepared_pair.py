"""Two parts of different bodies, as far as a motion can bring them into collision.

Facets of surfaces that the pair's own motion maps onto themselves are left out (`slippage`). What is left of mating
parts may still cross by chord errors where a border of one surface runs along a mate: such segments, all of whose
points lie on a mating surface to within the errors of the pair, are no collision.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise

import fcl
import numpy as np

from kinform.collisions.pair.drawn_overlap import DrawnOverlap
from kinform.collisions.pair.facet_crossings import crossings
from kinform.collisions.pair.mate_surfaces import Mates, SurfacePair
from kinform.collisions.pair.passages import Passages, Path, passages
from kinform.collisions.pair.penetration import DEPTH_FINER, Penetration
from kinform.collisions.parts.probes import Probes
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.algebra.vectors import perpendicular
from kinform.foundation.current_work import working_on
from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_pose
from kinform.foundation.rounding import SOLVED
from kinform.foundation.sorting import distinct
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.names import PartName

FACET_GRID = 12
"""Parts of the side of a facet at whose ends it is asked what is inside the other part: a choice, 91 points in all."""
DIRECTIONS_ROUND = np.stack([np.cos(np.arange(8) * np.pi / 4), np.sin(np.arange(8) * np.pi / 4)], axis=1)
"""(8, 2) directions about a point in a plane."""
CROSSINGS_MOST = 200_000
"""Crossing facets that one question may return: a choice, so that memory stays bounded."""
OVERLAP_SAME = 1.25
"""Parts that overlapped at the start, and come to overlap by no more than this share of it, come back to where they
were: a choice."""


@dataclass(frozen=True, eq=False)
class Crossing:
    """Facets that cross at one pose."""

    shared: Mapping[SurfacePair, Array]
    """(n, 2, 3) m, segments that the facets of two surfaces which cross share, in the frame of the first part."""
    slack: float
    """m: what mates may overlap, and chord errors of the surfaces that cross: less deep, the parts may just scrape."""

    def __bool__(self) -> bool:
        return bool(self.shared)

    def segments(self, pairs: Collection[SurfacePair] | None = None) -> Array:
        """(n, 2, 3) m: those of some pairs of surfaces, or all."""
        chosen = [segments for pair, segments in self.shared.items() if pairs is None or pair in pairs]
        return np.concatenate(chosen) if chosen else np.zeros((0, 2, 3))


NONE = Crossing({}, 0.0)
"""Where no facets cross."""


class PairTest:
    """Parts `names`, with the facets that a motion may bring together; poses are of the second in the first."""

    def __init__(
        self, shapes: Shapes, first: str, second: str, facets: tuple[Ints, Ints], mates: Sequence[Patch] | Mates
    ):
        """`facets` of each part count; `mates` are the patches by which the two mate."""
        self.names = (first, second)
        self._shapes = shapes
        self.overlapping = shapes.overlapping(first, second)
        """Whether the solids overlap at the pose of the meshes, other than where they mate."""
        self.facets = facets
        self.X_WA, self.X_WB = shapes.part(first).X_WP, shapes.part(second).X_WP
        self._X_AW = np.asarray(np.linalg.inv(self.X_WA))
        self._meshes = (shapes.mesh(first), shapes.mesh(second))
        self._surfaces = (shapes.surfaces_of(first), shapes.surfaces_of(second))
        if not isinstance(mates, Mates):
            near = (shapes.borders(first), shapes.borders(second)) if mates else ([], [])
            mates = Mates(first, mates, self._surfaces, near, self.size)
        self.mates = mates
        self.scrape = shapes.allowed(first, second).length
        """m: less deep, parts scrape, as mates may."""
        self.loose = max([self.scrape, *self.mates.slacks])
        """m: less deep, points of one may be in the other though the parts only mate."""
        self._passages: Passages | None = None
        self._drawn: dict[bytes, DrawnOverlap] = {}
        self.empty = not (len(facets[0]) and len(facets[1]))

    def some(self, facets: tuple[Ints, Ints]) -> PairTest:
        """The same with some of the facets."""
        test = PairTest(self._shapes, *self.names, facets, self.mates)
        test._drawn = self._drawn
        return test

    @cached_property
    def _objects(self) -> tuple[fcl.CollisionObject, fcl.CollisionObject]:
        with working_on(*self.names):
            first, second = (
                fcl.CollisionObject(self._shapes.model(n, f)) for n, f in zip(self.names, self.facets, strict=True)
            )
        return first, second

    @property
    def part_names(self) -> tuple[PartName, PartName]:
        """Names of the parts, sorted."""
        first, second = sorted(PartName(name) for name in self.names)
        return first, second

    @cached_property
    def size(self) -> float:
        """Diagonal of the smaller part (m)."""
        return min(mesh.diagonal for mesh in self._meshes)

    def holds(self, facets: tuple[Ints, Ints]) -> bool:
        """Whether these facets of both parts, ascending, are among those that count."""
        return all(
            len(some) <= len(side) and bool(np.isin(some, side, assume_unique=True).all())
            for some, side in zip(facets, self.facets, strict=True)
        )

    def going_deeper(self, before: float) -> float:
        """m: deeper than that, parts that overlapped by `before` (m) do not just rub on, but go into each other."""
        return OVERLAP_SAME * before + self._rubs

    @property
    def _rubs(self) -> float:
        """m: so far parts that overlap as they are drawn may go on."""
        # Parts go into each other where their overlap grows by this share of the size: an arm that lies 0.3 mm in its
        # base, of 166 mm, rubs on it by 0.74 mm until it is clear of it.
        return max(self.loose, 5e-3 * self.size)

    def leads_in(self, displacement: Callable[[float], Array], start: float, end: float) -> float | None:
        """How far a motion from `start` up to `end` goes until it is seen to lead on into what the parts share at its
        start (`DrawnOverlap`), by more than they may rub on; None where it does not, or they share nothing that is
        thicker than what is thin beside what mates may be deep."""
        X = self.pose(displacement(start))
        with working_on(*self.names):
            if X.tobytes() not in self._drawn:
                # Share of what mates may be deep to which pieces of an overlap are thin: twice their volume over their
                # area, which is half as much as a wedge is deep, or a third as a ball.
                self._drawn[X.tobytes()] = DrawnOverlap(*self._meshes, X, 0.25 * self.loose)
            return self._drawn[X.tobytes()].leads_in(lambda s: self.pose(displacement(s)), start, end, self._rubs)

    def pose(self, D: Array) -> Array:
        """(4, 4) of the second part in the first, by the displacement `D` of the second body relative to the first."""
        return np.asarray(self._X_AW @ D @ self.X_WB)

    def _place(self, D: Array) -> Array:
        """Pose of the second part in the first, by the displacement `D` of the second body relative to the first."""
        X = self.pose(D)
        self._objects[1].setTransform(fcl_pose(X))
        return X

    def distance(self, D: Array) -> tuple[float, tuple[int, int]]:
        """Distance (m) of the facets that count at a displacement (4, 4), 0 where they touch or cross; and the
        nearest."""
        if self.empty:
            return float("inf"), (0, 0)
        self._place(D)
        result = fcl.DistanceResult()
        with working_on(*self.names):
            return fcl_distance(self._objects[0], self._objects[1], result), (result.b1, result.b2)

    def hits(self, D: Array) -> Ints:
        """(n, 2) facets, as counted by FCL, that touch or cross at a displacement (4, 4)."""
        if self.empty:
            return np.zeros((0, 2), dtype=np.int64)
        self._place(D)
        with working_on(*self.names):
            return _hits(*self._objects)

    def height(self, D: Array, nearest: tuple[int, int]) -> float:
        """m: of the middle of one of the second's facets that count above the plane of one of the first's."""
        X = self.pose(D)
        first, second = (self._corners(side, facet) for side, facet in enumerate(nearest))
        middle = X[:3, :3] @ (second.sum(axis=0) / 3.0) + X[:3, 3]
        return float(self._normals[0][nearest[0]] @ (middle - first[0]))

    def _corners(self, side: int, chosen: int | Ints | slice) -> Array:
        """(…, 3, 3) m, part frame: corners of some of the facets that count, of the first or second part (0, 1)."""
        mesh = self._meshes[side]
        return np.asarray(mesh.vertices[mesh.faces[self.facets[side][chosen]]])

    @cached_property
    def _normals(self) -> tuple[Array, Array]:
        """(n, 3) unit, of the facets that count, each in the frame of its part; zero for those without area."""
        first, second = (self._shapes.index(n).normals(f) for n, f in zip(self.names, self.facets, strict=True))
        return first, second

    def inside(self, D: Array, f: int, g: int, least: float) -> bool:
        """Whether points of one of two facets that count are deeper than `least` (m) inside the other part."""
        for name, points, _ in self._on(D, f, g):
            index = self._shapes.index(name)
            deep = points[index.depths(points) > least]
            if len(deep) and index.contains(deep).any():
                return True
        return False

    def faces(self, D: Array, f: int, g: int) -> bool:
        """Whether one of two facets that count lies inside the other part with more of its plane round about than mates
        may overlap: however thin the part is, it is not just scraped."""
        for name, points, normal in self._on(D, f, g):
            index = self._shapes.index(name)
            within = points[index.contains(points)]
            for e in DIRECTIONS_ROUND @ np.stack(perpendicular(normal)):
                within = within[index.contains(within + self.loose * e)] if len(within) else within
            if len(within):
                return True
        return False

    def _on(self, D: Array, f: int, g: int) -> Iterator[tuple[str, Array, Array]]:
        """Points (n, 3) m on either of two facets, in the frame of the other part, whose name is first; and its
        normal."""
        X = self.pose(D)
        grid = (
            np.array([(a, b, FACET_GRID - a - b) for a in range(FACET_GRID + 1) for b in range(FACET_GRID + 1 - a)])
            / FACET_GRID
        )
        first, second = grid @ self._corners(0, f), grid @ self._corners(1, g)
        yield self.names[1], (first - X[:3, 3]) @ X[:3, :3], self._normals[0][f] @ X[:3, :3]
        yield self.names[0], second @ X[:3, :3].T + X[:3, 3], X[:3, :3] @ self._normals[1][g]

    @cached_property
    def probes(self) -> tuple[Probes, Probes]:
        """Points on the facets that count."""
        first, second = (self._shapes.probes(n, f) for n, f in zip(self.names, self.facets, strict=True))
        return first, second

    @cached_property
    def solid_about(self) -> Flags:
        """(n,) whether what these points, counted through, may be inside of is closed: else nothing is certainly
        inside."""
        first, second = (mesh.health.watertight for mesh in self._meshes)
        near, far = self.probes
        return np.repeat([second, first], [len(near.points), len(far.points)])

    def passages(self, path: Path) -> Passages:
        """Where these points, counted through, pass through the facets that count of the other part as the second part
        moves along a path, the same whenever it is asked, or the other way."""
        if self._passages is None:
            frames = [path.frame @ X for X in (self.X_WA, self.X_WB)]
            points = [_moved(probes.points, X) for probes, X in zip(self.probes, frames, strict=True)]
            corners = [_moved(self._corners(k, slice(None)), X) for k, X in enumerate(frames)]
            self._passages = Passages.joined(
                # the first part goes the other way as the second sees it
                passages(points[0], corners[1], path.turning, self._meshes[1]).reversed(),
                passages(points[1], corners[0], path.turning, self._meshes[0]),
            )
        return self._passages.ordered(path)

    def heights(self, D: Array, chosen: Ints, away: bool = True, *, alike: bool = False) -> Array:
        """(k,) m: how deep some of both parts' `probes`, counted through, are inside the other part; outside, the
        negative of a distance that they keep at least, 0 unless it is asked how far `away` they are. `alike`: those
        that are less deep than mates may be are measured as the others, so that the deepest can be told."""
        X = self.pose(D)
        near, far = self.probes
        count = len(near.points)
        first, second = (self._shapes.index(name) for name in self.names)
        mine, other = chosen[chosen < count], chosen[chosen >= count] - count
        out, shallow = np.zeros(len(chosen)), 0.0 if alike else self.loose
        out[chosen < count] = near.heights(second, np.asarray(np.linalg.inv(X)), mine, away, shallow)
        out[chosen >= count] = far.heights(first, X, other, away, shallow)
        return out

    def places(self, D: Array) -> Array:
        """(n, 3) m, first part's frame: these points."""
        X = self.pose(D)
        near, far = self.probes
        return np.concatenate([near.points, far.points @ X[:3, :3].T + X[:3, 3]])

    def sunk(self, D: Array) -> tuple[float, Array]:
        """m: how deep the deepest of these points is inside, 0 where that is rounding; and where it is (3,), world."""
        places = self.places(D)
        heights = self.heights(D, np.arange(len(places)), away=False, alike=True)
        n = int(np.argmax(heights))
        depth = float(heights[n])
        return depth if depth > SOLVED * self.size else 0.0, (self.X_WA @ np.append(places[n], 1.0))[:3]

    def deepest(self, D: Array) -> float:
        """m: how deep the parts go into each other where they cross, or where points of one are inside the other."""
        if self.empty:
            return 0.0
        places = self.places(D)
        inside = self.heights(D, np.arange(len(places))) > self.loose
        places_deep = [points for points in (self.crossing(D).segments(), places[inside]) if len(points)]
        return max((self.depth(D, points, finer=DEPTH_FINER) for points in places_deep), default=0.0)

    def middle(self, D: Array, f: int, g: int) -> Array:
        """(3,) m, first part's frame: between two facets that count."""
        X = self.pose(D)
        first, second = self._corners(0, f), self._corners(1, g) @ X[:3, :3].T + X[:3, 3]
        return np.asarray(0.5 * (first.mean(axis=0) + second.mean(axis=0)))

    def crossing(self, D: Array, hits: Ints | None = None) -> Crossing:
        """Facets that count and cross at a displacement (4, 4), other than along mates; `hits`: where these are
        known."""
        return self.crossings([D], [self.hits(D) if hits is None else hits])[0]

    def crossings(self, displacements: Sequence[Array], hits: Sequence[Ints]) -> list[Crossing]:
        """The same of several displacements, with the facets (n, 2) that touch or cross at each."""
        if not any(map(len, hits)):
            return [NONE] * len(hits)
        poses = [self.pose(D) for D in displacements]
        placed = [self._touching(X, some) for X, some in zip(poses, hits, strict=True) if len(some)]
        first, second, *normals = (np.concatenate(sides) for sides in zip(*placed, strict=True))
        cross, segments = crossings(first, second, (normals[0], normals[1]), SOLVED * self.size)
        rows = np.flatnonzero(cross)
        every, segments = np.concatenate(hits)[rows], segments[rows]
        labels = self.counted(0)[every[:, 0]], self.counted(1)[every[:, 1]]
        if self.mates and len(rows):
            at = np.repeat(np.array(poses), [len(some) for some in hits], axis=0)[rows]
            seen = np.einsum("nki,nij->nkj", segments - at[:, None, :3, 3], at[:, :3, :3])
            apart = np.flatnonzero(~self.mates.along(labels, (segments, seen)))
            rows, segments, labels = rows[apart], segments[apart], (labels[0][apart], labels[1][apart])
        ends = np.searchsorted(rows, np.cumsum([0, *map(len, hits)])).tolist()
        return [
            self._crossed((labels[0][i:j], labels[1][i:j]), segments[i:j]) if j > i else NONE for i, j in pairwise(ends)
        ]

    def _touching(self, X: Array, hits: Ints) -> tuple[Array, Array, Array, Array]:
        """Corners (n, 3, 3) of facets of both at a pose (4, 4) of the second in the first, and their normals (n, 3)."""
        first, second = hits.T
        corners = self._corners(1, second) @ X[:3, :3].T + X[:3, 3]
        return self._corners(0, first), corners, self._normals[0][first], self._normals[1][second] @ X[:3, :3].T

    def _crossed(self, labels: tuple[Ints, Ints], segments: Array) -> Crossing:
        """Of facets (n,) of surfaces of either part that share segments (n, 2, 3)."""
        out: dict[SurfacePair, Array] = {}
        slack = self.scrape
        for pair in sorted(set(zip(labels[0].tolist(), labels[1].tolist(), strict=True))):
            out[pair] = segments[(labels[0] == pair[0]) & (labels[1] == pair[1])]
            slack = max(slack, sum(self._surfaces[k].surfaces[pair[k]].chord for k in (0, 1)))
        return Crossing(out, slack)

    def of_surfaces(self, hits: Ints, pairs: Collection[SurfacePair]) -> Ints:
        """(k, 2) those of facets (n, 2), as counted by FCL, that are of some pairs of surfaces."""
        first, second = (self.counted(side)[hits[:, side]].tolist() for side in (0, 1))
        return hits[[pair in pairs for pair in zip(first, second, strict=True)]]

    def counted(self, side: int) -> Ints:
        """(n,) the surface of each facet that counts, of the first or second part (0, 1)."""
        return self._counted[side]

    @cached_property
    def _counted(self) -> tuple[Ints, Ints]:
        first, second = (s.labels[f] for s, f in zip(self._surfaces, self.facets, strict=True))
        return first, second

    def depth(self, D: Array, segments: Array, least: float = 0.0, finer: int = 1) -> float:
        """m: how deep the parts go into each other between `segments` (n, 2, 3) where they cross, or points (n, 3)
        inside either; 0 where it is not above `least`, which is asked of segments only. Asked at `finer` times as many
        places."""
        if least > 0.0 and self.shallow([D], [segments], [least])[0]:
            return 0.0
        with working_on(*self.names):
            deepest = self._penetration.deepest(self.pose(D), segments, finer)
        return deepest if deepest > least else 0.0

    def shallow(self, displacements: Sequence[Array], segments: Sequence[Array], least: Sequence[float]) -> list[bool]:
        """Of several displacements (4, 4), whether the parts certainly go no deeper into each other than `least` (m)
        between segments (n, 2, 3) where they cross there."""
        with working_on(*self.names):
            return self._penetration.shallow([self.pose(D) for D in displacements], segments, least)

    @cached_property
    def _penetration(self) -> Penetration:
        first, second = (self._shapes.index(name) for name in self.names)
        return Penetration(first, second, SOLVED * self.size)


def _moved(points: Array, X: Array) -> Array:
    """Points (…, 3) by a displacement (4, 4)."""
    return np.asarray(points @ X[:3, :3].T + X[:3, 3])


def _hits(first: fcl.CollisionObject, second: fcl.CollisionObject) -> Ints:
    """(n, 2) facets of two models that FCL finds to touch, each pair once, in order."""
    result = fcl.CollisionResult()
    fcl.collide(first, second, fcl.CollisionRequest(num_max_contacts=CROSSINGS_MOST, enable_contact=False), result)
    key = distinct(np.array([(c.b1 << 32) + c.b2 for c in result.contacts], dtype=np.int64))
    return np.stack([key >> 32, key & 0xFFFFFFFF], axis=1)
