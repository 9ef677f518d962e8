"""Triangles to pixels without a graphics card, and pixels to PNG files: spans of scan lines, a depth buffer.

All triangles of a picture are worked on at once: rows of each, then pixels of each row, in portions that fit in
memory. Shading is done once a pixel at the end, from the number of the facet that is seen there.
"""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.rounding import ARITHMETIC, SOLVED, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.reports.constants import EYE_RISE, EYE_TURN
from kinform.reports.page.constants import PORTION, ZLIB_EFFORT

VIEW_MARGIN = 1.08
"""Size of a picture over that of what it holds: a margin of 4 % on each side. Chosen by eye."""


NOTHING = np.uint64(0xFFFFFFFFFFFFFFFF)
"""Key of a pixel that nothing covers: farther than all depths."""


def _axes() -> Array:
    """(3, 3) rows: right, up, towards the eye."""
    back = np.array([np.cos(EYE_RISE) * np.cos(EYE_TURN), np.cos(EYE_RISE) * np.sin(EYE_TURN), np.sin(EYE_RISE)])
    right = np.array([-np.sin(EYE_TURN), np.cos(EYE_TURN), 0.0])
    return np.array([right, np.cross(back, right), back])


AXES = _axes()


@dataclass(frozen=True, eq=False)
class View:
    """What part of the world, turned into the axes of the eye, a picture shows; rays are parallel."""

    target: Array
    """(3,) m, in the axes of the eye, in the middle of the picture."""
    scale: float
    """Pixels a metre."""
    width: int
    height: int

    def project(self, seen: Array) -> Array:
        """(n, 3) pixels to the right, pixels down, nearness (m), of places (n, 3) in the axes of the eye."""
        out = (seen - self.target) * np.array([self.scale, -self.scale, 1.0])
        out += np.array([0.5 * self.width, 0.5 * self.height, 0.0])
        return np.asarray(out)


@dataclass(frozen=True, eq=False)
class Buffers:
    """Of each pixel (height, width): the facet in front, −1 where there is none, and its nearness (m)."""

    facet: Ints
    near: Array


def view_of(seen: Array, width: int, height: int, margin: float = VIEW_MARGIN) -> View:
    """The view that holds all places (n, 3), given in the axes of the eye."""
    low, high = seen.min(axis=0), seen.max(axis=0)
    span = np.maximum(high - low, SOLVED * max(float((high - low).max()), SOLVED))
    scale = min(width / (margin * span[0]), height / (margin * span[1]))
    return View(0.5 * (low + high), float(scale), width, height)


@dataclass(frozen=True, eq=False)
class _DepthBuffer:
    """Of each pixel what is in front: how far away it is in the higher half of the number, the facet in the lower."""

    keys: NDArray[np.uint64]
    low: float
    reach: float
    """m: nearness of the furthest corner, and from there to the nearest."""


def rasterise(view: View, corners: Array) -> Buffers:
    """What is in front at each pixel, of facets (t, 3, 3) given as `view.project` gives their corners."""
    low = float(corners[..., 2].min(initial=0.0))
    reach = max(float(corners[..., 2].max(initial=1.0)) - low, TINY)
    buffer = _DepthBuffer(np.full(view.width * view.height, NOTHING), low, reach)
    rows = _rows(view, corners)
    begin = 0
    lengths = np.maximum(rows.last - rows.first + 1, 0)
    ends = np.cumsum(lengths)
    while begin < len(lengths):
        done = int(ends[begin - 1]) if begin else 0
        stop = max(begin + 1, int(np.searchsorted(ends, done + PORTION)))
        _fill(view, corners, rows, lengths, slice(begin, stop), buffer)
        begin = stop
    facet = np.where(buffer.keys == NOTHING, -1, (buffer.keys & np.uint64(0xFFFFFFFF)).astype(np.int64))
    near = low + reach * (1.0 - (buffer.keys >> np.uint64(32)).astype(np.float64) / 0xFFFFFFFE)
    return Buffers(facet.reshape(view.height, view.width), near.reshape(view.height, view.width))


