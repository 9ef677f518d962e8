"""Lines on a picture: axes and freedoms of joints, rings around places."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array, Ints
from kinform.model.kinematics import Joint
from kinform.reports.page.constants import PORTION

SIGNAL_COLOUR = "#e8590c"
"""Of what a finding is about."""


Image = NDArray[np.float32]
"""(height, width, 4)."""

TURNING = ("revolute", "cylindrical", "screw", "planar")
SLIDING = ("prismatic", "cylindrical", "screw")


def rgb(colour: str) -> tuple[float, float, float]:
    """ "#rrggbb" as numbers from 0 to 1."""
    return tuple(int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5))  # type: ignore[return-value]


def strokes_of(joint: Joint, point: Array, size: float) -> list[Array]:
    """The sign of a joint at a point (3,) m and so large (m), as lines (n, 3) in the world: axis, arc, arrows,
    rings."""
    if joint.type == "spherical":
        return [_arc(point, axis, 0.8 * size, 0.0, 2.0 * np.pi) for axis in np.eye(3)]
    out = []
    for axis in (joint.axis, joint.axis2):
        if axis is None or joint.type == "fixed":
            continue
        ends = point + 1.5 * size * np.array([-axis, axis])
        out.append(ends)
        if joint.type in TURNING or joint.type == "universal":
            arc = _arc(point + 1.15 * size * axis, axis, 0.5 * size, 0.3, 5.3)
            out += [arc, *_head(arc[-1], arc[-1] - arc[-3], 0.2 * size)]
        if joint.type in SLIDING:
            out += [*_head(ends[1], axis, 0.3 * size), *_head(ends[0], -axis, 0.3 * size)]
    return out


def _across(axis: Array) -> tuple[Array, Array]:
    x, y, z = axis.tolist()
    u = np.array([-y, x, 0.0] if abs(z) < 0.9 else [0.0, -z, y])
    u /= np.linalg.norm(u)
    return u, cross(axis, u)


def _arc(centre: Array, axis: Array, radius: float, start: float, end: float) -> Array:
    u, v = _across(axis)
    # Pieces of an arc: a circle of 150 px is off by half a pixel.
    angle = np.linspace(start, end, 28 + 1)[:, None]
    return np.asarray(centre + radius * (np.cos(angle) * u + np.sin(angle) * v))


def _head(tip: Array, direction: Array, size: float) -> list[Array]:
    """Two strokes of an arrow on each side of its plane."""
    unit = direction / np.linalg.norm(direction)
    root = tip - size * unit
    return [np.array([root + side * 0.42 * size * w, tip]) for w in _across(unit) for side in (-1.0, 1.0)]


def polylines(image: Image, lines: Sequence[Array], width: float) -> None:
    """Lines through points (n, 2) px each, of this width, on an image (height, width, 4); all at once, in portions, for
    a line by itself takes longer to begin than to draw. One with a place that is no number is not drawn."""
    lines = [points for points in lines if np.isfinite(points).all()]
    if not lines:
        return
    starts, ends = (np.concatenate([line[part] for line in lines]) for part in (slice(-1), slice(1, None)))
    size = np.array([image.shape[1], image.shape[0]])
    reach = 0.75 * width  # a corner of a piece is half its diagonal away
    low = np.clip(np.floor(np.minimum(starts, ends) - reach), 0, size).astype(np.int64)
    high = np.clip(np.ceil(np.maximum(starts, ends) + reach) + 1, low, size).astype(np.int64)
    over = np.cumsum(np.prod(high - low, axis=1))  # pixels to look at, up to each piece
    on, begin = np.zeros(image.shape[:2], bool), 0
    while begin < len(over):
        done = over[begin - 1] if begin else 0
        stop = max(begin + 1, int(np.searchsorted(over, done + PORTION, side="right")))
        part = slice(begin, stop)
        _mark(on, starts[part], ends[part], low[part], high[part], width)
        begin = stop
    image[on] = _SIGNAL


def _mark(on: NDArray[np.bool_], starts: Array, ends: Array, low: Ints, high: Ints, width: float) -> None:
    """Mark the pixels of pieces between starts and ends (n, 2) px, each within its box from low to high (n, 2)."""
    columns, rows = (high - low).T
    count = columns * rows
    piece = np.repeat(np.arange(len(count)), count)
    row, column = np.divmod(np.arange(len(piece)) - np.repeat(np.cumsum(count) - count, count), columns[piece])
    column += low[:, 0][piece]
    row += low[:, 1][piece]
    u, v = (ends - starts).T
    length = np.maximum(np.hypot(u, v), SOLVED)[piece]
    u, v = u[piece], v[piece]
    x, y = column - starts[:, 0][piece], row - starts[:, 1][piece]
    along, aside = (x * u + y * v) / length, np.abs(x * v - y * u) / length
    meant = (aside < width / 2) & (along > -width / 2) & (along < length + width / 2)
    on[row[meant], column[meant]] = True


def dashed(image: Image, ends: Array, width: float) -> None:
    """A dashed and dotted line between two ends (2, 2) px, as axes are drawn."""
    box = _box(image, ends, width)
    if box is not None:
        along, aside, length = _along(box, *ends)
        on = (along % 44.0 < 26.0) | ((along % 44.0 > 33.0) & (along % 44.0 < 37.0))
        _paint(image, box, (aside < width / 2) & (along > 0) & (along < length) & on)


def ring(image: Image, centre: Array, radius: float, width: float) -> None:
    """A ring with white borders."""
    box = _box(image, np.array([centre - radius, centre + radius]), 2.0 * width)
    if box is None:
        return
    away = np.abs(np.hypot(box[0] - centre[0], box[1] - centre[1]) - radius)
    _part(image, box)[away < width] = 1.0
    _paint(image, box, away < 0.6 * width)


_SIGNAL = [*rgb(SIGNAL_COLOUR), 1.0]
"""The colour of signals, opaque."""

Pixels = tuple[NDArray[np.int64], NDArray[np.int64]]


def _box(image: Image, points: Array, margin: float) -> Pixels | None:
    """Columns (1, n) and rows (m, 1) of the pixels around two points; None outside of the image."""
    (x, y), (u, v) = points.tolist()
    if not math.isfinite(x + y + u + v):
        return None
    left, top = max(math.floor(min(x, u) - margin), 0), max(math.floor(min(y, v) - margin), 0)
    right = min(math.ceil(max(x, u) + margin) + 1, image.shape[1])
    bottom = min(math.ceil(max(y, v) + margin) + 1, image.shape[0])
    if right <= left or bottom <= top:
        return None
    return np.arange(left, right)[None, :], np.arange(top, bottom)[:, None]


def _along(box: Pixels, start: Array, end: Array) -> tuple[Array, Array, float]:
    """How far along and aside of the line from start to end (2,) px each pixel is, (rows, columns), and its length."""
    (u, v), (a, b) = (end - start).tolist(), start.tolist()
    length = max(float(np.hypot(u, v)), SOLVED)
    x, y = box[0] - a, box[1] - b
    return (x * u + y * v) / length, np.abs(x * v - y * u) / length, length


def _paint(image: Image, box: Pixels, where: NDArray[np.bool_]) -> None:
    _part(image, box)[where] = _SIGNAL


def _part(image: Image, box: Pixels) -> Image:
    """The pixels of an image in a box, to be written to."""
    columns, rows = box[0][0], box[1][:, 0]
    return image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
