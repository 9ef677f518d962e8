"""How far places are from analytic surfaces, on the outside of their material."""

from __future__ import annotations

import math

import numpy as np

from kinform.contacts.search.pair_view import NearSurfaces
from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.model.surfaces import KINDS

EXACT_KINDS = ("plane", "sphere", "cylinder", "cone", "torus")
"""Kinds of surfaces whose distance is known."""


@dataclass(frozen=True, eq=False)
class Beside:
    """Places (n,) and what a surface is to each."""

    gaps: Array
    """(n,) m, negative inside the material."""
    normals: Array
    """(n, 3) out of the material, at the nearest place of the surface."""
    within: Flags
    """(n,) whether that is between its ends along its axis."""


def beside(near: NearSurfaces, row: int, points: Array) -> Beside:
    """What one of the surfaces, of EXACT_KINDS, is to points (n, 3); those on the axis of a round one have no normal
    of their own."""
    kind, axis, side = KINDS[near.kinds[row]], near.axes[row], float(near.sides[row])
    arm = points - near.points[row]
    all_along = np.ones(len(points), dtype=bool)
    if kind == "plane":
        return Beside(arm @ axis, np.tile(axis, (len(points), 1)), all_along)
    if kind == "sphere":
        distance = np.linalg.norm(arm, axis=1)
        return Beside(side * (distance - near.radii[row]), side * _unit(arm, distance), all_along)
    along = arm @ axis
    aside = arm - along[:, None] * axis
    far = np.linalg.norm(aside, axis=1)
    radial = _unit(aside, far)
    if kind == "torus":
        ring = aside - near.radii[row] * radial + along[:, None] * axis
        distance = np.linalg.norm(ring, axis=1)
        return Beside(side * (distance - near.minor_radii[row]), side * _unit(ring, distance), all_along)
    low, high = near.extents[row]
    if kind == "cylinder":
        return Beside(side * (far - near.radii[row]), side * radial, (low <= along) & (along <= high))
    half = float(near.half_angles[row])
    distance = math.cos(half) * far - math.sin(half) * along
    foot = along + math.sin(half) * distance
    normals = math.cos(half) * radial - math.sin(half) * axis
    return Beside(side * distance, side * normals, (low <= foot) & (foot <= high))


def _unit(vectors: Array, lengths: Array) -> Array:
    return np.asarray(vectors / np.maximum(lengths, TINY)[:, None])
