"""Pictures of the assembly and of findings, drawn by `raster`, for pull requests and for print.

Whole parts in the colours of their bodies; a finding's parts in full, everything else faint, what it is about
marked by a ring, overlaps red. The background is transparent.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from kinform.model.arrays import Array, Ints
from kinform.reports import constants
from kinform.reports.page.meshes import Shape
from kinform.reports.page.raster import AXES, Buffers, View, png, rasterise, view_of
from kinform.reports.page.scene import Scene
from kinform.reports.page.strokes import dashed, polyline, rgb, ring, strokes_of


@dataclass(frozen=True, eq=False)
class _Item:
    """A shape with its colour, in the axes of the eye."""

    vertices: Array
    """(V, 3) m."""
    faces: Ints
    """(t, 3), those that may be seen."""
    normals: Array
    """(V, 3) unit."""
    colour: tuple[float, float, float]


class Artist:
    """Draws one scene; what parts look like from the eye's side is worked out once."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self.known: dict[str, _Item] = {}
        self.drawn: dict[int, bytes] = {}
        self.wholes: dict[tuple[int, int], bytes] = {}

    def overview(self, width: int = constants.OVERVIEW_WIDTH, height: int = constants.OVERVIEW_HEIGHT) -> bytes:
        """The whole assembly with the axes of its joints, overlaps in red, as PNG; drawn once of each size."""
        if (width, height) not in self.wholes:
            self.wholes[width, height] = self._overview(width, height)
        return self.wholes[width, height]

    def _overview(self, width: int, height: int) -> bytes:
        items = self._items([part.name for part in self.scene.design.assembly.parts])
        signs = [
            stroke @ AXES.T for joint in self.scene.joints for stroke in strokes_of(joint, *self.scene.sign_of(joint))
        ]
        if not items and not signs:
            return png(np.zeros((height, width, 4), np.uint8))
        places = np.concatenate([*signs, *(item.vertices for item in items)])
        view = view_of(
            places,
            constants.FINER * width,
            constants.FINER * height,
            constants.VIEW_MARGIN if items else constants.SIGNS_MARGIN,
        )
        image = _image(view, items)
        red = self._red(lambda parts: True)
        if red:
            image = _over(_image(view, red), image, constants.OVERLAP_WEIGHT)
        for stroke in signs:
            polyline(image, view.project(stroke)[:, :2], 2.0 * constants.FINER)
        return png(_reduced(image))

    def finding(self, index: int) -> bytes:
        """What a finding is about, as PNG; drawn once."""
        if index not in self.drawn:
            self.drawn[index] = self._finding(index, constants.PICTURE_WIDTH, constants.PICTURE_HEIGHT)
        return self.drawn[index]

    def _finding(self, index: int, width: int, height: int) -> bytes:
        scene, focus = self.scene, self.scene.focuses[index]
        moved = scene.movements[focus.movement].at(focus.time) if focus.movement >= 0 else {}
        ends = {body for joint in scene.joints if joint.name in focus.joints for body in joint.bodies}
        parts = [*focus.parts, *(p for body in scene.bodies if body.name in ends for p in body.parts)]
        names = [part.name for part in scene.design.assembly.parts]
        chosen, rest = [n for n in names if n in parts], [n for n in names if n not in parts]
        if not chosen:
            chosen, rest = names, []
        items, others = self._items(chosen, moved, focus.meeting), self._items(rest, moved)
        if not items:
            return png(np.zeros((height, width, 4), np.uint8))
        view = view_of(
            _cloud(items), constants.FINER * width, constants.FINER * height, margin=constants.FINDING_MARGIN
        )
        place = None if focus.place is None else AXES @ focus.place
        if place is not None:
            view = replace(
                view,
                target=(1.0 - constants.FINDING_SHIFT) * view.target + constants.FINDING_SHIFT * place,
                scale=constants.FINDING_ZOOM * view.scale,
            )
        covers = [_covers(view, item, place) for item in items] if focus.meeting and place is not None else []
        before = [item for item, hides in zip(items, covers, strict=False) if hides]
        if before and len(before) < len(items):
            behind = [item for item, hides in zip(items, covers, strict=True) if not hides]
            image = _over(_image(view, before), _image(view, behind), constants.GLASS)
        else:
            image = _image(view, items)
        if others:
            image = _over(image, _coarse(view, others), 1.0, constants.FAINT)
        red = self._red(lambda both: not moved and set(both) <= set(chosen))
        if red:
            image = _over(_image(view, red), image, constants.FINDING_OVERLAP_WEIGHT)
        for joint in scene.joints:
            if joint.name in focus.joints and joint.axis is not None and not moved:
                point, size = scene.sign_of(joint)
                ends_of_axis = np.array([point - 1.6 * size * joint.axis, point + 1.6 * size * joint.axis])
                dashed(image, view.project(ends_of_axis @ AXES.T)[:, :2], 2.0 * constants.FINER)
        if place is not None:
            ring(image, view.project(place[None])[0, :2], 15.0 * constants.FINER, 2.0 * constants.FINER)
        return png(_reduced(image))

    def _items(
        self, names: Sequence[str], moved: Mapping[str, Array] | None = None, meeting: Sequence[str] = ()
    ) -> list[_Item]:
        """Parts in the colours of their bodies, those that meet in red; `moved` are displacements of bodies."""
        wanted = set(names)
        out = []
        for part in self.scene.design.assembly.parts:
            if part.mesh is None or part.name not in wanted or not len(part.mesh.faces):
                continue
            body = self.scene.body_index[part.name]
            colour = rgb(self.scene.colours[body])
            if part.name in meeting:
                colour = tuple(
                    (1.0 - constants.TINT) * own + constants.TINT * red
                    for own, red in zip(colour, rgb(constants.OVERLAP_COLOUR), strict=True)
                )  # type: ignore[assignment]
            away = (moved or {}).get(self.scene.bodies[body].name)
            item = self.known.get(part.name) if away is None else None
            if item is None:
                health = part.mesh.health
                closed = health.watertight and health.consistent_winding and health.volume > 0.0
                pose = part.X_WP if away is None else away @ part.X_WP
                item = _item(self.scene.shapes[part.mesh.digest], pose, colour, closed)
                if away is None:
                    self.known[part.name] = item
            out.append(replace(item, colour=colour))
        return out

    def _red(self, wanted: Callable[[tuple[str, str]], bool]) -> list[_Item]:
        overlaps = [] if self.scene.design.contacts is None else self.scene.design.contacts.interferences
        return [
            _item(shape, np.eye(4), rgb(constants.OVERLAP_COLOUR), False)
            for item, shape in zip(overlaps, self.scene.overlaps, strict=True)
            if shape is not None and len(shape.faces) and wanted(item.parts)
        ]


