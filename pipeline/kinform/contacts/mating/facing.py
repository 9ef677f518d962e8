"""Which surfaces of a pair may have facets that face each other within the tolerance: told by their axes, radii and
places alone, before any facet is asked."""

from __future__ import annotations

import numpy as np

from kinform.contacts.constants import MATING_REACH
from kinform.contacts.search.pair_view import NearSurfaces, PairView
from kinform.foundation.algebra.vectors import cross, dot, foot, lengths, norm
from kinform.foundation.constants import SLIVER_WIDTH
from kinform.foundation.meshes.surface_table import CYLINDER, PLANE, SPHERE
from kinform.model.arrays import Array, Flags, Ints

FACING_NEVER = 0.25
"""Cosine between normals of surfaces up to which none of their facets face each other, as normals scatter: half of
`FACING_LEAST`."""


def may_face(pair: PairView, unread: Flags) -> bool:
    """Whether any two surfaces flagged in `unread` (s, t) may have facets that face each other within the tolerance:
    planes that do not oppose each other have none, nor have planes and cylinders across them, nor what keeps more than
    the tolerance from a plane, balls and cylinders whose surfaces are further apart, nor cylinders about one axis, or
    side by side, that are, and bores about one axis."""
    (a, b) = pair.near
    rows, columns = np.nonzero(unread)
    if not len(rows):
        return False
    kinds, others = a.kinds[rows], b.kinds[columns]
    cosine = dot(a.axes[rows], b.axes[columns])
    sine = np.sqrt(np.maximum(1.0 - cosine * cosine, 0.0))
    flat, straight = (kinds == PLANE) & (others == PLANE), (kinds == CYLINDER) & (others == CYLINDER)
    across = ((kinds == PLANE) & (others == CYLINDER)) | ((kinds == CYLINDER) & (others == PLANE))
    left = ~((flat & (cosine > -FACING_NEVER)) | (across & (sine < FACING_NEVER)))
    rows, columns, straight = rows[left], columns[left], straight[left]
    reach = MATING_REACH * pair.tolerance
    rest = np.flatnonzero(~straight)
    if len(rest):
        within = (1.0 + 2.0 * SLIVER_WIDTH) * reach + a.slacks[rows[rest]] + b.slacks[columns[rest]]
        away = _away(a, rows[rest], b, columns[rest])
        if (np.maximum(away, _away(b, columns[rest], a, rows[rest])) <= within).any():
            return True
    for i, j in zip(rows[straight].tolist(), columns[straight].tolist(), strict=True):
        if _apart(pair, i, j) <= reach:
            return True
    return False


def _away(first: NearSurfaces, rows: Ints, second: NearSurfaces, columns: Ints) -> Array:
    """(n,) m that all of some surfaces keep at least from the planes, or cylinders, of others: planes that are as good
    as parallel, cylinders and balls from planes, and balls from cylinders; −1 of other kinds, and where it is none."""
    kinds, others, out = first.kinds[rows], second.kinds[columns], np.full(len(rows), -1.0)
    axes, arms = first.axes[rows], second.points[columns] - first.points[rows]
    high = dot(axes, arms)
    plane = kinds == PLANE
    cosine = dot(axes, second.axes[columns])
    radii, spare = second.radii[columns], np.zeros(len(rows))
    # Cosine between opposed planes from which on they are as good as parallel, 0.26°.
    level = plane & (others == PLANE) & (cosine < -0.99999)
    # a plane that is not quite parallel is nearer at the ends of both parts
    tilt = np.sqrt(np.maximum(1.0 - cosine * cosine, 0.0))
    spare[level] = (tilt * _reach(first, second))[level]
    straight = plane & (others == CYLINDER)
    ends = second.extents[columns] * cosine[:, None]
    spare[straight] = (tilt * radii)[straight]
    low, most = high + np.where(straight, ends.min(axis=1), 0.0), high + np.where(straight, ends.max(axis=1), 0.0)
    ball = plane & (others == SPHERE)
    spare[ball] = radii[ball]
    some = level | straight | ball
    out[some] = (np.maximum(low, -most) - spare)[some]
    tube = (kinds == CYLINDER) & (others == SPHERE)
    if tube.any():
        from_axis = lengths(arms - high[:, None] * axes)
        bore = first.radii[rows]
        out[tube] = np.maximum(bore - from_axis - radii, from_axis - radii - bore)[tube]
    return out


def _reach(first: NearSurfaces, second: NearSurfaces) -> float:
    """m: size of the box of all near facets, and how far points of planes may be off it."""
    low = np.minimum(first.lows.min(axis=0), second.lows.min(axis=0))
    high = np.maximum(first.highs.max(axis=0), second.highs.max(axis=0))
    middle = 0.5 * (low + high)
    off = max(float(lengths(near.points - middle).max()) for near in (first, second))
    return norm(high - low) + off


def _apart(pair: PairView, row: int, column: int) -> float:
    """m that the facets of two cylinders are apart at least; not positive where that is not known."""
    surfaces, (a, b) = pair.surfaces(row, column), pair.parts
    (first, second), (on_first, on_second), radii = surfaces.axes, surfaces.points, surfaces.radii
    low, high = np.minimum(a.low, b.low), np.maximum(a.high, b.high)
    middle, whole = 0.5 * (low + high), norm(high - low)
    feet = [foot(point, axis, middle) for point, axis in ((on_first, first), (on_second, second))]
    tilt = norm(cross(first, second))
    between = norm(feet[1] - feet[0])
    gap = max(abs(radii[0] - radii[1]) - between, between - sum(radii))
    if surfaces.sides[0] == surfaces.sides[1]:
        # two bores face each other across their middles only
        gap = max(gap, max(radii) - between)
    return gap - tilt * whole - surfaces.slack
