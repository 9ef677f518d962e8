"""`/surfaces`: the analytic surfaces of each distinct mesh, in its part frame."""

from __future__ import annotations

import h5py

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.model.surfaces import MeshSurfaces
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout, Ragged, Table
from kinform.results.table import FACETS


@dataclass(frozen=True, eq=False)
class _Mesh(MeshSurfaces):
    """The surfaces of one mesh, and from what they were made."""

    fingerprint: str | None


@dataclass(frozen=True)
class _Meshes:
    """Sorted by digest."""

    meshes: tuple[_Mesh, ...]


FIRST = ("kind", "axis", "point", "radius", "half_angle", "minor_radius", "pitch")
"""Columns of a surface that the file has in another order than the class."""
LAYOUT = Layout(
    _Meshes,
    Table(
        "meshes",
        Ragged("labels", dtype=FACETS),
        Table("surfaces", Ragged("faces", dtype=FACETS), owner="mesh", first=FIRST),
    ),
)


def write(group: h5py.Group, design: Design) -> None:
    """Write the surfaces of all meshes, sorted by digest, with the fingerprint of each mesh."""
    marks = design.fingerprints.meshes
    meshes = (_Mesh(**vars(mesh), fingerprint=marks.get(key)) for key, mesh in sorted(design.surfaces.items()))
    LAYOUT.write(group, _Meshes(tuple(meshes)))


def read(group: HeldGroup) -> tuple[dict[str, MeshSurfaces], dict[str, str]]:
    """The surfaces by mesh digest, and the fingerprints by mesh digest."""
    meshes: tuple[_Mesh, ...] = LAYOUT.read(group).meshes
    surfaces = {mesh.digest: MeshSurfaces(mesh.digest, mesh.surfaces, mesh.labels, mesh.noise) for mesh in meshes}
    return surfaces, {mesh.digest: mesh.fingerprint for mesh in meshes if mesh.fingerprint is not None}
