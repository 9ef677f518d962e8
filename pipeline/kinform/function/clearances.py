"""Distance between parts that move, by FCL, without the surfaces by which a pair mates.

Mating surfaces touch or nearly do wherever the pair is, and so do the edges beside them. A surface that mates counts
against all of the other part but the surfaces that it mates with, those that border on these, and those that it is
within the contact tolerance of at the pose of the meshes. Of the other facets, pairs are left out that are both within
that of the other part there. Each facet that is near there still meets all that is not. Where two parts overlap beyond
their mating surfaces nothing else is left out. A part that lies wholly inside another is not told from one outside:
surfaces are compared, not solids.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import fcl
import numpy as np

from kinform.foundation.current_work import working_on
from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_model, fcl_pose
from kinform.foundation.meshes.mesh_index import MeshIndex
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.model.assembly import Assembly, Mesh, Part
from kinform.model.contacts import Contacts
from kinform.model.surfaces import MeshSurfaces
from kinform.requirements.evidence import Nearest

GRID = 8
"""Divisions of a triangle's side by points between which a place to look at is found; a choice."""


_GRID = np.array([[i, j, GRID - i - j] for i in range(GRID + 1) for j in range(GRID + 1 - i)]) / GRID


@dataclass(frozen=True, eq=False)
class _Side:
    """Some facets of a part."""

    model: fcl.BVHModel
    corners: Array
    """(8, 3) of their box, in the part frame."""
    triangles: Array
    """(f, 3, 3) corners of the facets, in the part frame."""


@dataclass(frozen=True, eq=False)
class _Pair:
    """Two parts, and the two pairs of facet sets between which the distance counts."""

    first: Part
    second: Part
    tests: tuple[tuple[_Side, _Side], ...]
    mates: int = 0
    """Pairs of surfaces by which they mate, between which the distance does not count."""


@dataclass(frozen=True, eq=False)
class Apart:
    """Two groups of parts, each rigid."""

    pairs: tuple[_Pair, ...]
    centre: Array
    """(3,) m: of a ball that holds the second group at the pose of the meshes."""
    radius: float
    size: float
    """m: diagonal of the smaller group."""

    @property
    def left_out(self) -> tuple[tuple[str, str], ...]:
        """Pairs of parts of which the surfaces by which they mate do not count against each other, sorted."""
        return tuple(sorted((pair.first.name, pair.second.name) for pair in self.pairs if pair.mates))

    def at(self, X: Array, enough: float = np.inf) -> Nearest:
        """The least distance when the second group is displaced by X (4, 4) relative to the first. Where it is more
        than `enough`, a bound from below will do."""
        best = Nearest(np.inf, ("", ""), np.zeros(3))
        tests = []
        for pair in self.pairs:
            X_second = X @ pair.second.X_WP
            for a, b in pair.tests:
                tests.append((_boxes_apart(a.corners, pair.first.X_WP, b.corners, X_second), pair, a, b, X_second))
        # the nearest boxes first: most of the others need not be asked
        for low, pair, a, b, X_second in sorted(tests, key=lambda test: test[0]):
            names = (pair.first.name, pair.second.name)
            if low >= best.distance:
                break
            if low > enough:
                return Nearest(low, names, best.place)
            with working_on(*names):
                distance, facets = _distance(a, pair.first.X_WP, b, X_second)
            if distance < best.distance:
                place = _between(_corners_at(a, facets[0], pair.first.X_WP), _corners_at(b, facets[1], X_second))
                best = Nearest(distance, names, place)
        return best


def apart(
    assembly: Assembly,
    contacts: Contacts,
    surfaces: Mapping[str, MeshSurfaces],
    first: Sequence[str],
    second: Sequence[str],
) -> Apart | None:
    """The two groups of parts, as far as they have meshes; None where one has none."""
    sides = [[p for p in assembly.parts if p.name in names and _has_facets(p)] for names in (first, second)]
    if not sides[0] or not sides[1]:
        return None
    shared: dict[tuple[str, bytes], _Side] = {}
    pairs = tuple(_pair(a, b, contacts, surfaces, shared) for a in sides[0] for b in sides[1])
    points = np.concatenate([_corners(p.mesh.vertices, p.X_WP) for p in sides[1] if p.mesh is not None])
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    of_first = np.concatenate([_corners(p.mesh.vertices, p.X_WP) for p in sides[0] if p.mesh is not None])
    size = min(float(np.linalg.norm(np.ptp(group, axis=0))) for group in (of_first, points))
    return Apart(pairs, centre, float(np.linalg.norm(points - centre, axis=1).max()), size)


