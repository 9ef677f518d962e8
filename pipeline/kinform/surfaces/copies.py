"""Meshes that are one shape in several poses: what is recovered for one holds for all.

Copies of a part keep the order of its facets, also where the pose is baked into the file. So vertices in the
order in which facets first name them correspond, and a rigid fit (Kabsch 1976) confirms or refutes it.
"""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.vectors import canonical_sign
from kinform.foundation.constants import COVERAGE, EPS32
from kinform.foundation.records import altered
from kinform.foundation.rounding import SOLVED, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, freeze
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces, Surface

COPY_ROUNDINGS = 2
"""Roundings of the largest coordinate by which a vertex of a copy may be off: one of the original, one of the copy."""


TURNS = ("cylinder", "torus", "revolution", "extrusion", "helicoid")
"""Kinds whose axis has no sense of its own."""


@dataclass(frozen=True, eq=False)
class Copy:
    """One mesh as a copy of another."""

    of: str
    """Digest of the mesh that it is a copy of."""
    X_CO: Array
    """(4, 4) from the frame of that mesh to that of the copy."""
    turn_uncertainty: float
    """rad."""
    shift_uncertainty: float
    """m."""


def rigid_copies(meshes: Mapping[str, Mesh]) -> dict[str, Copy]:
    """The copies among meshes by digest; of each shape the mesh of the lowest digest is no copy."""
    by_size: dict[tuple[int, int], list[str]] = {}
    for digest in sorted(meshes):
        mesh = meshes[digest]
        by_size.setdefault((len(mesh.vertices), len(mesh.faces)), []).append(digest)
    copies: dict[str, Copy] = {}
    for group in by_size.values():
        if len(group) > 1 and len(meshes[group[0]].faces):
            for alike in _alike(meshes, group):
                copies |= _copies(meshes, alike)
    return copies


def _alike(meshes: Mapping[str, Mesh], group: list[str]) -> list[list[str]]:
    """Those of a group that could be copies by the scatter of their vertices alone, in sets of at least two: what
    `_Originals` asks first, which settles most."""
    sizes = {}
    for digest in group:
        mesh = meshes[digest]
        named = np.zeros(len(mesh.vertices), dtype=np.bool_)
        named[mesh.faces] = True
        # by rows: numpy is several times slower along the first axis of (n, 3)
        points = np.array((mesh.vertices if named.all() else mesh.vertices[named]).T, order="C")
        rounding = _rounding(mesh, float(np.abs(points).max()))
        points -= points.mean(axis=1, keepdims=True)
        sizes[digest] = (float(np.sqrt(np.einsum("ij,ij->", points, points) / points.shape[1])), rounding)
    ordered = sorted(group, key=lambda digest: (sizes[digest][0], digest))
    # twice the roundings of a vertex, for the rounding of sums
    allowed = 4 * max(rounding for _, rounding in sizes.values())
    sets: list[list[str]] = [[ordered[0]]]
    for before, digest in itertools.pairwise(ordered):
        if sizes[digest][0] - sizes[before][0] > allowed:
            sets.append([])
        sets[-1].append(digest)
    return [sorted(alike) for alike in sets if len(alike) > 1]


@dataclass(frozen=True, eq=False)
class _Cloud:
    """The vertices of a mesh, in the order in which facets first name them."""

    digest: str
    middle: Array
    """(3,) m: their mean."""
    about: Array
    """(n, 3) m from there."""
    size: float
    """m: their scatter."""
    rounding: float
    """m, of its coordinates."""

    @staticmethod
    def of(mesh: Mesh, order: NDArray[np.int64]) -> _Cloud:
        """That of a mesh, by the places (n,) of its vertices in their order."""
        points = mesh.vertices[order]
        middle = points.mean(axis=0)
        about = points - middle
        size = float(np.sqrt((about**2).sum() / len(about)))
        return _Cloud(mesh.digest, middle, about, size, _rounding(mesh, float(np.abs(points).max())))


def _rounding(mesh: Mesh, far: float) -> float:
    """m, of coordinates up to `far` (m) as its file has them in single precision: the mesh may lie far from its origin.
    Coarser numbers are not taken for more: a radius is better known than one of its vertices."""
    return EPS32 * (far + float(np.abs(mesh.origin).max()))


