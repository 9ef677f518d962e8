"""Axes that turn with a mesh: what is computed along them is the same however the file that has it is turned.

Boxes, grids and sectors need some axes. Those of the world or of the file make two equal parts, turned by chance, two
different ones: their samples differ, and with them what is at the edge of a limit. The first axis is the direction in
which most area faces, either way, the second the one across it; of equal ones that of the first facet.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, lengths, norm, perpendicular
from kinform.foundation.rounding import SINGLE, TINY
from kinform.foundation.sorting import coarse
from kinform.model.arrays import Array, Ints

MOST_FACETS = 16
"""Facets, the largest first, of which each suggests a direction. Chosen, not measured."""
MOST_COUNTED = 4000
"""Facets, the largest first, that are counted for these: parts of a mesh of more are each a small share of it. Chosen,
not measured."""
ALIKE = 1e-6
"""1 less the cosine (0.08°) of directions that count as one: far above rounding. Chosen, not measured."""
UNTURNED = 1e-9
"""Axes within this of those of the file are these, to the last bit: numbers of parts drawn along them stay round."""


def own_axes(vertices: Array, faces: Ints) -> Array:
    """(3, 3) right-handed unit axes, row by row, of a mesh with these vertices (V, 3) and faces (F, 3)."""
    corners = vertices.take(faces, axis=0)
    across = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    first = _heaviest(across)
    if first is None:
        return np.eye(3)
    beside = across - np.outer(across @ first, first)
    second = _heaviest(beside, SINGLE * float(lengths(across).max()))
    if second is None:
        edges = (corners - corners[:, [1, 2, 0]]).reshape(-1, 3)
        second = _heaviest(edges - np.outer(edges @ first, first))
    second = perpendicular(first)[0] if second is None else second - float(second @ first) * first
    second = second / norm(second)
    axes = np.array([first, second, cross(first, second)])
    whole = np.rint(axes)
    return whole + 0.0 if np.abs(axes - whole).max() < UNTURNED else axes


def _heaviest(vectors: Array, least: float = 0.0) -> Array | None:
    """(3,) the unit direction, of those of the longest of vectors (n, 3), that has the greatest lengths along it, of
    either sense; in the sense that has more. None where none is longer than `least`."""
    size = lengths(vectors)
    largest = np.argsort(-coarse(size), kind="stable")[:MOST_COUNTED]
    vectors, size = vectors.take(largest, axis=0), size.take(largest)
    chosen = np.flatnonzero(size[:MOST_FACETS] > max(least, TINY))
    if not len(chosen):
        return None
    candidates = vectors[chosen] / size[chosen, None]
    along = vectors @ candidates.T
    near = (1.0 - ALIKE) * size[:, None]
    ahead = np.where(along > near, size[:, None], 0.0).sum(axis=0)
    behind = np.where(along < -near, size[:, None], 0.0).sum(axis=0)
    best = int(np.argmax(coarse(ahead + behind)))
    more, less = coarse(np.array([ahead[best], behind[best]])).tolist()
    return np.asarray(candidates[best] if more >= less else -candidates[best])