def _item(shape: Shape, pose: Array, colour: tuple[float, float, float], closed: bool) -> _Item:
    """The shape at this pose in the world; of a closed one only what faces the eye."""
    turn = AXES @ pose[:3, :3]
    vertices = shape.vertices @ turn.T + AXES @ pose[:3, 3]
    faces = shape.faces
    if closed:
        x, y = vertices[:, 0], vertices[:, 1]
        a, b, c = faces.T
        faces = faces[(x[b] - x[a]) * (y[c] - y[a]) > (y[b] - y[a]) * (x[c] - x[a])]
    return _Item(vertices, faces, shape.normals @ turn.T, colour)


def _cloud(items: list[_Item]) -> Array:
    return np.concatenate([item.vertices for item in items])


def _covers(view: View, item: _Item, place: Array) -> bool:
    """Whether the item stands between the eye and the place, given in the axes of the eye."""
    projected = view.project(item.vertices)
    buffers = rasterise(view, projected[_within(view, projected, item.faces)])
    x, y, near = view.project(place[None])[0]
    column, row = int(x), int(y)
    if not (0 <= column < view.width and 0 <= row < view.height) or buffers.facet[row, column] < 0:
        return False
    return bool(buffers.near[row, column] > near + constants.OUTLINE_STEP / view.scale)


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


def _image(view: View, items: list[_Item]) -> Array:
    """(height, width, 4) of 0 … 1, colours not multiplied by their weight; in memory one colour after the other."""
    image = np.zeros((4, view.height * view.width))
    projected = [view.project(item.vertices) for item in items]
    kept = [_within(view, places, item.faces) for places, item in zip(projected, items, strict=True)]
    if any(map(len, kept)):
        starts = np.cumsum([0, *(len(item.vertices) for item in items)])
        faces = np.concatenate([own + start for own, start in zip(kept, starts, strict=False)])
        owner = np.repeat(np.arange(len(items)), [len(own) for own in kept])
        corners = np.concatenate(projected)[faces]
        buffers = rasterise(view, corners)
        normals = np.concatenate([item.normals for item in items]).T.copy()
        colours = np.array([item.colour for item in items])[owner].T.copy()
        direction = _shade(image, buffers, corners, faces, normals, colours)
        _outline(image, buffers, owner, direction, view)
    return np.moveaxis(image.reshape(4, view.height, view.width), 0, 2)