class _Originals:
    """Shapes that are no copies of each other, in the order in which they were met, and what tells most apart."""

    def __init__(self) -> None:
        self.clouds: list[_Cloud] = []
        self._sizes = np.empty((2, 4))

    def add(self, cloud: _Cloud) -> None:
        """One more."""
        count = len(self.clouds)
        if count == self._sizes.shape[1]:
            self._sizes = np.tile(self._sizes, 2)
        self._sizes[:, count] = cloud.size, cloud.rounding
        self.clouds.append(cloud)

    def copied(self, cloud: _Cloud) -> Copy | None:
        """The cloud as a copy of the first of these that it is one of."""
        size, rounding = self._sizes[:, : len(self.clouds)]
        near = np.abs(cloud.size - size) <= COPY_ROUNDINGS * np.maximum(rounding, cloud.rounding)
        fits = (_rigid_fit(self.clouds[k], cloud) for k in near.nonzero()[0])
        return next((copy for copy in fits if copy is not None), None)


def _copies(meshes: Mapping[str, Mesh], group: list[str]) -> dict[str, Copy]:
    out: dict[str, Copy] = {}
    shapes: dict[str, _Originals] = {}
    for digest in group:
        order, form = _naming_order(meshes[digest])
        cloud = _Cloud.of(meshes[digest], order)
        originals = shapes.setdefault(form, _Originals())
        copy = originals.copied(cloud)
        if copy is None:
            originals.add(cloud)
        else:
            out[digest] = copy
    return out


def _naming_order(mesh: Mesh) -> tuple[NDArray[np.int64], str]:
    """Vertices in the order in which facets first name them, and a digest of the facets under those numbers."""
    corners = mesh.faces.ravel()
    first = np.full(len(mesh.vertices), len(corners), np.int64)
    first[corners[::-1]] = np.arange(len(corners) - 1, -1, -1)
    order = np.argsort(first, kind="stable")[: np.count_nonzero(first < len(corners))]
    number = np.empty(len(mesh.vertices), np.int64)
    number[order] = np.arange(len(order))
    return order, hashlib.sha256(number[corners].tobytes()).hexdigest()


def _rigid_fit(reference: _Cloud, copy: _Cloud) -> Copy | None:
    """The rigid motion from `reference` to `copy`, of the same scatter, if it explains all vertices to within their
    rounding."""
    a, b = reference.about, copy.about
    u, spread, vt = np.linalg.svd(a.T @ b)
    sense = np.sign(np.linalg.det(u @ vt))
    if sense < 0 and spread[2] > SOLVED * spread[0]:
        return None
    R_CO = (u * np.array([1.0, 1.0, sense])) @ vt
    R_CO = R_CO.T
    off = b - a @ R_CO.T
    if np.abs(off).max() > COPY_ROUNDINGS * max(reference.rounding, copy.rounding):
        return None
    X_CO = np.eye(4)
    X_CO[:3, :3], X_CO[:3, 3] = R_CO, copy.middle - R_CO @ reference.middle
    scatter = COVERAGE * float(np.sqrt((off**2).sum() / len(off))) / np.sqrt(len(off))
    freeze(X_CO)
    return Copy(reference.digest, X_CO, scatter / max(float(np.sqrt(spread[1] / len(a))), TINY), scatter)


def surfaces_of_copy(surfaces: MeshSurfaces, digest: str, copy: Copy) -> MeshSurfaces:
    """The surfaces of a mesh as those of its copy, which has this digest."""
    return MeshSurfaces(
        digest, tuple(_surface_of_copy(surface, copy) for surface in surfaces.surfaces), surfaces.labels, surfaces.noise
    )


def turned_surfaces(surfaces: MeshSurfaces, digest: str, R_CO: Array) -> MeshSurfaces:
    """The surfaces of a mesh as those of the mesh of this digest, which is it turned by `R_CO` (3, 3)."""
    X_CO = np.eye(4)
    X_CO[:3, :3] = R_CO
    return surfaces_of_copy(surfaces, digest, Copy(surfaces.digest, X_CO, 0.0, 0.0))


def _surface_of_copy(surface: Surface, copy: Copy) -> Surface:
    if not surface.axis.any() and not surface.point.any() and surface.kind == "freeform":
        return surface
    R_CO = copy.X_CO[:3, :3]
    axis, point = R_CO @ surface.axis, R_CO @ surface.point + copy.X_CO[:3, 3]
    extent = surface.extent
    if surface.kind in TURNS and canonical_sign(axis) < 0:
        axis, extent = -axis, (-extent[1], -extent[0])
    axis, point = axis + 0.0, point + 0.0
    for array in (axis, point):
        freeze(array)
    has_axis = bool(surface.axis.any())
    return altered(
        surface,
        axis=axis,
        point=point,
        extent=extent,
        axis_uncertainty=min(surface.axis_uncertainty + copy.turn_uncertainty * has_axis, np.pi / 2),
        point_uncertainty=surface.point_uncertainty + copy.shift_uncertainty,
    )
