"""Which sets of triangles are sure to keep a distance from each other: by their boxes, then by directions that part
them. Said of many sets at once; what is said of one does not depend on the others.

Two triangles are further apart than a distance where some direction parts them by as much: the normal of either, or
what is across one of its edges in its plane. Of triangles that only other directions part it is not sure, which is of
no harm to those who ask.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.concatenation import concatenated
from kinform.foundation.constants import ROWS
from kinform.foundation.meshes.box_pairs import meeting_boxes
from kinform.foundation.meshes.boxes import BOXES_MATRIX, triangle_boxes
from kinform.foundation.meshes.slivers import sides_of
from kinform.foundation.rounding import SINGLE
from kinform.model.arrays import Array, Flags, Ints

APART_SOME = 32
"""Pairs that are looked at first, at most: where sets are not separated, a few tell."""
APART_TOGETHER = 50_000
"""Pairs of triangles of several sets that are handled together: 10 MB."""


def surely_separated(asked: Sequence[tuple[Array, Array, float]]) -> list[bool]:
    """Whether it is sure that no triangle (n, 3, 3) of the first comes within a distance (m) of one (m, 3, 3) of the
    second, for each of these three."""
    out, near = [False] * len(asked), {}
    for k, (first, second, distance) in enumerate(asked):
        met = _near(first, second, distance)
        if met is not None:
            out[k] = True
            near[k] = met
    # some are asked before all are, which settles it where much is near
    for most in (APART_SOME, None):
        left = {k: met for k, met in near.items() if out[k] and len(met[0])}
        for k in _not_parted(asked, left, most):
            out[k] = False
    return out


def _near(first: Array, second: Array, distance: float) -> tuple[Ints, Ints] | None:
    """Triangles whose boxes come within the distance; None of too many."""
    if len(first) * len(second) > BOXES_MATRIX:
        return None
    low, high = triangle_boxes(first)
    # Pairs of near triangles, per triangle, beyond which sets count as not separated without looking: the search for a
    # contact then takes less. Chosen, not measured.
    most = 20 * (len(first) + len(second))
    return meeting_boxes((low - distance, high + distance), triangle_boxes(second), most)


def _not_parted(
    asked: Sequence[tuple[Array, Array, float]], near: dict[int, tuple[Ints, Ints]], most: int | None
) -> list[int]:
    """Of which sets some of those pairs of triangles that are near each other, at most so many, are not parted."""
    some = {k: slice(None, None, -(-len(one) // most) if most else None) for k, (one, _) in near.items()}
    pairs = {k: (one[some[k]], two[some[k]]) for k, (one, two) in near.items()}
    out, group, count = set[int](), list[int](), 0
    for k, (one, _) in pairs.items():
        group.append(k)
        count += len(one)
        if count > APART_TOGETHER:
            out |= _not_parted_of(asked, {k: pairs[k] for k in group})
            group, count = [], 0
    return sorted(out | _not_parted_of(asked, {k: pairs[k] for k in group}) if group else out)


def _not_parted_of(asked: Sequence[tuple[Array, Array, float]], pairs: dict[int, tuple[Ints, Ints]]) -> set[int]:
    """The same of few of them, all of whose pairs are asked."""
    first = concatenated([asked[k][0].take(one, axis=0) for k, (one, _) in pairs.items()])
    second = concatenated([asked[k][1].take(two, axis=0) for k, (_, two) in pairs.items()])
    owner = np.repeat(list(pairs), [len(one) for one, _ in pairs.values()])
    distances, out = np.array([distance for *_, distance in asked]), set[int]()
    for start in range(0, len(owner), ROWS):
        part = slice(start, start + ROWS)
        one, two = (np.ascontiguousarray(side[part].transpose(1, 2, 0)) for side in (first, second))
        origin = one[0].copy()
        one -= origin
        two -= origin
        of, far = owner[part], distances.take(owner[part])
        for _ in range(2):
            left = np.flatnonzero(~_parted(one, two, far))
            # once more by the directions of the other
            one, two, of, far = two.take(left, axis=2), one.take(left, axis=2), of.take(left), far.take(left)
        out |= set(of.tolist())
    return out


def _parted(mine: Array, other: Array, far: Array) -> Flags:
    """(c,) whether the normals of triangles (3, 3, c), or what is across one of their edges, part them from others by
    more than so far (c,) m; near an origin of their own."""
    size = np.maximum(np.abs(mine).max(axis=(0, 1)), np.abs(other).max(axis=(0, 1)))
    axes, reach, spare, _ = sides_of(mine, size)
    place = axes[0] * other[:, 0, None]
    place += axes[1] * other[:, 1, None]
    place += axes[2] * other[:, 2, None]
    place -= reach
    begin, end, third = place
    long = np.sqrt(axes[0] * axes[0] + axes[1] * axes[1] + axes[2] * axes[2])
    spare += (far * (1.0 + SINGLE)) * long
    parted = np.logical_or.reduce(np.minimum(np.minimum(begin, end), third) > spare)
    parted |= np.maximum(np.maximum(begin[0], end[0]), third[0]) < -spare[0]
    return np.asarray(parted)