def _coarse(view: View, items: list[_Item]) -> Array:
    """As `_image`, without the finer pixels: enough for what is faint, in a fourth of the time."""
    step = constants.FINER
    small = replace(view, scale=view.scale / step, width=view.width // step, height=view.height // step)
    return _image(small, items).repeat(step, axis=0).repeat(step, axis=1)


def _shade(image: Array, buffers: Buffers, corners: Array, faces: Ints, normals: Array, colours: Array) -> Array:
    """Light on what is seen, in an image (4, pixels); returns where it faces (3, height, width).

    Numbers of one kind lie in long rows, as numpy is slow where the last axis is short.
    """
    height, width = buffers.facet.shape
    direction = np.zeros((3, height * width))
    for band in _bands(height, width):
        pixel = np.flatnonzero(buffers.facet[band] >= 0) + band.start * width
        row, column = np.divmod(pixel, width)
        facet = buffers.facet.ravel()[pixel]
        weights = _weights(corners, facet, column + 0.5, row + 0.5)
        vertices = faces[facet].T
        normal = np.array([sum(w * axis[k] for w, k in zip(weights, vertices, strict=True)) for axis in normals])
        normal /= np.maximum(np.sqrt(_dot(normal, normal)), 1e-300)
        normal *= np.where(normal[2] < 0.0, -1.0, 1.0)
        light = _light(normal)
        for k in range(3):
            direction[k][pixel] = normal[k]
            image[k][pixel] = np.clip(colours[k][facet] * light, 0.0, 1.0)
        image[3][pixel] = 1.0
    return direction.reshape(3, height, width)


def _dot(a: Array, b: Array) -> Array:
    """Sums of products over the first axis, of three."""
    return np.asarray(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


def _bands(height: int, width: int) -> Iterator[slice]:
    """Rows in portions that stay in the processor's cache: a picture at once takes more than twice the time."""
    step = max(1, constants.BAND // max(width, 1))
    for start in range(0, height, step):
        yield slice(start, min(start + step, height))


def _weights(corners: Array, facet: Ints, x: Array, y: Array) -> Array:
    """(3, n) barycentric weights of points in those of the facets, of corners (t, 3, 3)."""
    (ax, ay), (bx, by), (cx, cy) = (corners[facet, k, :2].T for k in range(3))
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    area = ux * vy - uy * vx
    area = np.where(np.abs(area) < 1e-12, np.inf, area)
    px, py = x - ax, y - ay
    s = (px * vy - py * vx) / area
    t = (ux * py - uy * px) / area
    return np.asarray(np.clip(np.array([1.0 - s - t, s, t]), 0.0, 1.0))


def _light(normal: Array) -> Array:
    """The same matt light as in the viewer, on places that face these ways (3, n)."""
    key = np.maximum(_dot(normal, np.array([-0.35, 0.75, 0.60]) / 1.0223), 0.0)
    fill = np.maximum(_dot(normal, np.array([0.70, 0.05, 0.45]) / 0.8337), 0.0)
    sky = 0.5 + 0.5 * normal[1]
    return np.asarray(0.34 + 0.20 * sky + 0.50 * key + 0.16 * fill)


def _outline(image: Array, buffers: Buffers, owner: NDArray[np.int64], direction: Array, view: View) -> None:
    """Darken where the part, the direction or the depth changes from one pixel to the next."""
    step = constants.OUTLINE_STEP / view.scale
    line = np.zeros(buffers.facet.shape, bool)
    for band in _bands(view.height, view.width):
        more = slice(band.start, band.stop + 1)  # and the row below
        facet, near, turn = buffers.facet[more], buffers.near[more], direction[:, more]
        seen = facet >= 0
        part = np.where(seen, owner[np.maximum(facet, 0)], -1)
        for axis in (0, 1):
            here = tuple(slice(None, -1) if k == axis else slice(None) for k in (0, 1))
            there = tuple(slice(1, None) if k == axis else slice(None) for k in (0, 1))
            turned = _dot(turn[:, *here], turn[:, *there]) < constants.OUTLINE_COSINE
            apart = np.abs(near[here] - near[there]) > step
            both = seen[here] & seen[there]
            changed = (part[here] != part[there]) | (both & (turned | apart))
            line[more][here] |= changed
            line[more][there] |= changed
    image[:3, (line & (buffers.facet >= 0)).ravel()] *= constants.OUTLINE_SHADE


def _over(front: Array, back: Array, weight: float, faint: float = 1.0) -> Array:
    """The front, of this weight, over the back, itself of weight `faint`."""
    out = np.empty_like(front)
    for band in _bands(*front.shape[:2]):
        a = front[band, :, 3] * weight
        b = back[band, :, 3] * faint
        # where the front lies behind something faint, that shows a little
        whole = out[band, :, 3] = a + b * (1.0 - a)
        for k in range(3):
            colour = front[band, :, k] * a + back[band, :, k] * b * (1.0 - a)
            out[band, :, k] = colour / np.maximum(whole, 1e-9)
    return out


def _reduced(image: Array) -> NDArray[np.uint8]:
    """Each block of finer pixels as one, colours by their weight."""
    height, width = (n // constants.FINER for n in image.shape[:2])
    out = np.empty((height, width, 4), np.uint8)
    for band in _bands(height, constants.FINER * constants.FINER * width):
        fine = image[constants.FINER * band.start : constants.FINER * band.stop]
        weight = _blocks(fine[..., 3])
        colours = [_blocks(fine[..., k] * fine[..., 3]) / np.maximum(weight, 1e-9) for k in range(3)]
        for k, mean in enumerate((*colours, weight)):
            out[band, :, k] = np.rint(255.0 * np.clip(mean, 0.0, 1.0))
    return out


def _blocks(fine: Array) -> Array:
    """Mean of each block of finer pixels."""
    steps = range(constants.FINER)
    return np.asarray(
        sum(fine[i :: constants.FINER, j :: constants.FINER] for i in steps for j in steps) / constants.FINER**2
    )
