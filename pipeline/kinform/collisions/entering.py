"""Points of one part that come to be inside another: what faces show that pass through each other without crossing.

Parts whose faces are flush, as a block in a slot or a piston in a bore, run into the end without any two facets that
cross in a way that could be told from a mate: the ends are parallel, and their borders lie on mates. But a point on the
end of one is then inside the other. Points lie inside of facets, spread over each surface (farthest first).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.contacts.bvh import MeshIndex, inner_weights
from kinform.model.assembly import Mesh

__all__ = ["Probes", "probes"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

EACH = 24
"""Points on one surface."""
MOST = 480
"""Points on one part."""
FINE = 6
"""A surface's largest facets are divided until they are about so many times smaller than it."""
FAR = 0.05
"""Share of the other part's diagonal beyond whose box a point needs no closer look."""


@dataclass(frozen=True, eq=False)
class Probes:
    """Points (n, 3) m on a part, in its frame."""

    points: Array

    def heights(self, other: MeshIndex, X: Array, chosen: Ints) -> Array:
        """(k,) m: how deep some of the points are inside another part, in whose frame the pose of this one is X (4, 4);
        outside of it, the negative of a distance that they keep at least."""
        placed = self.points[chosen] @ X[:3, :3].T + X[:3, 3]
        beyond = np.maximum(np.maximum(other.low - placed, placed - other.high), 0.0)
        out = -np.linalg.norm(beyond, axis=1)
        near = np.flatnonzero(out > -FAR * other.mesh.diagonal)
        if len(near):
            inside = other.contains(placed[near])
            out[near] = np.where(inside, 0.0, -other.away(placed[near]))
            deep = near[inside]
            out[deep] = other.whole().depths(placed[deep])[0]
        return np.asarray(out)


def probes(mesh: Mesh, labels: Ints, facets: Ints) -> Probes:
    """Points on the surfaces (`labels`, of all facets) that some facets belong to, on these."""
    own = labels[facets]
    kinds = np.unique(own)
    each = max(min(EACH, MOST // max(len(kinds), 1)), 1)
    chosen = [_spread(mesh.vertices[mesh.faces[facets[own == kind]]], each) for kind in kinds]
    points = np.concatenate(chosen) if chosen else np.zeros((0, 3))
    return Probes(points[np.unique(np.linspace(0, len(points) - 1, MOST).astype(int))] if len(points) else points)


def _spread(corners: Array, count: int) -> Array:
    """Some points (≤ count, 3) inside of triangles (n, 3, 3), far from each other."""
    size = float(np.linalg.norm(np.ptp(corners.reshape(-1, 3), axis=0)))
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    points = []
    parts = np.clip(np.ceil(FINE * sides / max(size, 1e-300)), 1, FINE).astype(int)
    for number in np.unique(parts):
        points.append((inner_weights(int(number)) @ corners[parts == number]).reshape(-1, 3))
    candidates = np.concatenate(points)
    away = np.linalg.norm(candidates - candidates.mean(axis=0), axis=1)
    taken = [int(np.argmin(away))]
    away = np.full(len(candidates), np.inf)
    while len(taken) < min(count, len(candidates)):
        away = np.minimum(away, np.linalg.norm(candidates - candidates[taken[-1]], axis=1))
        farthest = int(np.argmax(away))
        if away[farthest] <= 0.0:
            break
        taken.append(farthest)
    return np.asarray(candidates[np.sort(taken)])
