"""Meshes of formats that trimesh reads: all bodies of a file in one. PLY and OFF have no unit."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np

from kinform.form.constants import LARGEST_NUMBER
from kinform.form.meshes.raw import REEXPORT, Fault, MeshError, RawMesh, is_coordinate, soup
from kinform.foundation.colours import hexed


def read_by_trimesh(data: bytes, kind: str) -> RawMesh:
    """Facets of a file of a kind such as "ply"; raises MeshError."""
    import trimesh

    if data.startswith(b"version https://git-lfs"):
        raise MeshError([Fault("is a pointer of Git LFS, not the mesh", "fetch it: git lfs pull")])
    try:
        scene: Any = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False)
        meshes = [item for item in scene.dump() if isinstance(item, trimesh.Trimesh)]
        corners = [np.asarray(mesh.vertices, dtype=np.float64)[np.asarray(mesh.faces)] for mesh in meshes]
        colour = colour_of_mesh(max(meshes, key=lambda mesh: len(mesh.faces))) if meshes else None
    except Exception as error:  # readers of other people raise whatever they please
        words = " ".join(str(error).split()) or type(error).__name__
        raise MeshError([Fault(f"cannot be read as {kind.upper()}: {words[:200]}", REEXPORT)]) from None
    if not sum(map(len, corners)):
        raise MeshError([Fault("is empty: it has no triangle", REEXPORT)])
    every = np.concatenate(corners)
    if not is_coordinate(every).all():
        raise MeshError([Fault(f"has coordinates that are no finite numbers up to {LARGEST_NUMBER:g}", REEXPORT)])
    single = float(np.finfo(np.float32).eps) * float(np.abs(every).max())
    return replace(soup(every, written=single), colour=colour)


def colour_of_mesh(mesh: Any) -> str | None:
    """The colour that most facets of a mesh of trimesh have, or the one of its material; None where it has none."""
    look: Any = getattr(mesh, "visual", None)
    if not getattr(look, "defined", False):
        return None
    if look.kind == "texture":
        shade = getattr(look.material, "baseColorFactor", None)
        if shade is None:
            shade = getattr(look.material, "diffuse", None)
        return None if shade is None or len(shade) < 3 else hexed([float(v) / 255.0 for v in shade[:3]])
    if look.kind not in ("face", "vertex") or not len(mesh.faces):
        return None
    colours, counts = np.unique(np.asarray(look.face_colors)[:, :3], axis=0, return_counts=True)
    return hexed([float(v) / 255.0 for v in colours[int(np.argmax(counts))]])
