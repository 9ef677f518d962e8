"""Pictures of the assembly and of findings, drawn by `raster`, for pull requests and for print.

Whole parts in the colours of their bodies; a finding's parts in full, everything else faint, what it is about
marked by a ring, overlaps red. The background is transparent.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.reports.page.colours import OVERLAP, SIGNAL, rgb
from kinform.reports.page.png import png
from kinform.reports.page.raster import Buffers, View, rasterise, view_of
from kinform.reports.page.scene import Scene, subjects

__all__ = ["finding_picture", "overview_picture"]

Array = NDArray[np.float64]

FINER = 2
"""Pixels of the drawing to a pixel of the picture, each way."""
FAINT = 0.22
"""Weight of what a finding is not about."""


@dataclass(frozen=True, eq=False)
class _Item:
    """A shape in the world with its colour."""

    corners: Array
    """(t, 3, 3) m."""
    normals: Array
    """(t, 3, 3) unit, at the corners."""
    colour: tuple[float, float, float]


def overview_picture(scene: Scene, width: int = 960, height: int = 600) -> bytes:
    """The whole assembly, with overlaps in red, as PNG."""
    names = [part.name for part in scene.design.assembly.parts]
    items = _items(scene, names)
    if not items:
        return png(np.zeros((height, width, 4), np.uint8))
    view = view_of(_cloud(items), FINER * width, FINER * height)
    image = _drawn(view, items)
    red = _red(scene, lambda item: True)
    if red:
        image = _over(_drawn(view, red), image, 0.75)
    return png(_reduced(image))


def finding_picture(scene: Scene, index: int, width: int = 480, height: int = 320) -> bytes:
    """What a finding is about, as PNG."""
    report = scene.design.report
    assert report is not None
    finding = report.findings[index]
    parts, joints = subjects(scene.design, finding.subject)
    ends = {body for joint in scene.joints if joint.name in joints for body in joint.bodies}
    parts += [p for body in scene.bodies if body.name in ends for p in body.parts if p not in parts]
    names = [part.name for part in scene.design.assembly.parts]
    chosen, rest = [n for n in names if n in parts], [n for n in names if n not in parts]
    if not chosen:
        chosen, rest = names, []
    items, others = _items(scene, chosen), _items(scene, rest)
    if not items:
        return png(np.zeros((height, width, 4), np.uint8))
    view = view_of(_cloud(items), FINER * width, FINER * height, margin=1.35)
    image = _drawn(view, items)
    if others:
        image = _over(image, _drawn(view, others), 1.0, FAINT)
    red = _red(scene, lambda item: set(item) <= set(chosen))
    if red:
        image = _over(_drawn(view, red), image, 0.8)
    lines = [_axis(scene, k) for k, joint in enumerate(scene.joints) if joint.name in joints and joint.axis is not None]
    for line in lines:
        _stroke(image, view.project(line)[:, :2], 2.0 * FINER)
    if finding.place is not None:
        _ring(image, view.project(np.array([finding.place]))[0, :2], 15.0 * FINER, 2.0 * FINER)
    return png(_reduced(image))


def _axis(scene: Scene, k: int) -> Array:
    point, size = scene.placed(scene.joints[k])
    axis = scene.joints[k].axis
    assert axis is not None
    return np.array([point - 1.6 * size * axis, point + 1.6 * size * axis])


def _items(scene: Scene, names: list[str]) -> list[_Item]:
    wanted = set(names)
    out = []
    for part in scene.design.assembly.parts:
        if part.mesh is None or part.name not in wanted or not len(part.mesh.faces):
            continue
        corners, normals = scene.placed_corners(part.name)
        out.append(_Item(corners, normals, rgb(scene.colours[scene.body_index[part.name]])))
    return out


def _red(scene: Scene, wanted: Callable[[tuple[str, str]], bool]) -> list[_Item]:
    found = [] if scene.design.contacts is None else scene.design.contacts.interferences
    return [
        _Item(shape.vertices[shape.faces], shape.normals[shape.faces], rgb(OVERLAP))
        for item, shape in zip(found, scene.overlaps, strict=True)
        if shape is not None and len(shape.faces) and wanted(item.parts)
    ]


def _cloud(items: list[_Item]) -> Array:
    return np.concatenate([item.corners.reshape(-1, 3) for item in items])


def _drawn(view: View, items: list[_Item]) -> Array:
    """(height, width, 4) of 0 … 1, colours not multiplied by their weight."""
    corners = np.concatenate([item.corners for item in items])
    normals = np.concatenate([item.normals for item in items])
    colours = np.repeat(np.array([item.colour for item in items]), [len(item.corners) for item in items], axis=0)
    owner = np.repeat(np.arange(len(items)), [len(item.corners) for item in items])
    projected = view.project(corners.reshape(-1, 3)).reshape(-1, 3, 3)
    buffers = rasterise(view, projected)
    image = np.zeros((view.height, view.width, 4))
    seen = buffers.facet >= 0
    facet = buffers.facet[seen]
    rows, columns = np.nonzero(seen)
    weights = _weights(projected[facet], columns + 0.5, rows + 0.5)
    normal = np.einsum("nk,nki->ni", weights, normals[facet]) @ view.R.T
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    normal *= np.where(normal[:, 2:] < 0.0, -1.0, 1.0)
    image[seen, :3] = _lit(colours[facet], normal)
    image[seen, 3] = 1.0
    _outline(image, buffers, seen, owner, normal, view)
    return image


def _weights(corners: Array, x: Array, y: Array) -> Array:
    """(n, 3) barycentric weights of points in their facets."""
    a, b, c = (corners[:, k, :2] for k in range(3))
    u, v = b - a, c - a
    area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    area = np.where(np.abs(area) < 1e-12, np.inf, area)
    px, py = x - a[:, 0], y - a[:, 1]
    s = (px * v[:, 1] - py * v[:, 0]) / area
    t = (u[:, 0] * py - u[:, 1] * px) / area
    return np.clip(np.stack([1.0 - s - t, s, t], axis=1), 0.0, 1.0)


def _lit(colour: Array, normal: Array) -> Array:
    """The same matt light as in the viewer."""
    key = np.maximum(normal @ (np.array([-0.35, 0.75, 0.60]) / 1.0223), 0.0)
    fill = np.maximum(normal @ (np.array([0.70, 0.05, 0.45]) / 0.8337), 0.0)
    sky = 0.5 + 0.5 * normal[:, 1]
    return np.asarray(np.clip(colour * (0.34 + 0.20 * sky + 0.50 * key + 0.16 * fill)[:, None], 0.0, 1.0))


def _outline(
    image: Array, buffers: Buffers, seen: NDArray[np.bool_], owner: NDArray[np.int64], normal: Array, view: View
) -> None:
    """Darken where the part, the direction or the depth changes from one pixel to the next."""
    part = np.where(seen, owner[np.maximum(buffers.facet, 0)], -1)
    direction = np.zeros((*seen.shape, 3))
    direction[seen] = normal
    step = 6.0 / view.scale
    line = np.zeros(seen.shape, bool)
    for axis in (0, 1):
        here = tuple(slice(None, -1) if k == axis else slice(None) for k in (0, 1))
        there = tuple(slice(1, None) if k == axis else slice(None) for k in (0, 1))
        turned = np.einsum("ijk,ijk->ij", direction[here], direction[there]) < 0.86
        apart = np.abs(buffers.near[here] - buffers.near[there]) > step
        both = seen[here] & seen[there]
        changed = (part[here] != part[there]) | (both & (turned | apart))
        line[here] |= changed
        line[there] |= changed
    image[line & seen, :3] *= 0.52


def _over(front: Array, back: Array, weight: float, faint: float = 1.0) -> Array:
    """The front, of this weight, over the back, itself of weight `faint`."""
    a = front[..., 3:] * weight
    b = back[..., 3:] * faint
    # where the front lies behind something faint, that shows a little
    whole = a + b * (1.0 - a)
    colour = (front[..., :3] * a + back[..., :3] * b * (1.0 - a)) / np.maximum(whole, 1e-9)
    return np.concatenate([colour, whole], axis=2)


def _stroke(image: Array, ends: Array, width: float) -> None:
    height, across = image.shape[:2]
    y, x = np.mgrid[0:height, 0:across]
    way = ends[1] - ends[0]
    length = max(float(np.linalg.norm(way)), 1e-9)
    along = ((x - ends[0, 0]) * way[0] + (y - ends[0, 1]) * way[1]) / length
    aside = np.abs((x - ends[0, 0]) * way[1] - (y - ends[0, 1]) * way[0]) / length
    dashed = (along % 44.0 < 26.0) | ((along % 44.0 > 33.0) & (along % 44.0 < 37.0))
    _paint(image, (aside < width / 2) & (along > 0) & (along < length) & dashed)


def _ring(image: Array, centre: Array, radius: float, width: float) -> None:
    height, across = image.shape[:2]
    y, x = np.mgrid[0:height, 0:across]
    away = np.hypot(x - centre[0], y - centre[1])
    white = np.abs(away - radius) < width
    image[white] = [1.0, 1.0, 1.0, 1.0]
    _paint(image, np.abs(away - radius) < 0.6 * width)


def _paint(image: Array, where: NDArray[np.bool_]) -> None:
    image[where] = [*rgb(SIGNAL), 1.0]


def _reduced(image: Array) -> NDArray[np.uint8]:
    """Each block of finer pixels as one, colours by their weight."""
    weighted = np.concatenate([image[..., :3] * image[..., 3:], image[..., 3:]], axis=2)
    height, width = (n // FINER for n in image.shape[:2])
    mean = weighted.reshape(height, FINER, width, FINER, 4).mean(axis=(1, 3))
    mean[..., :3] /= np.maximum(mean[..., 3:], 1e-9)
    return np.rint(255.0 * np.clip(mean, 0.0, 1.0)).astype(np.uint8)
