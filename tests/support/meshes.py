"""Meshes with known surfaces, made with manifold3d or by hand."""

from __future__ import annotations

import hashlib

import numpy as np

from kinform.form.meshes.health import build_mesh
from kinform.form.meshes.raw import RawMesh
from support.solids import centred_rod


def mesh_of(vertices, faces, pose=None, scale=1.0, rounding=False):
    """A welded mesh; `pose` (4, 4) and float32 rounding as a file would have it."""
    vertices = np.asarray(vertices, float) * scale
    if pose is not None:
        vertices = vertices @ pose[:3, :3].T + pose[:3, 3]
    if rounding:
        vertices = vertices.astype(np.float32)
    return build_mesh(RawMesh(vertices, np.asarray(faces, np.int64)), 1.0, None, path="made", body=None, solid=False)


def of_manifold(solid, **keys):
    """Mesh of a manifold3d solid."""
    mesh = solid.to_mesh64()
    return mesh_of(mesh.vert_properties[:, :3], mesh.tri_verts, **keys)


def rod(radius, length, segments, **keys):
    return of_manifold(centred_rod(radius, length, segments), **keys)


def kinds(surfaces, share=0.0):
    """How many surfaces of each kind have more than this share of the area."""
    total = sum(s.area for s in surfaces.surfaces)
    out = {}
    for s in surfaces.surfaces:
        if s.area > share * total:
            out[s.kind] = out.get(s.kind, 0) + 1
    return out


def digest(text):
    return hashlib.sha256(text.encode()).hexdigest()
