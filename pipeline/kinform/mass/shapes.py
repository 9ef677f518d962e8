"""The solid that several placed parts are together, whatever they weigh: its volume, centroid and unit inertia.

Each closed part counts as full, and what parts share counts twice: a density that follows from it is one of a drawing.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from kinform.foundation.rounding import ARITHMETIC
from kinform.frozen import dataclass
from kinform.mass.solids import integrate_solid
from kinform.model.arrays import Array
from kinform.model.assembly import Part


@dataclass(frozen=True, eq=False)
class Solid:
    """World frame, at a density of 1 kg/m³."""

    volume: float
    """m³."""
    centroid: Array
    """(3,) m."""
    inertia: Array
    """(3, 3) m⁵ about the centroid."""
    open_parts: tuple[str, ...]
    """Parts that enclose no volume and are not in it, sorted."""


def solid_of(parts: Iterable[Part]) -> Solid | None:
    """What the parts are together; None where none of them encloses a volume. A mesh that is inside out counts as
    what it encloses."""
    volumes, centres, inertias, left = [], [], [], []
    for part in parts:
        mesh = part.mesh
        if mesh is None:
            continue
        closed = part.solid and mesh.health.watertight and mesh.health.consistent_winding
        integrals = integrate_solid(mesh.vertices, mesh.faces) if closed else None
        if integrals is None or abs(integrals.volume) <= ARITHMETIC * mesh.diagonal**3:
            left.append(str(part.name))
            continue
        sign, R = (1.0 if integrals.volume > 0.0 else -1.0), part.X_WP[:3, :3]
        volumes.append(sign * integrals.volume)
        centres.append(R @ integrals.centroid + part.X_WP[:3, 3])
        inertias.append(sign * (R @ integrals.inertia @ R.T))
    if not volumes:
        return None
    shares = np.array(volumes)
    volume = float(shares.sum())
    centroid = shares @ np.array(centres) / volume
    inertia = np.zeros((3, 3))
    for share, centre, own in zip(volumes, centres, inertias, strict=True):
        offset = centre - centroid
        inertia += own + share * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    return Solid(volume, centroid, 0.5 * (inertia + inertia.T), tuple(sorted(left)))
