"""Lines about which threads may run: axes of cylinders, and those about which pieces of what is left turn best."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from kinform.foundation.algebra.vectors import cross, cross_columns, dot
from kinform.foundation.graphs.components import components
from kinform.foundation.rounding import ARITHMETIC, SINGLE
from kinform.foundation.sorting import median
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.describe import Description
from kinform.surfaces.groups import members, repeated, starts_of
from kinform.surfaces.polygons.patchwork import Patchwork

THREAD_POLYGONS = 24
"""Fewest polygons of a thread: a turn has eight vertices at least, on two helices and both flanks. Chosen, not
measured."""
MOST_LINES = 6
"""Axes that are tried, the best supported first. Chosen, not measured."""
SAME_LINE = 1e-3
"""Difference of lines (rad, and of the span of the mesh) that are one axis. Chosen, not measured."""


Line: TypeAlias = tuple[Array, Array]
"""Direction (3,) and a point (3,) of it."""


def lines(work: Patchwork, others: Sequence[Description], turning: Sequence[Line]) -> list[Line]:
    """Those of cylinders among the others, the largest first, then the turning ones."""
    cylinders = [(float(work.area[item.polygons].sum()), k) for k, item in enumerate(others) if item.kind == "cylinder"]
    largest = sorted(cylinders, key=lambda c: (-c[0], c[1]))[: 4 * MOST_LINES]
    first = _distinct([(others[k].axis, others[k].point) for _, k in largest], MOST_LINES)
    return _distinct([*first, *turning], len(first) + len(turning))


def _distinct(candidates: Sequence[Line], most: int) -> list[Line]:
    """The first lines, `most` of them, without those that nearly are an earlier one."""
    kept: list[int] = []
    axes, points = ([pair[k].tolist() for pair in candidates] for k in range(2))
    for k, (axis, point) in enumerate(zip(axes, points, strict=True)):
        if not any(
            _across(axis, axes[j]) < SAME_LINE
            and _across([p - q for p, q in zip(point, points[j], strict=True)], axes[j]) < SAME_LINE
            for j in kept
        ):
            kept.append(k)
            if len(kept) == most:
                break
    return [candidates[k] for k in kept]


def _across(a: list[float], b: list[float]) -> float:
    """|a × b|; of a few vectors without numpy, which takes ten times as long."""
    (x, y, z), (u, v, w) = a, b
    return math.hypot(y * w - z * v, z * u - x * w, x * v - y * u)


def turning_lines(work: Patchwork, free: Flags) -> list[list[Line]]:
    """Of each mesh the axes of the motions under which its largest connected pieces of free polygons slide best.

    All pieces at once, because most of the time of small ones goes into beginning steps; sums are each piece's own.
    """
    out: list[list[Line]] = [[] for _ in work.total]
    pieces = _pieces(work, free)
    if not pieces:
        return out
    polygon, ends = np.concatenate(pieces), np.cumsum([0, *(len(piece) for piece in pieces)]).tolist()
    runs, sizes = [slice(*run) for run in zip(ends, ends[1:], strict=False)], np.diff(ends)
    area, normal, centre = work.area.take(polygon), work.normals(polygon), work.middles(polygon)
    weight, placed, rows = area, np.ascontiguousarray(centre), np.empty((len(polygon), 6))
    rows[:, 3:] = normal
    # reweighed until what is no thread counts little
    for _ in range(6):
        total = [weight[run].sum() for run in runs]
        middle = np.array([weight[run] @ placed[run] / size for run, size in zip(runs, total, strict=True)])
        arm = centre - repeated(middle, sizes)
        square = dot(arm, arm)
        spread = [float(np.sqrt(weight[run] @ square[run] / size)) for run, size in zip(runs, total, strict=True)]
        reach = np.maximum(spread, ARITHMETIC)
        rows[:, :3] = cross_columns(arm / reach.repeat(sizes)[:, None], normal)
        weighed = rows * weight.repeat(6).reshape(-1, 6)
        matrix = np.stack([weighed[run].T @ rows[run] / size for run, size in zip(runs, total, strict=True)])
        twist = np.linalg.eigh(matrix)[1][:, :, 0]
        speed = np.abs(np.concatenate([rows[run] @ motion for run, motion in zip(runs, twist, strict=True)]))
        typical = np.maximum([median(speed[run]) for run in runs], SINGLE)
        weight = area / (1 + (speed / typical.repeat(sizes)) ** 2)
    for run, motion, about, size in zip(runs, twist, middle, reach.tolist(), strict=True):
        turn = float(np.linalg.norm(motion[:3]))
        # the motion of the piece (radius 1) rotates
        if turn > 0.1:
            axis = motion[:3] / turn
            out[int(work.mesh[polygon[run.start]])].append((axis, about + cross(axis, motion[3:] / turn) * size))
    return out


def _pieces(work: Patchwork, free: Flags) -> list[Ints]:
    """Polygons of the largest connected pieces of free ones, mesh by mesh, where they are enough for a thread."""
    use = (work.b >= 0) & free[work.a]
    use[use] &= free[work.b[use]]
    label = components(work.a[use], work.b[use], work.count)
    area, size = np.bincount(label, work.area * free), np.bincount(label, free)
    # pieces are numbered by their first polygon, and so mesh by mesh
    first = [*label[starts_of(work.mesh, len(work.total))[:-1]].tolist(), len(area)]
    number, count = np.full(len(area), -1), 0
    for low, high in zip(first, first[1:], strict=False):
        # the four largest pieces that no surface explains
        for piece in low + np.argsort(-area[low:high], kind="stable")[:4]:
            if size[piece] >= THREAD_POLYGONS:
                number[piece] = count
                count += 1
    return members(np.where(free, number[label], -1))
