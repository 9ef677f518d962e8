"""Primitives that an MJCF has fitted to meshes: a `<geom>` with a mesh and the type of a primitive.

MuJoCo puts the primitive at the centre of mass of the mesh, along its principal axes with the longest as z. Its size is
that of the box of the same inertia, or with `fitaabb` of the box around the mesh, as `mjCMesh::FitGeom` has it
(MuJoCo 2.1.2 to 4.0). Where two principal moments are equal the axes across are any, there and here.
"""

from __future__ import annotations

import numpy as np

from kinform.formats.description.poses import pose
from kinform.formats.description.robot import Solid
from kinform.foundation.meshes.hulls import hull_of
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints

FITTED = ("sphere", "capsule", "cylinder", "ellipsoid", "box")
"""Types of geoms that are fitted to a mesh."""

INERTIAS = ("legacy", "exact", "convex", "shell")
"""Ways of MuJoCo to the inertia of a mesh, the usual one first."""


@dataclass(frozen=True, eq=False)
class Fit:
    """A primitive and its pose (4, 4) in the frame of the mesh."""

    solid: Solid
    X: Array


def fitted(kind: str, vertices: Array, faces: Ints, inertia: str, scale: float, *, around: bool) -> Fit | None:
    """The primitive of a kind that is fitted to a mesh with vertices (n, 3) m; None where that is flat.

    `inertia` is one of INERTIAS, `scale` what the size is multiplied by, and `around` means the box around the mesh.
    """
    if inertia == "convex":
        hull = hull_of(vertices)
        if hull is None:
            return None
        from scipy.spatial import ConvexHull

        whole = ConvexHull(hull.corners)
        vertices, faces = hull.corners, _outward(hull.corners, np.asarray(whole.simplices, np.int64))
    found = _inertia_box(vertices[faces], inertia)
    if found is None:
        return None
    half, X = found
    if around:
        local = (vertices - X[:3, 3]) @ X[:3, :3]
        low, high = local.min(axis=0), local.max(axis=0)
        half, X = 0.5 * (high - low), X @ pose(np.eye(3), 0.5 * (low + high))
    # Thickness of a mesh over its length below which no primitive is fitted to it: MuJoCo refuses sizes of nearly zero,
    # and meshes in single precision have no less.
    if half.min() <= 1e-6 * half.max():
        return None
    sizes = tuple(scale * size for size in _sizes(kind, half, around=around))
    if sizes[-1] == 0.0:  # a capsule of nothing but its caps
        return Fit(Solid("sphere", sizes[:1]), X)
    return Fit(Solid(kind, sizes), X)


def _sizes(kind: str, half: Array, *, around: bool) -> tuple[float, ...]:
    """The sizes of a `Solid` of half the sides (3,) of a box, the longest last unless it is `around` the mesh."""
    x, y, z = map(float, half)
    if kind == "box":
        return 2.0 * x, 2.0 * y, 2.0 * z
    if kind == "ellipsoid":
        return x, y, z
    if kind == "sphere":
        return (max(x, y, z) if around else (x + y + z) / 3.0,)
    radius = max(x, y) if around else 0.5 * (x + y)
    caps = 0.0 if kind == "cylinder" else radius if around else 0.5 * radius
    return radius, 2.0 * max(z - caps, 0.0)


def _outward(corners: Array, faces: Ints) -> Ints:
    """Facets of a hull, wound so that they face out of it."""
    a, b, c = (corners[faces[:, k]] for k in range(3))
    inside = np.einsum("ij,ij->i", a - corners.mean(axis=0), np.cross(b - a, c - a)) < 0.0
    return np.where(inside[:, None], faces[:, ::-1], faces)


def _inertia_box(corners: Array, inertia: str) -> tuple[Array, Array] | None:
    """Half the sides (3,) m of the box with the inertia of a mesh of facets (F, 3, 3) m, the longest last, and its pose
    (4, 4): z along it. None where there is no mass."""
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = 0.5 * np.linalg.norm(doubled, axis=1)
    if not areas.sum() > 0.0:
        return None
    middle = areas @ corners.mean(axis=1) / areas.sum()
    if inertia == "shell":
        return _box_of(areas, corners, middle, np.zeros((0, 3)))
    seen = corners - middle
    masses = np.einsum("ij,ij->i", seen[:, 0], doubled) / 6.0
    masses = np.abs(masses) if inertia == "legacy" else masses * np.sign(masses.sum() or 1.0)
    if not masses.sum() > 0.0:
        return None
    centre = middle + masses @ seen.sum(axis=1) / (4.0 * masses.sum())
    seen = corners - centre
    masses = np.einsum("ij,ij->i", seen[:, 0], doubled) / 6.0
    masses = np.abs(masses) if inertia == "legacy" else masses * np.sign(masses.sum() or 1.0)
    return _box_of(masses, corners, centre, np.zeros((1, 3)))


def _box_of(masses: Array, corners: Array, centre: Array, apex: Array) -> tuple[Array, Array] | None:
    """As `_inertia_box`, of triangles, or of tetrahedra with an apex (1, 3) at the centre, and their masses (F,)."""
    seen = corners - centre
    if len(apex):
        seen = np.concatenate([seen, np.broadcast_to(apex, (len(seen), 1, 3))], axis=1)
    n = seen.shape[1]
    total = seen.sum(axis=1)
    # of a simplex with n corners: ∫ x xᵀ = m/(n(n+1))·(Σ v vᵀ + Σv Σvᵀ)
    second = np.einsum("f,fni,fnj->ij", masses, seen, seen) + np.einsum("f,fi,fj->ij", masses, total, total)
    second /= n * (n + 1) * masses.sum()
    spread, axes = np.linalg.eigh(second)
    if spread[2] <= 0.0:
        return None
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] = -axes[:, 0]
    return np.sqrt(3.0 * np.maximum(spread, 0.0)), pose(axes, centre)
