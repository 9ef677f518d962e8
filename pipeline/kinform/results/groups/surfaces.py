"""`/surfaces`: the analytic surfaces of each distinct mesh, in its part frame."""

from __future__ import annotations

from collections.abc import Mapping

import h5py

from kinform.model.surfaces import MeshSurfaces, Surface
from kinform.results.table import (
    FACETS,
    integer,
    pair,
    read_ragged,
    read_rows,
    real,
    text,
    vector,
    write_ragged,
    write_rows,
)

__all__ = ["read", "write"]

_MESHES = (text("digest"), real("noise", "m"), text("fingerprint"))
_SURFACES = (
    integer("mesh"), text("kind"), vector("axis", "1"), vector("point", "m"), real("radius", "m"),
    real("half_angle", "rad"), real("minor_radius", "m"), real("pitch", "m"), integer("side"), real("area", "m²"),
    pair("extent", real, ("extent_from", "extent_to"), "m"), real("sweep", "rad"), real("residual", "m"),
    real("axis_uncertainty", "rad"), real("point_uncertainty", "m"), real("chord", "m"),
)  # fmt: skip


def write(group: h5py.Group, surfaces: Mapping[str, MeshSurfaces], fingerprints: Mapping[str, str]) -> None:
    """Write the surfaces of all meshes, sorted by digest, with the fingerprint of each mesh."""
    meshes = [surfaces[digest] for digest in sorted(surfaces)]
    write_rows(
        group,
        "meshes",
        _MESHES,
        [vars(mesh) | {"fingerprint": fingerprints.get(mesh.digest)} for mesh in meshes],
    )
    write_ragged(group, "labels", [mesh.labels for mesh in meshes], "1", dtype=FACETS)
    rows = [vars(surface) | {"mesh": i} for i, mesh in enumerate(meshes) for surface in mesh.surfaces]
    write_rows(group, "surfaces", _SURFACES, rows)
    write_ragged(group, "faces", [row["faces"] for row in rows], "1", dtype=FACETS)


def read(group: h5py.Group) -> tuple[dict[str, MeshSurfaces], dict[str, str]]:
    """The surfaces by mesh digest, and the fingerprints by mesh digest."""
    meshes = read_rows(group, "meshes", _MESHES)
    owned: list[list[Surface]] = [[] for _ in meshes]
    rows = read_rows(group, "surfaces", _SURFACES)
    for row, faces in zip(rows, read_ragged(group, "faces"), strict=True):
        owned[row.pop("mesh")].append(Surface(**row, faces=faces))
    surfaces = {
        mesh["digest"]: MeshSurfaces(mesh["digest"], tuple(own), labels, mesh["noise"])
        for mesh, own, labels in zip(meshes, owned, read_ragged(group, "labels"), strict=True)
    }
    fingerprints = {mesh["digest"]: mesh["fingerprint"] for mesh in meshes if mesh["fingerprint"] is not None}
    return surfaces, fingerprints