@dataclass(frozen=True, eq=False)
class _Rows:
    """Rows of pixels within facets: facet, row, first and last column."""

    facet: Ints
    row: Ints
    first: Ints
    last: Ints


def _rows(view: View, corners: Array) -> _Rows:
    """The middles of pixels within each facet, row by row, between the crossings of its edges with the row."""
    top = np.clip(np.ceil(_least(corners[..., 1]) - 0.5), 0, view.height).astype(np.int64)
    bottom = np.clip(np.floor(-_least(-corners[..., 1]) - 0.5), -1, view.height - 1).astype(np.int64)
    count = np.maximum(bottom - top + 1, 0)
    facet = np.repeat(np.arange(len(corners)), count)
    row = np.arange(len(facet)) - np.repeat(np.cumsum(count) - count, count) + top[facet]
    middle = row + 0.5
    left, right = np.full(len(facet), np.inf), np.full(len(facet), -np.inf)
    xs, ys = (np.ascontiguousarray(corners[..., k].T) for k in (0, 1))
    for k in range(3):
        run, rise = xs[(k + 1) % 3] - xs[k], ys[(k + 1) % 3] - ys[k]
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (middle - ys[k][facet]) / rise[facet]  # not a number, or infinite, along a level edge
            x = xs[k][facet] + share * run[facet]
        met = (share >= 0.0) & (share <= 1.0)
        np.minimum(left, x, out=left, where=met)
        np.maximum(right, x, out=right, where=met)
    seen = left <= right
    facet, row, left, right = facet[seen], row[seen], left[seen], right[seen]
    first = np.clip(np.ceil(left - 0.5), 0, view.width).astype(np.int64)
    last = np.clip(np.floor(right - 0.5), -1, view.width - 1).astype(np.int64)
    wide = last >= first
    return _Rows(facet[wide], row[wide], first[wide], last[wide])


def _least(values: Array) -> Array:
    """Of each row of three; much faster than a reduction over a short axis."""
    return np.asarray(np.minimum(np.minimum(values[:, 0], values[:, 1]), values[:, 2]))


def _fill(view: View, corners: Array, rows: _Rows, lengths: Ints, part: slice, buffer: _DepthBuffer) -> None:
    """The pixels of some of the rows, each with its depth in the plane of its facet."""
    facet, count = rows.facet[part], lengths[part]
    start = np.cumsum(count) - count
    column = np.arange(int(count.sum())) - np.repeat(start - rows.first[part], count)
    a, b, c = (corners[facet, k] for k in range(3))
    u, v = b - a, c - a
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    area = np.where(np.abs(area) < ARITHMETIC, np.inf, area)
    slope_x = (u[:, 2] * v[:, 1] - v[:, 2] * u[:, 1]) / area
    slope_y = (v[:, 2] * u[:, 0] - u[:, 2] * v[:, 0]) / area
    base = a[:, 2] + slope_y * (rows.row[part] + 0.5 - a[:, 1]) - slope_x * (a[:, 0] - 0.5)
    near = np.repeat(base, count) + np.repeat(slope_x, count) * column
    far = np.clip((1.0 - (near - buffer.low) / buffer.reach), 0.0, 1.0)
    key = (far * 0xFFFFFFFE).astype(np.uint64) << np.uint64(32) | np.repeat(facet, count).astype(np.uint64)
    np.minimum.at(buffer.keys, np.repeat(rows.row[part] * view.width, count) + column, key)


def png(pixels: NDArray[np.uint8]) -> bytes:
    """The image (height, width, 3 or 4) as a PNG; rows are stored as differences to the pixel at the left (ISO/IEC
    15948)."""
    height, width, depth = pixels.shape
    rows = pixels.astype(np.int16)
    rows[:, 1:] -= pixels[:, :-1]
    flat = np.concatenate([np.full((height, 1), 1, np.uint8), rows.astype(np.uint8).reshape(height, -1)], axis=1)
    head = struct.pack(">IIBBBBB", width, height, 8, {3: 2, 4: 6}[depth], 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(flat.tobytes(), ZLIB_EFFORT)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(*chunk) for chunk in chunks)


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
