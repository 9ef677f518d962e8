"""Pictures put together: figures in their colours with outlines, one layer over another, and the whole made smaller.

A layer is (height, width, 4) of 0 … 1, colours not multiplied by their weight; in memory one colour after the other.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.reports.page.figures import Figure, Floats, Samples, bands, dot
from kinform.reports.page.raster import View

FINER = 2
"""Pixels of the drawing to a pixel of the picture, each way: four samples a pixel, the least that smooth edges need."""
OUTLINE_STEP = 6.0
"""px: where depth changes by more from one pixel to the next, there is an outline; and what is nearer by more,
covers. Chosen by eye."""

MOST_SAMPLES = 2.0**52
"""Samples from the origin of the world from which on one cannot be told from the next, as numbers have 53 bits:
nothing is drawn there."""

Colour = tuple[float, float, float]
Shown = Sequence[tuple[Figure, Colour]]


@dataclass(frozen=True, eq=False)
class _Taken:
    """Which samples of a figure the pixels of a part of the picture show."""

    samples: Samples
    rows: slice
    columns: slice
    """Of the picture."""
    row: Ints
    column: Ints
    """Of the samples, for each of these."""


def layer(view: View, figures: Shown) -> Floats:
    """The figures in their colours, what is nearer before what is not, with outlines."""
    image = np.moveaxis(np.zeros((4, view.height, view.width), np.float32), 0, 2)
    inside = _inside(view, figures)
    if inside is not None:
        rows, columns, view = inside
        image[rows, columns] = _drawn(view, figures)
    return image


def paint(image: Floats, view: View, figures: Shown, weight: float) -> None:
    """Lay figures of this weight over a picture from this view, where they are."""
    inside = _inside(view, figures)
    if inside is not None:
        rows, columns, view = inside
        image[rows, columns] = over(_drawn(view, figures), image[rows, columns], weight)


def _inside(view: View, figures: Shown) -> tuple[slice, slice, View] | None:
    """Rows and columns of the picture in which figures are, and the view of these; None where none are."""
    boxes = [box for box in (_pixels(view, figure) for figure, _ in figures) if box is not None]
    if not boxes:
        return None
    top, left = (min(box[k].start for box in boxes) for k in (0, 1))
    bottom, right = (max(box[k].stop for box in boxes) for k in (0, 1))
    away = np.array([0.5 * (left + right - view.width), -0.5 * (top + bottom - view.height), 0.0]) / view.scale
    part = View(view.target + away, view.scale, right - left, bottom - top)
    return slice(top, bottom), slice(left, right), part


def _drawn(view: View, figures: Shown) -> Floats:
    image = np.zeros((4, view.height, view.width), np.float32)
    near = np.full((view.height, view.width), -np.inf)
    owner = np.full((view.height, view.width), -1, np.int16)
    taken = [_taken(view, figure) for figure, _ in figures]
    for k, item in enumerate(taken):
        if item is not None:
            here = item.samples.near[item.row[:, None], item.column]
            before = here > near[item.rows, item.columns]
            np.copyto(near[item.rows, item.columns], here, where=before)
            np.copyto(owner[item.rows, item.columns], np.int16(k), where=before)
    normal = np.zeros((3, view.height, view.width), np.float32)
    for k, item in enumerate(taken):
        if item is None:
            continue
        row, column = np.nonzero(owner[item.rows, item.columns] == k)
        at = (row + item.rows.start) * view.width + column + item.columns.start
        places = item.row[row] * item.samples.near.shape[1] + item.column[column]
        light = item.samples.light.ravel()[places]
        for c in range(3):
            normal[c].ravel()[at] = item.samples.normal[c].ravel()[places]
            image[c].ravel()[at] = np.minimum(np.float32(figures[k][1][c]) * light, 1.0)
        image[3].ravel()[at] = 1.0
    _outline(image, near, owner, normal, OUTLINE_STEP / view.scale)
    return np.moveaxis(image, 0, 2)


def coarse(view: View) -> View:
    """The view without the finer pixels: enough for what is faint."""
    step = FINER
    return View(view.target, view.scale / step, view.width // step, view.height // step)


def nearness(view: View, figure: Figure, column: int, row: int) -> float:
    """How near (m) a figure is at a pixel; −∞ where it is not seen there."""
    item = _taken(view, figure)
    if item is None or not (
        item.rows.start <= row < item.rows.stop and item.columns.start <= column < item.columns.stop
    ):
        return -np.inf
    return float(item.samples.near[item.row[row - item.rows.start], item.column[column - item.columns.start]])


def _taken(view: View, figure: Figure) -> _Taken | None:
    """The samples nearest to the pixels; None where the figure lies outside of the picture."""
    box = _pixels(view, figure)
    if box is None:
        return None
    (rows, columns), found = box, figure.samples(view)
    farthest = np.abs(view.target[:2]).max() + max(view.width, view.height) / view.scale
    if not max(farthest * found.scale, abs(found.left), abs(found.top)) < MOST_SAMPLES:
        return None
    middle = np.array([0.5 * view.width, 0.5 * view.height])
    x = view.target[0] + (np.arange(columns.start, columns.stop) + 0.5 - middle[0]) / view.scale
    y = view.target[1] - (np.arange(rows.start, rows.stop) + 0.5 - middle[1]) / view.scale
    column = np.rint(x * found.scale).astype(np.int64) - found.left
    row = np.rint(-y * found.scale).astype(np.int64) - found.top
    inside, below = (
        np.flatnonzero((k >= 0) & (k < n)) for k, n in zip((column, row), found.near.shape[::-1], strict=True)
    )
    if not len(inside) or not len(below):
        return None
    return _Taken(
        found,
        slice(rows.start + int(below[0]), rows.start + int(below[-1]) + 1),
        slice(columns.start + int(inside[0]), columns.start + int(inside[-1]) + 1),
        row[below],
        column[inside],
    )


def _pixels(view: View, figure: Figure) -> tuple[slice, slice] | None:
    """Rows and columns of the picture in which the figure is; None where it lies outside."""
    corners = view.project(figure.box)
    if not np.isfinite(corners).all():
        return None
    left, right = corners[0, 0], corners[1, 0]
    top, bottom = corners[1, 1], corners[0, 1]
    columns = slice(max(int(np.floor(left)), 0), min(int(np.ceil(right)) + 1, view.width))
    rows = slice(max(int(np.floor(top)), 0), min(int(np.ceil(bottom)) + 1, view.height))
    return (rows, columns) if columns.start < columns.stop and rows.start < rows.stop else None


def _outline(image: Floats, near: Array, owner: NDArray[np.int16], normal: Floats, step: float) -> None:
    """Darken where the part, the direction or the depth changes from one pixel to the next."""
    height, width = near.shape
    line = np.zeros(near.shape, bool)
    for band in bands(height, width):
        more = slice(band.start, band.stop + 1)  # and the row below
        part, depth, turn = owner[more], near[more], normal[:, more]
        for axis in (0, 1):
            here = tuple(slice(None, -1) if k == axis else slice(None) for k in (0, 1))
            there = tuple(slice(1, None) if k == axis else slice(None) for k in (0, 1))
            # Cosine of the change of direction from one pixel to the next above which there is none (31°). Chosen by
            # eye, with the brightness below.
            turned = dot(turn[:, *here], turn[:, *there]) < 0.86
            with np.errstate(invalid="ignore"):  # nothing beside nothing
                turned |= np.abs(depth[here] - depth[there]) > step
            changed = (part[here] != part[there]) | (turned & (part[here] >= 0))
            line[more][here] |= changed
            line[more][there] |= changed
    line &= owner >= 0
    for colour in image[:3]:
        # Brightness of outlines.
        np.multiply(colour, np.float32(0.52), out=colour, where=line)


def over(front: Floats, back: Floats, weight: float, faint: float = 1.0) -> Floats:
    """The front, of this weight, over the back, itself of weight `faint`."""
    out = np.moveaxis(np.empty((4, *front.shape[:2]), np.float32), 0, 2)
    for band in bands(*front.shape[:2]):
        a = front[band, :, 3] * np.float32(weight)
        # where the front lies behind something faint, that shows a little
        b = back[band, :, 3] * np.float32(faint) * (1.0 - a)
        whole = out[band, :, 3] = a + b
        whole = np.maximum(whole, np.float32(1e-9))
        for k in range(3):
            out[band, :, k] = (front[band, :, k] * a + back[band, :, k] * b) / whole
    return out


def smaller(image: Floats) -> Floats:
    """Each block of finer pixels as one, colours by their weight."""
    height, width = (n // FINER for n in image.shape[:2])
    out = np.empty((4, height, width), np.float32)
    for band in bands(height, FINER * FINER * width):
        fine = image[FINER * band.start : FINER * band.stop]
        weight = out[3][band] = _blocks(fine[..., 3])
        weight = np.maximum(weight, np.float32(1e-9))
        for k in range(3):
            out[k][band] = _blocks(fine[..., k] * fine[..., 3]) / weight
    return np.moveaxis(out, 0, 2)


def whole_numbers(image: Floats) -> NDArray[np.uint8]:
    """The same of 0 … 255."""
    return np.asarray(np.rint(255.0 * np.clip(image, 0.0, 1.0)), np.uint8)


def _blocks(fine: Floats) -> Floats:
    """Mean of each block of finer pixels."""
    steps = range(FINER)
    return np.asarray(sum(fine[i::FINER, j::FINER] for i in steps for j in steps) / np.float32(FINER**2))
