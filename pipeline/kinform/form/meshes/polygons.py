"""Polygons into triangles, concave ones too.

A convex polygon becomes a fan. Whatever does not is projected along its Newell normal (Sutherland et al.,
A characterization of ten hidden-surface algorithms, 1974) and triangulated by manifold3d.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.form.constants import FAULTS_SHOWN
from kinform.foundation.algebra.vectors import perpendicular
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.model.arrays import Array, Ints

CUT_CORNERS = 10_000
"""Corners of a concave polygon at most: cutting takes time as their square, 0.8 s for one of so many that crosses
itself, 2.1 s for one of 16,000. Convex ones are fans, and may have any number."""


def triangulate(vertices: Array, corners: Ints, sizes: Ints) -> tuple[Ints, Ints, Ints]:
    """Triangles (T, 3), the polygon of each (T,), and the polygons that cannot be cut (k,): they cross themselves, or
    are concave and have more than `CUT_CORNERS` corners. Of those the first are enough.

    vertices: (n, 3). corners: vertex indices of all polygons, one after the other. sizes: (P,) at least 3.
    Triangles come in the order of the polygons.
    """
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int64)
    triangles, owners = [], []
    crossed: list[int] = []
    for size in np.unique(sizes):
        which = np.flatnonzero(sizes == size)
        polygons = corners[starts[which][:, None] + np.arange(size)]
        if size == 3:
            triangles.append(polygons)
            owners.append(which)
            continue
        fan, ok = _fans(vertices, polygons)
        triangles.append(fan[ok].reshape(-1, 3))
        owners.append(np.repeat(which[ok], size - 2))
        for polygon, index in zip(polygons[~ok], which[~ok], strict=True):
            if len(crossed) >= FAULTS_SHOWN:
                break
            cut = _cut(vertices, polygon) if size <= CUT_CORNERS else None
            if cut is None:
                crossed.append(index)
                continue
            triangles.append(cut)
            owners.append(np.full(len(cut), index))
    owner = np.concatenate(owners)
    order = np.argsort(owner, kind="stable")
    return np.concatenate(triangles)[order], owner[order], np.array(sorted(crossed), dtype=np.int64)


def _fans(vertices: Array, polygons: Ints) -> tuple[Ints, NDArray[np.bool_]]:
    """Fans (P, size − 2, 3) from the first corner, or from the second where only that one works."""
    first, first_ok = _fan(vertices, polygons)
    second, second_ok = _fan(vertices, np.roll(polygons, -1, axis=1))
    return np.where(first_ok[:, None, None], first, second), first_ok | second_ok


def _fan(vertices: Array, polygons: Ints) -> tuple[Ints, NDArray[np.bool_]]:
    size = polygons.shape[1]
    fan = np.stack(
        [np.broadcast_to(polygons[:, :1], (len(polygons), size - 2)), polygons[:, 1:-1], polygons[:, 2:]],
        axis=2,
    )
    p = vertices[fan]
    doubled = np.cross(p[:, :, 1] - p[:, :, 0], p[:, :, 2] - p[:, :, 0])
    normal = doubled.sum(axis=1)
    length = np.linalg.norm(normal, axis=1)
    along = np.einsum("pti,pi->pt", doubled, normal)
    flat = np.linalg.norm(doubled, axis=2).max(axis=1) == 0
    return fan, flat | (along > SOLVED * (length**2)[:, None]).all(axis=1)


def _cut(vertices: Array, polygon: Ints) -> Ints | None:
    """Triangles of one polygon by manifold3d; None if it crosses itself."""
    from manifold3d import triangulate as cut

    p = vertices[polygon] - vertices[polygon].mean(axis=0)
    normal = np.cross(p, np.roll(p, -1, axis=0)).sum(axis=0)
    area = float(np.linalg.norm(normal))
    spread = float(np.abs(p).max())
    if area <= SOLVED * spread**2:
        fan = np.stack([np.full(len(p) - 2, polygon[0]), polygon[1:-1], polygon[2:]], axis=1)
        a, b, c = (vertices[fan[:, i]] for i in range(3))
        collinear = np.abs(np.cross(b - a, c - a)).max() <= SOLVED * spread**2
        return fan if collinear else None
    normal /= area
    flat = np.stack([-(p @ across) for across in perpendicular(normal)], axis=1)
    triangles = np.asarray(cut([flat]), dtype=np.int64)
    if len(triangles) != len(p) - 2:
        return None
    a, b, c = (flat[triangles[:, i]] for i in range(3))
    doubled = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    if doubled.min() < -SOLVED * area or abs(doubled.sum() - area) > SINGLE * area:
        return None
    return polygon[triangles]
