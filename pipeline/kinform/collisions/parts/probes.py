"""Points of one part that come to be inside another: what faces show that pass through each other without crossing.

Parts whose faces are flush, as a block in a slot or a piston in a bore, run into the end without any two facets that
cross in a way that could be told from a mate: the ends are parallel, and their borders lie on mates. But a point on the
end of one is then inside the other. Points lie inside of facets, spread over each surface (farthest first).
"""

from __future__ import annotations

import numpy as np

from kinform.collisions.constants import DEPTH_MEASURED
from kinform.foundation.algebra.vectors import dot
from kinform.foundation.meshes.mesh_index import MeshIndex
from kinform.foundation.meshes.subdivision import inner_weights, longest_sides
from kinform.foundation.rounding import TINY
from kinform.foundation.sorting import ascending
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Mesh

POINTS_PART = 480
"""Points on one part: those of twenty surfaces. A choice."""
POINTS_FINE = 6
"""A surface's largest facets are divided until they are about so many times smaller than it: 6² = 36 then cover it,
more than are wanted."""


@dataclass(frozen=True, eq=False)
class Probes:
    """Points (n, 3) m on a part, in its frame."""

    points: Array

    def heights(self, other: MeshIndex, X: Array, chosen: Ints, away: bool = True, shallow: float = 0.0) -> Array:
        """(k,) m: how deep some of the points are inside another part, in whose frame the pose of this one is X (4, 4);
        outside of it, the negative of a distance that they keep at least, about 0 unless `away` is asked. Those
        no deeper than `shallow` (m) are measured together."""
        placed = self.points[chosen] @ X[:3, :3].T + X[:3, 3]
        beyond = np.maximum(np.maximum(other.low - placed, placed - other.high), 0.0)
        out = -np.linalg.norm(beyond, axis=1)
        # Share of the other part's diagonal beyond whose box a point needs no closer look: a choice.
        near = np.flatnonzero(out > -0.05 * other.mesh.diagonal)
        if len(near):
            inside = other.contains(placed[near])
            deep, clear = near[inside], near[~inside]
            out[clear] = -other.away(placed[clear]) if away else 0.0
            if shallow > 0.0 and len(deep) > DEPTH_MEASURED:
                out[deep] = other.depths_up_to(placed[deep], np.nextafter(shallow, np.inf))
                deep = deep[out[deep] > shallow]
            out[deep] = other.depths(placed[deep])
        return np.asarray(out)


def probes(mesh: Mesh, labels: Ints, facets: Ints) -> Probes:
    """Points on the surfaces (`labels`, of all facets) that some facets belong to, on these."""
    if not len(facets):
        return Probes(np.zeros((0, 3)))
    facets = facets[np.argsort(labels[facets], kind="stable")]
    starts = np.flatnonzero(np.diff(labels[facets], prepend=-1))
    # Points on one surface: a choice.
    each = max(min(24, POINTS_PART // len(starts)), 1)
    points = _spread(mesh.vertices[mesh.faces[facets]], starts, each)
    return Probes(points[np.unique(np.linspace(0, len(points) - 1, POINTS_PART).astype(int))])


def _spread(corners: Array, starts: Ints, count: int) -> Array:
    """Points (n, 3) inside of triangles (m, 3, 3), in groups that begin at `starts`: of each group some (≤ count), far
    from each other."""
    group = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, len(corners))))
    columns = np.ascontiguousarray(corners.reshape(-1, 3).T)
    low, high = (np.stack([f.reduceat(side, 3 * starts) for side in columns], axis=1) for f in (np.minimum, np.maximum))
    sides = longest_sides(corners)
    size = np.maximum(np.linalg.norm(high - low, axis=1), TINY)[group]
    parts = np.clip(np.ceil(POINTS_FINE * sides / size), 1, POINTS_FINE).astype(np.int64)
    pieces, owner, key = [], [], []
    for number in np.unique(parts).tolist():
        these = np.flatnonzero(parts == number)
        pieces.append((inner_weights(number) @ corners[these]).reshape(-1, 3))
        owner.append(np.repeat(group[these], number * number))
        key.append(owner[-1] * (POINTS_FINE + 1) + number)
    order = ascending(np.concatenate(key), len(starts) * (POINTS_FINE + 1))
    points, group = np.concatenate(pieces)[order], np.concatenate(owner)[order]
    starts = np.flatnonzero(np.diff(group, prepend=-1))
    wide = np.diff(np.append(starts, len(points)))
    middle = np.add.reduceat(points, starts) / wide[:, None]
    last = _first_least(_squares(points - middle[group]), starts, group)
    taken, away = np.zeros(len(points), dtype=bool), np.full(len(points), np.inf)
    taken[last] = True
    for _ in range(min(count, int(wide.max())) - 1):
        away = np.minimum(away, _squares(points - points[last][group]))
        last = _first_least(-away, starts, group)
        taken[last[away[last] > 0.0]] = True
    return points[taken]


def _first_least(values: Array, starts: Ints, group: Ints) -> Ints:
    """The place of the least value of each group, of equal ones the first."""
    least = np.flatnonzero(values == np.minimum.reduceat(values, starts)[group])
    return np.asarray(least[np.searchsorted(least, starts)])


def _squares(vectors: Array) -> Array:
    return dot(vectors, vectors)
