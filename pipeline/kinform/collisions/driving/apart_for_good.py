"""Parts of a block of loops that only turn or slide on each other, however the loops move: most of their facets sweep
past each other for good, as those of leaves of a hinge that lie beside each other do, and need not be followed. What
they mate by may leave more free than the loops do, as a bush in its bore does: by the motion that is left, its ends
only slide along themselves."""

from __future__ import annotations

import numpy as np

from kinform.collisions.driving.constants import MEETING_MARGIN
from kinform.collisions.driving.swept_profiles import Profile, meeting
from kinform.collisions.pair.prepared_pair import PairTest
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.algebra.vectors import cross
from kinform.model.arrays import Array

TURNED_LEAST = 1e-3
"""Sine of the greatest turn, below which an axis is not looked for. Chosen, not measured."""


def that_can_meet(shapes: Shapes, test: PairTest, relative: Array) -> PairTest | None:
    """A pair with those of its facets that can meet somewhere as the second part moves by `relative` (T, 4, 4), in the
    world at the pose of the meshes; None where none can. Where parts overlap from the start, or points of one are deep
    inside the other, it is as it was."""
    if test.overlapping:
        return test
    meshes = [shapes.mesh(name) for name in test.names]
    places = [mesh.vertices @ X[:3, :3].T + X[:3, 3] for mesh, X in zip(meshes, (test.X_WA, test.X_WB), strict=True)]
    # Share of what swept profiles are apart at least, by which points may leave the one axis or direction.
    twist = one_motion(relative, places[0].mean(axis=0), shapes.size, 0.1 * MEETING_MARGIN * test.size)
    if twist is None:
        return test
    first, second = (Profile(place, mesh.faces, twist) for place, mesh in zip(places, meshes, strict=True))
    margin = MEETING_MARGIN * test.size
    facets = meeting(first, second, *test.facets, margin).facets
    if test.sunk(np.eye(4))[0] > test.loose:
        return test
    if test.mates:
        # no more is made of that than that none can meet: where some do is asked of all of them
        moved = shapes.moved_facets(*test.names, twist[None])
        one, other = (np.intersect1d(*sides, assume_unique=True) for sides in zip(facets, moved, strict=True))
        if not all(map(len, meeting(first, second, one, other, margin).facets)):
            return None
    return test.some(facets) if all(map(len, facets)) else None


def one_motion(displacements: Array, middle: Array, size: float, off: float) -> Array | None:
    """(6,) unit twist (ω; v at the origin) of the turn about one axis or the slide along one direction that all of some
    displacements (T, 4, 4) are; None where they are neither, to within `off` (m), for any point of something of that
    `size` (m) about its `middle` (3,)."""
    turned = displacements[:, :3, :3]
    moved = displacements[:, :3, 3] + turned @ middle - middle
    spin = 0.5 * np.stack([turned[:, j, i] - turned[:, i, j] for i, j in ((1, 2), (2, 0), (0, 1))], axis=1)
    sines = np.sqrt((spin * spin).sum(axis=1))
    n = int(np.argmax(sines))
    if sines[n] < TURNED_LEAST:
        most = moved[int(np.argmax((moved * moved).sum(axis=1)))]
        length = float(np.linalg.norm(most))
        if length <= off:
            return None
        along = most / length
        rest = np.abs(moved - (moved @ along)[:, None] * along).max()
        return np.append(np.zeros(3), along) if rest + size * np.abs(turned - np.eye(3)).max() <= off else None
    axis = spin[n] / sines[n]
    point = np.linalg.lstsq(np.eye(3) - turned[n], moved[n], rcond=TURNED_LEAST)[0]
    slipped = np.abs(turned @ point + moved - point).max() + size * np.abs(turned @ axis - axis).max()
    return np.append(axis, cross(middle + point, axis)) if slipped <= off else None
