"""Small assemblies of meshes, made with manifold3d at random pose and size, through surfaces and contacts to joints."""

from __future__ import annotations

import hashlib

import numpy as np
from manifold3d import CrossSection, Manifold
from scipy.spatial.transform import Rotation

from kinform import contacts, kinematics, surfaces
from kinform.model.assembly import Mesh, MeshHealth, Part
from support.assemblies import HERE, assembly


def box(x0, x1, y0, y1, z0, z1):
    return Manifold.cube((x1 - x0, y1 - y0, z1 - z0)).translate((x0, y0, z0))


def rod(radius, z0, z1, segments=40, phase=0.0):
    return Manifold.cylinder(z1 - z0, radius, radius, segments).rotate((0, 0, phase)).translate((0, 0, z0))


def ball(radius, segments=40, phase=0.0):
    half = np.linspace(-np.pi / 2, np.pi / 2, segments // 2 + 1)
    outline = np.stack([radius * np.cos(half), radius * np.sin(half)], axis=1)
    outline[[0, -1], 0] = 0.0
    return Manifold.revolve(CrossSection([outline]), segments).rotate((0, 0, phase))


def extrusion(outline, z0, z1):
    return Manifold.extrude(CrossSection([np.asarray(outline, float)]), z1 - z0).translate((0, 0, z0))


def part(name, solid, X, scale=1e-3):
    """The solid (mm, times scale) under the pose X, baked into its vertices, in float64."""
    mesh = solid.to_mesh64()
    vertices = np.asarray(mesh.vert_properties, float)[:, :3] * scale @ X[:3, :3].T + X[:3, 3]
    faces = np.asarray(mesh.tri_verts, dtype=np.int64)
    digest = hashlib.sha256(vertices.tobytes() + faces.tobytes()).hexdigest()
    volume = solid.volume() * scale**3
    health = MeshHealth(len(faces), len(vertices), True, True, "NoError", volume, 0, 0, 0, 0, 1, 1e-9)
    return Part(
        name, Mesh(vertices, faces, health, f"{name}.stl", None, digest), np.eye(4), True, None, 1000.0, None, "m", HERE
    )


def random_pose(rng, reach=0.1):
    X = np.eye(4)
    X[:3, :3] = Rotation.random(random_state=rng).as_matrix()
    X[:3, 3] = reach * rng.normal(size=3)
    return X


def derived(X=None, scale=1e-3, groups=(), **solids):
    """Kinematics and contacts of the named solids, all under one pose."""
    X = np.eye(4) if X is None else X
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()), groups=groups)
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    return kinematics.derive(made, found, touching), touching