def _has_facets(part: Part) -> bool:
    return part.mesh is not None and len(part.mesh.faces) > 0


def _pair(
    a: Part, b: Part, contacts: Contacts, surfaces: Mapping[str, MeshSurfaces], shared: dict[tuple[str, bytes], _Side]
) -> _Pair:
    """The facets of two parts that count against each other."""
    assert a.mesh is not None
    assert b.mesh is not None
    names = (a.name, b.name) if a.name < b.name else (b.name, a.name)
    swapped = names[0] != a.name
    mates = [p.surfaces for p in contacts.patches if p.parts == names]
    keep_a = _without(a.mesh, surfaces, {s[1 if swapped else 0] for s in mates})
    keep_b = _without(b.mesh, surfaces, {s[0 if swapped else 1] for s in mates})
    overlapping = any(i.parts == names and not i.mated for i in contacts.interferences)
    if names not in contacts.tolerance or overlapping:
        tests = [(keep_a, keep_b)]
    else:
        with working_on(*names):
            near_a, near_b = _near(a, keep_a, b, keep_b, contacts.tolerance[names])
        tests = [(keep_a & ~near_a, keep_b)]
        if near_a.any():
            tests.append((near_a, keep_b & ~near_b))
    paired = sorted({(s[1], s[0]) if swapped else (s[0], s[1]) for s in mates})
    tolerance = contacts.tolerance.get(names, 0.0)
    tests += _mating(a, b, surfaces, paired, tolerance)
    tests += [(one, other) for other, one in _mating(b, a, surfaces, [(j, i) for i, j in paired], tolerance)]
    sides = [
        (_side(a.mesh, one, shared), _side(b.mesh, other, shared)) for one, other in tests if one.any() and other.any()
    ]
    return _Pair(a, b, tuple(sides), len(paired))


def _mating(
    a: Part, b: Part, surfaces: Mapping[str, MeshSurfaces], paired: Sequence[tuple[int, int]], tolerance: float
) -> list[tuple[Flags, Flags]]:
    """Facets of each surface of `a` that mates (`paired` with one of `b`), and those of `b` that are nothing to its
    mates."""
    assert a.mesh is not None
    assert b.mesh is not None
    of_a, of_b = surfaces.get(a.mesh.digest), surfaces.get(b.mesh.digest)
    if of_a is None or of_b is None or not paired:
        return []
    index = MeshIndex(b.mesh)
    together: dict[bytes, tuple[Flags, Flags]] = {}
    for surface in sorted({i for i, _ in paired}):
        mates = {j for i, j in paired if i == surface}
        beside = mates | {k for j in mates for k in index.neighbours(of_b, j)}
        mine = of_a.labels == surface
        far = ~np.isin(of_b.labels, sorted(beside))
        touched = _near(a, mine, b, far, tolerance)[1] if far.any() else far
        far &= ~np.isin(of_b.labels, np.unique(of_b.labels[touched]))
        before = together.get(far.tobytes())
        together[far.tobytes()] = (mine if before is None else before[0] | mine, far)
    return [together[key] for key in sorted(together)]


def _without(mesh: Mesh, surfaces: Mapping[str, MeshSurfaces], mated: set[int]) -> Flags:
    keep = np.ones(len(mesh.faces), dtype=np.bool_)
    of_mesh = surfaces.get(mesh.digest)
    for k in mated:
        if of_mesh is not None and 0 <= k < len(of_mesh.surfaces):
            keep[of_mesh.surfaces[k].faces] = False
    return keep


def _near(a: Part, keep_a: Flags, b: Part, keep_b: Flags, tolerance: float) -> tuple[Flags, Flags]:
    """Facets that come within the tolerance of a kept facet of the other part, at the pose of the meshes."""
    near_a, near_b = np.zeros_like(keep_a), np.zeros_like(keep_b)
    tri_a, tri_b = _triangles(a), _triangles(b)
    for _ in range(2):
        # what is out of the box of the others need not be asked
        keep_a = keep_a & _inside(tri_a, tri_b[keep_b], tolerance)
        keep_b = keep_b & _inside(tri_b, tri_a[keep_a], tolerance)
    if keep_a.any() and keep_b.any():
        near_a[keep_a] = _within(tri_a[keep_a], tri_b[keep_b], tolerance)
        near_b[keep_b] = _within(tri_b[keep_b], tri_a[keep_a], tolerance)
    return near_a, near_b


