"""Surfaces that a relative motion maps onto themselves.

A point keeps its distance from such a surface, so nothing ever comes to cross it but through its border, and there
the surfaces that share the border are met as well: a collision is never missed when it is left out. Journals in
bores, thrust faces, guides and flanks of threads are all of this kind, which is why mating surfaces, whose facets
overlap by their chord errors, need not be told from collisions by any depth. The motions that a kind of surface
admits are those of slippage analysis (Gelfand and Guibas 2004).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.screws import cross, perpendicular
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces, Surface

__all__ = ["Allowed", "Extent", "extents", "sliding_on_themselves"]

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Allowed:
    """What a surface may be off and still count: `length` (m) for turns, `angle` (rad)."""

    length: float
    angle: float


@dataclass(frozen=True, eq=False)
class Extent:
    """Middle (s, 3) and radius (s,) m of the facets of each surface of a mesh, part frame."""

    middle: Array
    radius: Array


def extents(mesh: Mesh, surfaces: MeshSurfaces) -> Extent:
    """Where the facets of each surface are."""
    count = len(surfaces.surfaces)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    corners = mesh.vertices[mesh.faces]
    np.minimum.at(low, surfaces.labels, corners.min(axis=1))
    np.maximum.at(high, surfaces.labels, corners.max(axis=1))
    return Extent(0.5 * (low + high), 0.5 * np.linalg.norm(high - low, axis=1))


def sliding_on_themselves(surfaces: MeshSurfaces, extent: Extent, twists: Array, allowed: Allowed) -> Flags:
    """(s,) which surfaces of a mesh every motion of `twists` (k, 6) (part frame, ω; v at its origin) maps onto themselves."""
    out = np.zeros(len(surfaces.surfaces), dtype=bool)
    for n, surface in enumerate(surfaces.surfaces):
        own = _own_motions(surface)
        if len(own):
            out[n] = _contains(own, twists, extent.middle[n], float(extent.radius[n]), allowed)
    return out


def _own_motions(surface: Surface) -> Array:
    """(m, 6) twists that map the whole surface onto itself."""
    axis, point = surface.axis, surface.point
    slide = np.concatenate([np.zeros(3), axis])
    turn = np.concatenate([axis, cross(point, axis)])
    if surface.kind == "plane":
        u, v = perpendicular(axis)
        return np.stack([turn, np.concatenate([np.zeros(3), u]), np.concatenate([np.zeros(3), v])])
    if surface.kind == "cylinder":
        return np.stack([turn, slide])
    if surface.kind == "sphere":
        return np.hstack([np.eye(3), cross(np.broadcast_to(point, (3, 3)), np.eye(3))])
    if surface.kind in ("cone", "torus", "revolution"):
        return turn[None]
    if surface.kind == "extrusion":
        return slide[None]
    if surface.kind == "helicoid":
        return (turn + surface.pitch / (2.0 * np.pi) * slide)[None]
    return np.zeros((0, 6))


def _contains(own: Array, twists: Array, middle: Array, radius: float, allowed: Allowed) -> bool:
    """Whether each twist is a combination of `own` but for what is allowed over the surface."""
    size = max(radius, 1e-9)
    base, wanted = _at(own, middle, size), _at(twists, middle, size)
    rest = wanted - np.linalg.lstsq(base.T, wanted.T, rcond=None)[0].T @ base
    speeds = np.linalg.norm(rest[:, :3], axis=1) + np.linalg.norm(rest[:, 3:], axis=1)
    turning = np.linalg.norm(twists[:, :3], axis=1) > 0.0
    limit = np.where(turning, allowed.length + allowed.angle * radius, allowed.angle)
    return bool(np.all(speeds <= limit))


def _at(twists: Array, middle: Array, size: float) -> Array:
    """Twists as velocities (m/s): of the rim by the turn, and of the middle."""
    omega = twists[:, :3]
    return np.hstack([size * omega, twists[:, 3:] + cross(omega, np.broadcast_to(middle, omega.shape))])
