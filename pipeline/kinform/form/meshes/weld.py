"""Welding: vertices that are one become one.

Exact copies first (by their hashes), then vertices within the welding distance of each other.
A cluster gathers about its first vertex and reaches no further than the distance from it, so that a chain of
close vertices never draws a small feature together.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinform.form.meshes.raw import Fault, MeshError
from kinform.foundation.equal_rows import number_equal_rows
from kinform.foundation.meshes.near_points import Near
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array, Ints

# Directions along which no designer lays an edge.
_LINES = np.array([[0.57735, 0.51763, 0.63144], [-0.70143, 0.37291, 0.60741]])
_LINES /= np.linalg.norm(_LINES, axis=1)[:, None]


def used_only(vertices: NDArray[np.floating], faces: Ints) -> tuple[NDArray[np.floating], Ints]:
    """Vertices that faces use, in the order of their index, and the faces renumbered."""
    used = np.zeros(len(vertices), dtype=bool)
    used[faces.ravel()] = True
    if used.all():
        return vertices, faces
    return vertices[used], (np.cumsum(used) - 1)[faces]


def merge_exact(vertices: NDArray[np.floating]) -> tuple[Ints, Ints]:
    """First index of each distinct vertex, ascending, and for every vertex its place in that list.

    vertices: (n, 3) float32 or float64, finite. −0 equals 0.
    """
    zero = vertices.dtype.type(0)
    word = np.uint32 if vertices.dtype == np.float32 else np.uint64
    return number_equal_rows([(vertices[:, k] + zero).view(word) for k in range(3)])


def merge_close(vertices: Array, distance: float) -> tuple[Ints, Ints]:
    """As merge_exact, for vertices no further than `distance` (same unit) from the first of their cluster.

    Raises MeshError where the distance is so coarse that it would swallow the mesh.
    """
    every = np.arange(len(vertices))
    if distance <= 0 or len(vertices) < 2:
        return every, every
    pairs = _close_pairs(vertices, distance)
    if not len(pairs):
        return every, every
    first, place = np.unique(_leaders(len(vertices), pairs), return_inverse=True)
    return first, place.ravel()


def _close_pairs(vertices: Array, distance: float) -> Ints:
    crowded = _crowded(vertices, distance)
    if len(crowded) < 2:
        return np.zeros((0, 2), np.int64)
    near = Near(vertices[crowded], distance)
    # Vertices whose surroundings are counted before they are welded: enough for a mean to 5 %, and soon done. Chosen,
    # not measured.
    crowd = near.about(np.arange(0, len(crowded), max(1, len(crowded) // 500))).mean()
    # Mean number of others within the welding distance of a vertex, above which a mesh would collapse: copies of one
    # corner are as many as facets meet there, six on average. Chosen, not measured.
    if crowd > 50:
        raise MeshError([Fault(
            f"would collapse: within the welding distance ({distance:.3g} m) of a vertex lie {crowd:.0f} "
            "others on average",
            "state a smaller [tolerances] weld, and look for a stray vertex far from the part",
        )])  # fmt: skip
    return crowded[near.pairs]


def _crowded(vertices: Array, distance: float) -> Ints:
    """Vertices that may have another within the distance: those that do on every one of a few lines.

    Most vertices of a mesh are alone on a line in no direction of the design, which takes a sort to see.
    """
    crowded = _beside_another(vertices @ _LINES[0], distance)
    for line in _LINES[1:]:
        crowded = crowded.take(_beside_another(vertices.take(crowded, axis=0) @ line, distance))
    return crowded


def _beside_another(place: Array, distance: float) -> Ints:
    """Which of these places (n,) along a line have another within the distance."""
    order = place.argsort()
    ordered = place.take(order)
    near = np.flatnonzero(ordered[1:] - ordered[:-1] <= distance * (1.0 + SOLVED))
    kept = np.zeros(len(place), bool)
    kept[order.take(near)] = kept[order.take(near + 1)] = True
    return np.flatnonzero(kept)


_ROUNDS = 64
"""Rounds in which leaders are found many at a time, before the rest is gone through one by one: copies of corners take
two or three. Chosen, not measured."""


def _leaders(count: int, pairs: Ints) -> Ints:
    """The leader of each vertex: going through them in order, one leads unless it is close to a leader."""
    leader = np.arange(count)
    low, high = pairs.min(axis=1), pairs.max(axis=1)
    for _ in range(_ROUNDS):
        if not len(low):
            return leader
        follows = np.zeros(count, dtype=bool)
        follows[high] = True
        settled = ~follows[low]
        first = np.full(count, count)
        np.minimum.at(first, high[settled], low[settled])
        led = first < count
        leader[led] = first[led]
        keep = ~(settled | led[low] | led[high])
        low, high = low[keep], high[keep]
    order = np.lexsort((low, high))
    leads = leader.tolist()  # of a row in which each vertex is close to the next only two are settled in a round
    for v, below in zip(high[order].tolist(), low[order].tolist(), strict=True):
        if leads[v] == v and leads[below] == below:
            leads[v] = below
    return np.array(leads)
