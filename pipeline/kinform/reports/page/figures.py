"""Shapes as they look from the eye's side, drawn once each: pictures are put together from samples of them.

All pictures look from the same side along parallel rays, so they show a shape alike, but for its size and place. What a
shape shows (how near it is, its light, where it faces) is therefore sampled once on a grid as fine as the finest of the
pictures asks for, and each picture takes the nearest samples.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.rounding import ARITHMETIC, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.reports.page.constants import PORTION
from kinform.reports.page.meshes import Shape
from kinform.reports.page.raster import AXES, Buffers, View, rasterise

MOST_SAMPLED = 4_000_000
"""Samples of a whole shape: 80 MB. Chosen, not measured."""


Floats = NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Samples:
    """What a shape shows on a grid of this fineness; −∞ near where it shows nothing."""

    scale: float
    """Samples a metre."""
    left: int
    top: int
    """Column of the first sample, to the right, and its row, downwards: that at (left/scale, −top/scale) in the axes of
    the eye."""
    near: Array
    """(rows, columns) m, towards the eye."""
    light: Floats
    """(rows, columns), the share of its colour that it shows."""
    normal: Floats
    """(3, rows, columns) unit, towards the eye."""


class Figure:
    """A shape at a pose in the world; of a closed one only what faces the eye."""

    def __init__(self, shape: Shape, pose: Array, closed: bool):
        turn = AXES @ pose[:3, :3]
        self.vertices: Array = shape.vertices @ turn.T + AXES @ pose[:3, 3]
        """(V, 3) m, in the axes of the eye."""
        self.box = np.array([self.vertices.min(axis=0), self.vertices.max(axis=0)])
        """(2, 3) lowest and highest corner of the same."""
        self._normals = shape.normals @ turn.T
        self._faces = shape.faces
        if closed:
            x, y = self.vertices[:, 0], self.vertices[:, 1]
            a, b, c = self._faces.T
            self._faces = self._faces[(x[b] - x[a]) * (y[c] - y[a]) > (y[b] - y[a]) * (x[c] - x[a])]
        self._finest = 0.0
        self._drawn: dict[float, Samples] = {}

    def expect(self, view: View) -> None:
        """Be told of a view that will be asked for: coarser pictures then share what it shows of nearly all of it."""
        if self._is_seen(view):
            self._finest = max(self._finest, view.scale)

    def samples(self, view: View) -> Samples:
        """Samples at least as fine as the view's pixels: of all of it where most of it is seen, else of what is."""
        scale = max(view.scale, self._finest)
        for fine in (scale, view.scale) if self._is_seen(view) else ():
            grid = self._grid(fine, self.box)
            if grid[2] * grid[3] <= MOST_SAMPLED:
                if fine not in self._drawn:
                    self._drawn[fine] = self._draw(fine, *grid)
                return self._drawn[fine]
        known = self._drawn.get(scale) or self._drawn.get(view.scale)
        return known or self._draw(view.scale, *self._grid(view.scale, self._seen(view)))

    def _is_seen(self, view: View) -> bool:
        """Whether what the view shows is so much of the shape that all of it is as soon drawn."""
        (_, _, width, height), (_, _, wide, high) = (
            self._grid(view.scale, box) for box in (self.box, self._seen(view))
        )
        # Nor is a shape sampled whole that has four times as many samples as a picture shows of them, as of a machine
        # beside the screw that it is about, only what the picture shows is drawn.
        return width * height <= min(4 * wide * high, MOST_SAMPLED)

    def _seen(self, view: View) -> Array:
        """(2, 2) what the view shows of the box; of nothing, a place."""
        seen = np.array([[-0.5 * view.width, -0.5 * view.height], [0.5 * view.width, 0.5 * view.height]]) / view.scale
        low, high = view.target[:2] + seen
        low = np.maximum(self.box[0, :2], low)
        return np.array([low, np.maximum(np.minimum(self.box[1, :2], high), low)])

    @staticmethod
    def _grid(scale: float, box: Array) -> tuple[int, int, int, int]:
        """First column and row, and how many of them, that hold the box."""
        left, top = math.floor(scale * box[0, 0]), math.floor(-scale * box[1, 1])
        right, bottom = math.ceil(scale * box[1, 0]), math.ceil(-scale * box[0, 1])
        return left, top, max(right - left, 0) + 1, max(bottom - top, 0) + 1

    def _draw(self, scale: float, left: int, top: int, width: int, height: int) -> Samples:
        # the middle of a pixel, half a pixel from its border, is the place of a sample
        middle = np.array([(left + 0.5 * width - 0.5) / scale, -(top + 0.5 * height - 0.5) / scale, 0.0])
        view = View(middle, scale, width, height)
        projected = view.project(self.vertices)
        faces = _within(view, projected, self._faces)
        light = np.zeros((height, width), np.float32)
        normal = np.zeros((3, height, width), np.float32)
        if not len(faces):
            return Samples(scale, left, top, np.full((height, width), -np.inf), light, normal)
        corners = projected[faces]
        buffers = rasterise(view, corners)
        _shade(light, normal, buffers, corners, faces, np.ascontiguousarray(self._normals.T))
        return Samples(scale, left, top, np.where(buffers.facet < 0, -np.inf, buffers.near), light, normal)


