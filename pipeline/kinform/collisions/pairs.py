"""Two parts of different bodies, as far as a motion can bring them into collision.

Facets of surfaces that the pair's own motion maps onto themselves are left out (`invariant`). What is left of mating
parts may still cross by chord errors where a border of one surface runs along a mate: such segments, all of whose
points lie on a mating surface to within the errors of the pair, are no collision.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import fcl
import numpy as np
from numpy.typing import NDArray

from kinform.collisions.crossing import crossings
from kinform.collisions.entering import Probes, probes
from kinform.collisions.invariant import Allowed, OwnMotions, Slippage
from kinform.contacts.boxes import together
from kinform.contacts.bvh import MeshIndex, MeshStore, fcl_distance, fcl_pose, partial_model
from kinform.kinematics.screws import cross
from kinform.model.assembly import Assembly, Mesh, Part
from kinform.model.contacts import Contacts, Patch
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces, Surface

__all__ = ["Crossing", "PairTest", "Shapes"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
SurfacePair = tuple[int, int]

PRESERVED = 0.03
"""A patch mates along a motion whose velocity is within this share of tangential to it."""
SAMPLES = 32
"""Ends of crossing segments between which the depth is looked for."""
GRID = 12
"""Points along the side of a facet that are asked whether they are inside the other part."""
MIDDLES = 64
"""Places between them that are asked whether they are inside both parts."""
INSIDE = 40
"""Of those that are, at which the depth is measured."""
FINER = 4
"""So many times as many places for a depth that is reported."""
SPHERES = 96
"""Spheres about the facets of a part."""
MOST = 200_000
"""Crossing facets that one question may return."""
SCRAPE = 1e-3
"""Share of the smaller part's diagonal by which parts may overlap as they slide along each other: by rounding of their
files and by what is left over where joints were fitted. In no unit, so that an assembly of any size answers the same."""


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
        chosen = [own for pair, own in self.shared.items() if pairs is None or pair in pairs]
        return np.concatenate(chosen) if chosen else np.zeros((0, 2, 3))


NONE = Crossing({}, 0.0)


@dataclass
class Shapes:
    """Meshes with what is asked of them, each worked out once."""

    assembly: Assembly
    surfaces: dict[str, MeshSurfaces]
    contacts: Contacts | None
    body_parts: dict[str, frozenset[str]] = field(default_factory=dict)
    """Parts of each body that have a mesh."""
    _own: dict[str, OwnMotions] = field(default_factory=dict)
    _slippage: dict[tuple[str, bytes], Slippage] = field(default_factory=dict)
    _borders: dict[str, list[set[int]]] = field(default_factory=dict)
    _models: dict[tuple[str, bytes], fcl.BVHModel] = field(default_factory=dict)
    _store: MeshStore = field(default_factory=MeshStore)
    _spheres: dict[str, tuple[Array, Array]] = field(default_factory=dict)
    _patches: dict[tuple[str, str], list[int]] | None = None
    _parts: dict[str, Part] = field(default_factory=dict)

    def part(self, name: str) -> Part:
        """The part of that name."""
        if not self._parts:
            self._parts = {part.name: part for part in self.assembly.parts}
        return self._parts[name]

    def mesh(self, name: str) -> Mesh:
        """Its mesh."""
        mesh = self.part(name).mesh
        assert mesh is not None
        return mesh

    @cached_property
    def size(self) -> float:
        """m: diagonal of the assembly's box at the pose of the meshes; 1 without meshes."""
        corners = []
        for name in sorted(name for own in self.body_parts.values() for name in own):
            X, index = self.part(name).X_WP, self.index(name)
            bits = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)])
            corners.append(np.where(bits, index.high, index.low) @ X[:3, :3].T + X[:3, 3])
        return float(np.linalg.norm(np.ptp(np.concatenate(corners), axis=0))) if corners else 1.0

    def surfaces_of(self, name: str) -> MeshSurfaces:
        """Its surfaces."""
        return self.surfaces[self.mesh(name).digest]

    def allowed(self, first: str, second: str) -> Allowed:
        """What surfaces of a pair may be off an exact invariance."""
        size = min(self.mesh(first).diagonal, self.mesh(second).diagonal)
        return Allowed(SCRAPE * size, 1.5 * self.assembly.tolerances.alignment)

    def invariant(self, name: str, twists: Array, allowed: Allowed) -> Flags:
        """(s,) which surfaces of a part the motions `twists` (k, 6), in the world, map onto themselves."""
        key = (name, twists.tobytes())
        if key not in self._slippage:
            mesh = self.mesh(name)
            if mesh.digest not in self._own:
                self._own[mesh.digest] = OwnMotions(mesh, self.surfaces_of(name))
            X = self.part(name).X_WP
            omega = twists[:, :3] @ X[:3, :3]
            moment = (twists[:, 3:] + cross(twists[:, :3], np.broadcast_to(X[:3, 3], omega.shape))) @ X[:3, :3]
            self._slippage[key] = self._own[mesh.digest].slippage(np.hstack([omega, moment]))
        return self._slippage[key].within(allowed)

    def borders(self, name: str) -> list[set[int]]:
        """For each surface of a part, the surfaces that share an edge with it, and itself."""
        mesh, surfaces = self.mesh(name), self.surfaces_of(name)
        if mesh.digest not in self._borders:
            near: list[set[int]] = [{n} for n in range(len(surfaces.surfaces))]
            edges = np.sort(mesh.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
            labels = np.repeat(surfaces.labels, 3)
            order = np.lexsort((edges[:, 1], edges[:, 0]))
            edges, labels = edges[order], labels[order]
            same = np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1) & (labels[1:] != labels[:-1]))
            for a, b in np.unique(np.stack([labels[same], labels[same + 1]], axis=1), axis=0).tolist():
                near[a].add(b)
                near[b].add(a)
            self._borders[mesh.digest] = near
        return self._borders[mesh.digest]

    def overlapping(self, first: str, second: str) -> bool:
        """Whether the solids of two parts overlap at the pose of the meshes, other than where they mate."""
        found = self.contacts.interferences if self.contacts is not None else ()
        return any(set(item.parts) == {first, second} and not item.mated for item in found)

    def index(self, name: str) -> MeshIndex:
        """Its facets, to be asked for insides and distances."""
        return self._store.index(self.mesh(name))

    def model(self, name: str, facets: Ints | None = None) -> fcl.BVHModel:
        """FCL's model of some facets of a part (m, part frame)."""
        mesh = self.mesh(name)
        if facets is None or len(facets) == len(mesh.faces):
            return self.index(name).bvh
        key = (mesh.digest, facets.tobytes())
        if key not in self._models:
            self._models[key] = partial_model(mesh.vertices, mesh.faces[facets])
        return self._models[key]

    def spheres(self, name: str) -> tuple[Array, Array]:
        """Middles (k, 3) and radii (k,) m of spheres that hold the facets of a part, part frame."""
        mesh = self.mesh(name)
        if mesh.digest not in self._spheres:
            self._spheres[mesh.digest] = _spheres(mesh)
        return self._spheres[mesh.digest]

    def patches(self, first: str, second: str) -> list[int]:
        """Indices of the patches between two parts, in either order."""
        if self._patches is None:
            self._patches = {}
            for n, patch in enumerate(self.contacts.patches if self.contacts is not None else ()):
                self._patches.setdefault(patch.parts, []).append(n)
        return self._patches.get((min(first, second), max(first, second)), [])