def _inside(triangles: Array, others: Array, tolerance: float) -> Flags:
    """Which triangles (n, 3, 3) come within the tolerance of the box around the others."""
    if not len(others):
        return np.zeros(len(triangles), dtype=np.bool_)
    low, high = others.min(axis=(0, 1)) - tolerance, others.max(axis=(0, 1)) + tolerance
    return np.asarray(((triangles.max(axis=1) >= low) & (triangles.min(axis=1) <= high)).all(axis=1))


def _within(triangles: Array, others: Array, tolerance: float) -> Flags:
    """Which triangles (n, 3, 3) are within the tolerance of any of the others."""
    model = fcl_model(others.reshape(-1, 3), np.arange(3 * len(others)).reshape(-1, 3))
    whole = fcl.CollisionObject(model)
    out = np.zeros(len(triangles), dtype=np.bool_)
    for k, corners in enumerate(triangles):
        one = fcl.CollisionObject(fcl_model(corners, np.array([[0, 1, 2]])))
        out[k] = fcl_distance(one, whole) <= tolerance
    return out


def _triangles(part: Part) -> Array:
    assert part.mesh is not None
    world = part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]
    return np.asarray(world[part.mesh.faces])


def _side(mesh: Mesh, keep: Flags, shared: dict[tuple[str, bytes], _Side]) -> _Side:
    """The kept facets of a mesh; one model for all parts that keep the same."""
    key = (mesh.digest, np.packbits(keep).tobytes())
    if key not in shared:
        corners = mesh.vertices[mesh.faces[keep]]
        points = corners.reshape(-1, 3)
        model = fcl_model(points, np.arange(len(points)).reshape(-1, 3))
        shared[key] = _Side(model, _corners(points, np.eye(4)), corners)
    return shared[key]


def _corners(points: Array, X: Array) -> Array:
    """(8, 3) of the box around points, displaced."""
    low, high = points.min(axis=0), points.max(axis=0)
    box = np.array([[(low, high)[(k >> d) & 1][d] for d in range(3)] for k in range(8)])
    return np.asarray(box @ X[:3, :3].T + X[:3, 3])


def _boxes_apart(a: Array, X_a: Array, b: Array, X_b: Array) -> float:
    """Distance of the boxes along the world's axes around two sets of corners: none of the facets are nearer."""
    wa, wb = a @ X_a[:3, :3].T + X_a[:3, 3], b @ X_b[:3, :3].T + X_b[:3, 3]
    gap = np.maximum(wa.min(axis=0) - wb.max(axis=0), wb.min(axis=0) - wa.max(axis=0))
    return float(np.linalg.norm(np.maximum(gap, 0.0)))


def _distance(a: _Side, X_a: Array, b: _Side, X_b: Array) -> tuple[float, tuple[int, int]]:
    """Distance (0 where they cross), and the facets between which it is."""
    result = fcl.DistanceResult()
    objects = [fcl.CollisionObject(side.model, fcl_pose(X)) for side, X in ((a, X_a), (b, X_b))]
    distance = fcl_distance(objects[0], objects[1], result)
    facets = [k if 0 <= k < len(side.triangles) else 0 for k, side in ((int(result.b1), a), (int(result.b2), b))]
    return distance, (facets[0], facets[1])


def _corners_at(side: _Side, facet: int, X: Array) -> Array:
    return np.asarray(side.triangles[facet] @ X[:3, :3].T + X[:3, 3])


def _between(first: Array, second: Array) -> Array:
    """A place between two triangles (3, 3), to about a tenth of their size: for people to look at."""
    a, b = _GRID @ first, _GRID @ second
    apart = np.linalg.norm(a[:, None] - b[None], axis=2)
    i, j = np.unravel_index(int(apart.argmin()), apart.shape)
    return np.asarray(0.5 * (a[i] + b[j]))
