"""Meshes of formats that trimesh reads: all bodies of a file in one. PLY and OFF have no unit."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from kinform.form.constants import LARGEST_NUMBER
from kinform.form.meshes.raw import REEXPORT, Fault, MeshError, RawMesh, is_coordinate, soup


def read_by_trimesh(data: bytes, kind: str) -> RawMesh:
    """Facets of a file of a kind such as "ply"; raises MeshError."""
    import trimesh

    if data.startswith(b"version https://git-lfs"):
        raise MeshError([Fault("is a pointer of Git LFS, not the mesh", "fetch it: git lfs pull")])
    try:
        scene: Any = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False)
        meshes = [item for item in scene.dump() if isinstance(item, trimesh.Trimesh)]
        corners = [np.asarray(mesh.vertices, dtype=np.float64)[np.asarray(mesh.faces)] for mesh in meshes]
    except Exception as error:  # readers of other people raise whatever they please
        words = " ".join(str(error).split()) or type(error).__name__
        raise MeshError([Fault(f"cannot be read as {kind.upper()}: {words[:200]}", REEXPORT)]) from None
    if not sum(map(len, corners)):
        raise MeshError([Fault("is empty: it has no triangle", REEXPORT)])
    every = np.concatenate(corners)
    if not is_coordinate(every).all():
        raise MeshError([Fault(f"has coordinates that are no finite numbers up to {LARGEST_NUMBER:g}", REEXPORT)])
    single = float(np.finfo(np.float32).eps) * float(np.abs(every).max())
    return soup(every, written=single)