class PairTest:
    """Parts `names`, with the facets that a motion may bring together; poses are of the second in the first."""

    def __init__(self, shapes: Shapes, first: str, second: str, facets: tuple[Ints, Ints], mates: Sequence[Patch]):
        self.names = (first, second)
        self._shapes = shapes
        self.overlapping = shapes.overlapping(first, second)
        """Whether the solids overlap at the pose of the meshes, other than where they mate."""
        self.facets = facets
        self.X_WA, self.X_WB = shapes.part(first).X_WP, shapes.part(second).X_WP
        self._X_AW = np.asarray(np.linalg.inv(self.X_WA))
        self._meshes = (shapes.mesh(first), shapes.mesh(second))
        self._surfaces = (shapes.surfaces_of(first), shapes.surfaces_of(second))
        self._near = (shapes.borders(first), shapes.borders(second))
        self._mates = [self._own(patch) for patch in mates]
        self._slacks = [
            patch.chord + 2.0 * abs(patch.gap) + sum(patch.uncertainty[1:]) + 1e-6 * self.size for patch in mates
        ]
        self.scrape = shapes.allowed(first, second).length
        """m: less deep, parts scrape, as mates may."""
        self.loose = max([self.scrape, *self._slacks])
        """m: less deep, points of one may be in the other though the parts only mate."""
        self._bare = {pair for pair, patch in zip(self._mates, mates, strict=True) if patch.kind in _SHAPELESS}
        self.empty = not (len(facets[0]) and len(facets[1]))
        if not self.empty:
            self._objects = tuple(
                fcl.CollisionObject(shapes.model(n, f)) for n, f in zip(self.names, facets, strict=True)
            )

    @property
    def part_names(self) -> tuple[PartName, PartName]:
        """Names of the parts, sorted."""
        first, second = sorted(PartName(name) for name in self.names)
        return first, second

    @cached_property
    def size(self) -> float:
        """Diagonal of the smaller part (m)."""
        return min(mesh.diagonal for mesh in self._meshes)

    def _own(self, patch: Patch) -> SurfacePair:
        a, b = patch.surfaces
        return (a, b) if patch.parts[0] == self.names[0] else (b, a)

    def pose(self, D: Array) -> Array:
        """(4, 4) of the second part in the first, by the displacement `D` of the second body relative to the first."""
        return np.asarray(self._X_AW @ D @ self.X_WB)

    def _place(self, D: Array) -> Array:
        """Pose of the second part in the first, by the displacement `D` of the second body relative to the first."""
        X = self.pose(D)
        self._objects[1].setTransform(fcl_pose(X))
        return X

    def distance(self, D: Array) -> tuple[float, tuple[int, int]]:
        """Distance (m) of the facets that count at a displacement (4, 4), 0 where they touch or cross; and the nearest."""
        if self.empty:
            return float("inf"), (0, 0)
        self._place(D)
        result = fcl.DistanceResult()
        return fcl_distance(self._objects[0], self._objects[1], result), (result.b1, result.b2)

    def hits(self, D: Array) -> Ints:
        """(n, 2) facets, as counted by FCL, that touch or cross at a displacement (4, 4)."""
        if self.empty:
            return np.zeros((0, 2), dtype=np.int64)
        self._place(D)
        return _hits(*self._objects)

    def height(self, D: Array, nearest: tuple[int, int]) -> float:
        """m: of the middle of one of the second's facets that count above the plane of one of the first's."""
        X = self.pose(D)
        corner = self._meshes[0].vertices[self._meshes[0].faces[self.facets[0][nearest[0]], 0]]
        far = self._meshes[1].vertices[self._meshes[1].faces[self.facets[1][nearest[1]]]]
        return float(self._normals[0][nearest[0]] @ (X[:3, :3] @ (far.sum(axis=0) / 3.0) + X[:3, 3] - corner))

    @cached_property
    def _normals(self) -> tuple[Array, Array]:
        """(n, 3) unit, of the facets that count, each in the frame of its part; zero for those without area."""
        first, second = (self._shapes.index(n).normals(f) for n, f in zip(self.names, self.facets, strict=True))
        return first, second

    def inside(self, D: Array, f: int, g: int, least: float) -> bool:
        """Whether points of one of two facets that count are deeper than `least` (m) inside the other part."""
        X = self.pose(D)
        grid = np.array([(a, b, GRID - a - b) for a in range(GRID + 1) for b in range(GRID + 1 - a)]) / GRID
        own = grid @ self._meshes[0].vertices[self._meshes[0].faces[self.facets[0][f]]]
        far = grid @ self._meshes[1].vertices[self._meshes[1].faces[self.facets[1][g]]]
        for name, points in (
            (self.names[1], (own - X[:3, 3]) @ X[:3, :3]),
            (self.names[0], far @ X[:3, :3].T + X[:3, 3]),
        ):
            index = self._shapes.index(name)
            deep = points[index.whole().depths(points)[0] > least]
            if len(deep) and index.contains(deep).any():
                return True
        return False

    @cached_property
    def probes(self) -> tuple[Probes, Probes]:
        """Points on the facets that count."""
        first, second = (
            probes(mesh, surfaces.labels, own)
            for mesh, surfaces, own in zip(self._meshes, self._surfaces, self.facets, strict=True)
        )
        return first, second

    def heights(self, D: Array, chosen: Ints) -> Array:
        """(k,) m: how deep some of both parts' `probes`, counted through, are inside the other part; outside, the negative
        of a distance that they keep at least."""
        X = self.pose(D)
        own, far = self.probes
        count = len(own.points)
        first, second = (self._shapes.index(name) for name in self.names)
        mine, other = chosen[chosen < count], chosen[chosen >= count] - count
        out = np.zeros(len(chosen))
        out[chosen < count] = own.heights(second, np.asarray(np.linalg.inv(X)), mine)
        out[chosen >= count] = far.heights(first, X, other)
        return out

    def places(self, D: Array) -> Array:
        """(n, 3) m, first part's frame: these points."""
        X = self.pose(D)
        own, far = self.probes
        return np.concatenate([own.points, far.points @ X[:3, :3].T + X[:3, 3]])

    def deepest(self, D: Array) -> float:
        """m: how deep the parts go into each other where they cross, or where points of one are inside the other."""
        if self.empty:
            return 0.0
        places = self.places(D)
        inside = self.heights(D, np.arange(len(places))) > self.loose
        found = [points for points in (self.crossing(D).segments(), places[inside]) if len(points)]
        return max((self.depth(D, points, finer=FINER) for points in found), default=0.0)

    def middle(self, D: Array, f: int, g: int) -> Array:
        """(3,) m, first part's frame: between two facets that count."""
        X = self.pose(D)
        own = self._meshes[0].vertices[self._meshes[0].faces[self.facets[0][f]]]
        far = self._meshes[1].vertices[self._meshes[1].faces[self.facets[1][g]]] @ X[:3, :3].T + X[:3, 3]
        return np.asarray(0.5 * (own.mean(axis=0) + far.mean(axis=0)))

    def crossing(self, D: Array, hits: Ints | None = None) -> Crossing:
        """Facets that count and cross at a displacement (4, 4), other than along mates; `hits`: where these are known."""
        hits = self.hits(D) if hits is None else hits
        if not len(hits):
            return NONE
        X = self.pose(D)
        f, g = self.facets[0][hits[:, 0]], self.facets[1][hits[:, 1]]
        first = self._meshes[0].vertices[self._meshes[0].faces[f]]
        second = self._meshes[1].vertices[self._meshes[1].faces[g]] @ X[:3, :3].T + X[:3, 3]
        normals = self._normals[0][hits[:, 0]], self._normals[1][hits[:, 1]] @ X[:3, :3].T
        found, segments = crossings(first, second, normals, 1e-9 * self.size)
        if not found.any():
            return NONE
        first_labels, second_labels = self._surfaces[0].labels[f[found]], self._surfaces[1].labels[g[found]]
        segments = segments[found]
        out: dict[SurfacePair, Array] = {}
        slack = self.scrape
        for pair in sorted(set(zip(first_labels.tolist(), second_labels.tolist(), strict=True))):
            own = segments[(first_labels == pair[0]) & (second_labels == pair[1])]
            own = own[~self._along_mate(pair, own)]
            if len(own):
                out[pair] = own
                slack = max(slack, sum(self._surfaces[k].surfaces[pair[k]].chord for k in (0, 1)))
        return Crossing(out, slack) if out else NONE

    def depth(self, D: Array, segments: Array, least: float = 0.0, finer: int = 1) -> float:
        """m: how deep the parts go into each other between `segments` (n, 2, 3) where they cross, or points (n, 3) inside
        either; 0 where it is not above `least`. Asked at `finer` times as many places."""
        points = segments.reshape(-1, 3)
        points = points[np.unique(np.linspace(0, len(points) - 1, finer * SAMPLES).astype(int))]
        a, b = np.triu_indices(len(points), 1)
        order = np.argsort(np.linalg.norm(points[a] - points[b], axis=1), kind="stable")
        # of near ones and far ones: parts may be thin, or deep in each other
        order = order[np.unique(np.linspace(0, len(order) - 1, finer * MIDDLES).astype(int))] if len(order) else order
        a, b = a[order], b[order]
        middles = 0.5 * (points[a] + points[b])
        X = self.pose(D)
        other = (middles - X[:3, 3]) @ X[:3, :3]
        own, far = self._shapes.index(self.names[0]), self._shapes.index(self.names[1])
        inside = np.flatnonzero(own.contains(middles))
        inside = inside[far.contains(other[inside])]
        inside = (
            inside[np.unique(np.linspace(0, len(inside) - 1, finer * INSIDE).astype(int))] if len(inside) else inside
        )
        total = own.whole().depths(middles[inside])[0] + far.whole().depths(other[inside])[0]
        deepest = float(total.max(initial=0.0))
        return deepest if deepest > least else 0.0

    def _along_mate(self, pair: SurfacePair, segments: Array) -> Flags:
        """(n,) which segments (n, 2, 3) lie on a mate that both surfaces belong to or border."""
        out = np.zeros(len(segments), dtype=bool)
        for mate, slack in zip(self._mates, self._slacks, strict=True):
            if pair[0] not in self._near[0][mate[0]] or pair[1] not in self._near[1][mate[1]]:
                continue
            if mate in self._bare and pair == mate:
                return np.ones(len(segments), dtype=bool)
            away = _distance(self._surfaces[0].surfaces[mate[0]], segments.reshape(-1, 3))
            if away is not None:
                out |= (away.reshape(-1, 2) <= slack).all(axis=1)
        return out


