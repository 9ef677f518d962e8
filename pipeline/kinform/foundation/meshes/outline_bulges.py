"""How far smooth curves through the outlines of a part may stand off its facets.

An outline bends smoothly along facets of curved surfaces, and from plane to plane where these meet, or might, at a
slight angle. A cubic curve through points whose chords turn by no more than at smooth edges, none of them three times
as long as the next, stays within a third of a chord's length of it. Cylinders that fit exactly need no curve: they
stand off by their chord error.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.meshes.surface_table import PLANE, SurfaceTable
from kinform.foundation.rounding import ARITHMETIC
from kinform.model.arrays import Array, Flags, Ints

BULGE = 0.35
"""Share of a chord by which a smooth curve may stand off it: cubic curves through 32° and lengths of one to three come
to 0.3 at worst."""


def bulge_of(corners: Array, labels: Ints, table: SurfaceTable, exact: Flags, smooth: float) -> float:
    """m, of facets (F, 3, 3) of surfaces `labels` (F,), of which some are `exact` cylinders (s,). Edges are smooth
    below `smooth` (rad)."""
    bent = ~exact
    plane = np.flatnonzero(table.kinds == PLANE)
    bent[plane] = _bending(table.axes.take(plane, axis=0), smooth)
    facets = np.flatnonzero(bent.take(labels))
    if not len(facets):
        return 0.0
    first, second, third = np.ascontiguousarray(corners.take(facets, axis=0).transpose(1, 2, 0))
    sides = (first - second).T, (second - third).T, (third - first).T
    return BULGE * math.sqrt(max(float(dot(side, side).max()) for side in sides))


def _bending(normals: Array, smooth: float) -> Flags:
    """(n,) which of planes with these normals (n, 3) may meet another one smoothly."""
    # pairs of more planes would be millions; then any bend counts as smooth
    if len(normals) > 1000:
        return np.ones(len(normals), bool)
    cosine = normals @ normals.T
    # Largest angle between two planes that may meet smoothly, in angles of a smooth edge: outlines are not quite across
    # the edge.
    return np.asarray(((cosine < 1.0 - ARITHMETIC) & (cosine > math.cos(1.05 * smooth))).any(axis=1))
