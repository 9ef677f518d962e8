"""Spheres about the facets of a mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.collisions.constants import SPHERES, SPHERES_FINE
from kinform.foundation.meshes.boxes import together
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Mesh


@dataclass(frozen=True, eq=False)
class Spheres:
    """Middles (k, 3) and radii (k,) m of spheres that hold all facets of a part, part frame: one, few, and many."""

    whole: tuple[Array, Array]
    coarse: tuple[Array, Array]
    fine: tuple[Array, Array]
    first: Ints
    """The first of the fine spheres for the facets of each coarse one, and behind the last."""

    @classmethod
    def of(cls, mesh: Mesh) -> Spheres:
        """About facets that lie together."""
        corners = mesh.vertices[mesh.faces]
        low, high = corners.min(axis=1), corners.max(axis=1)
        order = together(low, high)
        count = len(order)
        coarse, fine = (np.linspace(0, count, n, endpoint=False).astype(int) for n in (SPHERES, SPHERES_FINE))
        coarse, fine = np.unique(coarse), np.unique(np.append(coarse, fine))
        corners, low, high = corners[order], low[order], high[order]
        few, many = (_about(corners, low, high, starts) for starts in (coarse, fine))
        middle = 0.5 * (low.min(axis=0) + high.max(axis=0))
        one = middle[None], np.array([(np.linalg.norm(few[0] - middle, axis=1) + few[1]).max()])
        return cls(one, few, many, np.append(np.searchsorted(fine, coarse), len(fine)))


def _about(corners: Array, low: Array, high: Array, starts: Ints) -> tuple[Array, Array]:
    middle = 0.5 * (np.minimum.reduceat(low, starts) + np.maximum.reduceat(high, starts))
    rank = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, len(corners))))
    away = corners - middle[rank, None]
    square = np.einsum("nij,nij->ni", away, away).max(axis=1)
    return middle, np.sqrt(np.maximum.reduceat(square, starts))