def _spheres(mesh: Mesh) -> tuple[Array, Array]:
    """About facets that lie together."""
    corners = mesh.vertices[mesh.faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    order = together(low, high)
    starts = np.unique(np.linspace(0, len(order), SPHERES, endpoint=False).astype(int))
    low, high = np.minimum.reduceat(low[order], starts), np.maximum.reduceat(high[order], starts)
    middle = 0.5 * (low + high)
    rank = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, len(order))))
    away = np.linalg.norm(corners[order] - middle[rank, None], axis=2).max(axis=1)
    return middle, np.maximum.reduceat(away, starts)


def _hits(first: fcl.CollisionObject, second: fcl.CollisionObject) -> Ints:
    """(n, 2) facets of two models that FCL finds to touch, each pair once, in order."""
    result = fcl.CollisionResult()
    fcl.collide(first, second, fcl.CollisionRequest(num_max_contacts=MOST, enable_contact=False), result)
    key = np.unique(np.array([(c.b1 << 32) + c.b2 for c in result.contacts], dtype=np.int64))
    return np.stack([key >> 32, key & 0xFFFFFFFF], axis=1)


_SHAPELESS = ("freeform", "other", "extrusion", "revolution", "torus", "helicoid")
"""Mates of these are left out as they are: their facets say no more than that they touch."""


def _distance(surface: Surface, points: Array) -> Array | None:
    """(n,) m distance of points (n, 3) from a plane, cylinder, cone or sphere; None for other kinds."""
    away = points - surface.point
    if surface.kind == "plane":
        return np.asarray(np.abs(away @ surface.axis))
    if surface.kind == "sphere":
        return np.asarray(np.abs(np.linalg.norm(away, axis=1) - surface.radius))
    if surface.kind not in ("cylinder", "cone"):
        return None
    height = away @ surface.axis
    across = np.linalg.norm(away - height[:, None] * surface.axis, axis=1)
    if surface.kind == "cylinder":
        return np.asarray(np.abs(across - surface.radius))
    return np.asarray(np.abs(across * np.cos(surface.half_angle) - height * np.sin(surface.half_angle)))