def _within(view: View, projected: Array, faces: Ints) -> Ints:
    """Those of the faces that may cover the middle of a pixel of the picture."""
    a, b, c = faces.T
    keep = np.ones(len(faces), bool)
    for k, end in ((0, view.width), (1, view.height)):
        at = projected[:, k] - 0.5
        low = np.minimum(np.minimum(at[a], at[b]), at[c])
        high = np.maximum(np.maximum(at[a], at[b]), at[c])
        keep &= (high >= 0.0) & (low <= end - 1) & (np.floor(high) >= np.ceil(low))
    return faces[keep]


def _shade(light: Floats, normal: Floats, buffers: Buffers, corners: Array, faces: Ints, normals: Array) -> None:
    """Light on what is seen, and where it faces.

    Numbers of one kind lie in long rows, as numpy is slow where the last axis is short.
    """
    height, width = buffers.facet.shape
    for band in bands(height, width):
        pixel = np.flatnonzero(buffers.facet[band] >= 0) + band.start * width
        row, column = np.divmod(pixel, width)
        facet = buffers.facet.ravel()[pixel]
        weights = _weights(corners, facet, column + 0.5, row + 0.5)
        vertices = faces[facet].T
        turned = np.array([sum(w * axis[k] for w, k in zip(weights, vertices, strict=True)) for axis in normals])
        turned /= np.maximum(np.sqrt(dot(turned, turned)), TINY)
        turned *= np.where(turned[2] < 0.0, -1.0, 1.0)
        light.reshape(-1)[pixel] = _light(turned)
        normal.reshape(3, -1)[:, pixel] = turned


def dot(a: Array | Floats, b: Array | Floats) -> Array:
    """Sums of products over the first axis, of three."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def bands(height: int, width: int) -> Iterator[slice]:
    """Rows in portions that stay in the processor's cache: a picture at once takes more than twice the time."""
    step = max(1, PORTION // max(width, 1))
    for start in range(0, height, step):
        yield slice(start, min(start + step, height))


def _weights(corners: Array, facet: Ints, x: Array, y: Array) -> Array:
    """(3, n) barycentric weights of points in those of the facets, of corners (t, 3, 3)."""
    (ax, ay), (bx, by), (cx, cy) = (corners[facet, k, :2].T for k in range(3))
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    area = ux * vy - uy * vx
    area = np.where(np.abs(area) < ARITHMETIC, np.inf, area)
    px, py = x - ax, y - ay
    s = (px * vy - py * vx) / area
    t = (ux * py - uy * px) / area
    return np.asarray(np.clip(np.array([1.0 - s - t, s, t]), 0.0, 1.0))


def _light(normal: Array) -> Array:
    """The same matt light as in the viewer, on places that face these ways (3, n)."""
    key = np.maximum(dot(normal, np.array([-0.35, 0.75, 0.60]) / 1.0223), 0.0)
    fill = np.maximum(dot(normal, np.array([0.70, 0.05, 0.45]) / 0.8337), 0.0)
    sky = 0.5 + 0.5 * normal[1]
    return np.asarray(0.34 + 0.20 * sky + 0.50 * key + 0.16 * fill)
