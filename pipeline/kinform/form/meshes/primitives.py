"""Primitive solids as closed meshes: vertices lie on the exact surface, so that a fit of them gives its exact size."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from kinform.form.manifest.parts import BoxShape, CapsuleShape, CylinderShape, EllipsoidShape, ShapeTable
from kinform.form.meshes.health import build_mesh
from kinform.form.meshes.raw import RawMesh
from kinform.model.arrays import Array
from kinform.model.assembly import Mesh

ROUND_FACETS = 96
"""Facets round a primitive cylinder, sphere or capsule: its vertices are exact, a fit of them gives the exact radius,
and its volume is 0.07 % too small."""


def primitive(shape: ShapeTable, metres: float) -> Mesh:
    """The mesh of a shape whose lengths are in units of `metres`; of equal shapes the same one."""
    return _mesh(type(shape), shape.model_dump_json(), metres)


# Meshes of primitive solids that are kept for parts of the same shape: a sphere takes 0.1 s to make, and a design has
# few different ones. Chosen, not measured.
@lru_cache(maxsize=256)
def _mesh(kind: type[ShapeTable], said: str, metres: float) -> Mesh:
    shape: ShapeTable = kind.model_validate_json(said)
    if isinstance(shape, BoxShape):
        raw = _box(np.array(shape.size))
    elif isinstance(shape, CylinderShape):
        half = 0.5 * shape.length
        raw = _turned(np.array([[shape.radius, -half], [shape.radius, half]]), -half, half)
    elif isinstance(shape, CapsuleShape):
        half = 0.5 * shape.length
        arc = _half_circle(shape.radius)
        arc[:, 1] += np.where(arc[:, 1] < 0.0, -half, half)
        middle = np.abs(arc[:, 1]) == half
        ends = np.array([[shape.radius, -half], [shape.radius, half]])
        profile = np.concatenate([arc[(arc[:, 1] < 0.0) & ~middle], ends, arc[(arc[:, 1] > 0.0) & ~middle]])
        raw = _turned(profile, -half - shape.radius, half + shape.radius)
    elif isinstance(shape, EllipsoidShape):
        ball = _turned(_half_circle(1.0), -1.0, 1.0)
        raw = RawMesh(ball.vertices * np.array(shape.radii), ball.faces)
    else:
        raw = _turned(_half_circle(shape.radius), -shape.radius, shape.radius)
    return build_mesh(raw, metres, None, path="", body=shape.type, solid=True)


def _box(size: Array) -> RawMesh:
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * size
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = [[a, b, c] for a, b, c, _ in quads] + [[a, c, d] for a, _, c, d in quads]
    return RawMesh(corners, np.array(faces, dtype=np.int64))


def _half_circle(radius: float) -> Array:
    """Points (n, 2) of distance from the axis and height, without the poles, from below."""
    angles = (np.arange(1, ROUND_FACETS // 2) / (ROUND_FACETS // 2) - 0.5) * math.pi
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def _turned(profile: Array, bottom: float, top: float) -> RawMesh:
    """A closed body of revolution about z: points (n, 2) of distance and height from below, and two poles."""
    rings, n = len(profile), ROUND_FACETS
    angles = 2.0 * math.pi * np.arange(n) / n
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    vertices = [np.column_stack([radius * circle, np.full(n, height)]) for radius, height in profile]
    vertices += [np.array([[0.0, 0.0, bottom], [0.0, 0.0, top]])]
    here = np.arange(n)
    after = (here + 1) % n
    low, high = rings * n, rings * n + 1
    faces = [np.column_stack([np.full(n, low), after, here])]
    for k in range(rings - 1):
        a, b, c, d = here + k * n, after + k * n, after + (k + 1) * n, here + (k + 1) * n
        faces += [np.column_stack([a, b, c]), np.column_stack([a, c, d])]
    last = (rings - 1) * n
    faces.append(np.column_stack([np.full(n, high), here + last, after + last]))
    return RawMesh(np.concatenate(vertices), np.concatenate(faces).astype(np.int64))
