"""Small assemblies of meshes, made with manifold3d at random pose and size, through surfaces and contacts to joints."""

from __future__ import annotations

import hashlib

import numpy as np
from generators.writers import binary_stl
from manifold3d import CrossSection, Manifold
from random_assemblies import shapes
from scipy.spatial.transform import Rotation

from kinform import kinematics, surfaces
from kinform.model.assembly import Mesh, MeshHealth, Part
from support.assemblies import HERE, assembly
from support.touching import touching as touching_of


def box(x0, x1, y0, y1, z0, z1):
    return shapes.box((x0, x1), (y0, y1), (z0, z1))


def block(x, y, z):
    """A box of this size about the origin."""
    return box(-x / 2, x / 2, -y / 2, y / 2, -z / 2, z / 2)


def rod(radius, z0, z1, segments=40, phase=0.0):
    return shapes.cylinder(radius, (z0, z1), segments, phase)


def centred_rod(radius, length, segments):
    """A rod along z about the origin."""
    return rod(radius, -length / 2, length / 2, segments)


def save(solid, path, scale=1.0):
    """Write a solid as binary STL."""
    mesh = solid.to_mesh64()
    binary_stl(path, (np.asarray(mesh.vert_properties)[:, :3] * scale, np.asarray(mesh.tri_verts)))


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


def recovered(X=None, scale=1e-3, **solids):
    """The named solids, all under one pose, and their surfaces: what contacts are found from."""
    X = np.eye(4) if X is None else X
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()))
    return made, {one.mesh.digest: surfaces.recover(one.mesh, made.tolerances) for one in made.parts}


def derived(X=None, scale=1e-3, groups=(), **solids):
    """Kinematics and contacts of the named solids, all under one pose."""
    X = np.eye(4) if X is None else X
    made = assembly(*(part(name, solid, X, scale) for name, solid in solids.items()), groups=groups)
    found, touching = touching_of(made)
    return kinematics.derive(made, found, touching), touching
