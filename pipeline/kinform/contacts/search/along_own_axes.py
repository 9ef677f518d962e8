"""Parts in frames that turn with them, so that what touches does not depend on how their files are turned."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import replace

import numpy as np

from kinform.foundation.meshes.own_axes import own_axes
from kinform.model.arrays import Array, freeze
from kinform.model.assembly import Assembly, Mesh, Part
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces


def along_own_axes(
    names: Set[PartName], assembly: Assembly, surfaces: dict[str, MeshSurfaces]
) -> tuple[dict[PartName, Part], dict[str, MeshSurfaces]]:
    """The parts of these names, with their meshes turned into axes of their own, and the surfaces of these meshes by
    digest. Where the parts are in the world stays the same."""
    from kinform.surfaces.copies import turned_surfaces

    parts = {part.name: part for part in assembly.parts}
    out: dict[PartName, Part] = {}
    turned: dict[str, tuple[Mesh, Array]] = {}
    found: dict[str, MeshSurfaces] = {}
    for name in sorted(names):
        part = parts[name]
        if part.mesh is None or not len(part.mesh.faces):
            out[name] = part
            continue
        digest = part.mesh.digest
        if digest not in turned:
            axes = own_axes(part.mesh.vertices, part.mesh.faces)
            turned[digest] = _turned(part.mesh, axes), axes
            found[turned[digest][0].digest] = turned_surfaces(surfaces[digest], turned[digest][0].digest, axes)
        mesh, axes = turned[digest]
        X_WP = part.X_WP.copy()
        X_WP[:3, :3] = X_WP[:3, :3] @ axes.T
        out[name] = replace(part, mesh=mesh, X_WP=np.asarray(freeze(X_WP)))
    return out, found


def _turned(mesh: Mesh, axes: Array) -> Mesh:
    """The mesh in coordinates along these axes (3, 3), given row by row."""
    vertices = np.ascontiguousarray(mesh.vertices @ axes.T)
    return replace(mesh, vertices=np.asarray(freeze(vertices)), digest=f"{mesh.digest} along its own axes")
