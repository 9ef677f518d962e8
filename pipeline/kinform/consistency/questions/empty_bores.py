"""Bores of several bodies that line up and hold nothing: a pin or screws that are in no mesh.

Bores on one line, of about one size, near each other along it, make a row. A row counts where a pin through all of it
meets no part, so that it is neither filled nor closed. A row holds what nothing else holds where the bodies may move
relative to each other otherwise than about and along its line.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np
from scipy.spatial import KDTree

from kinform.contacts.constants import ROUND_SWEEP
from kinform.contacts.fastening.bores import Cylinders, all_cylinders
from kinform.design import Design
from kinform.foundation.algebra.vectors import perpendicular
from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.rounding import SINGLE
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.kinematics.mobility.named_freedoms import Motions
from kinform.model.arrays import Array, Ints
from kinform.model.assembly import Part
from kinform.model.kinematics import Kinematics
from kinform.model.surfaces import MeshSurfaces

ONE_SIZE = 1.4
"""Ratio of radii up to which bores take one pin or screw: M3 is cut into 2.5 mm and passes through 3.4."""
ONE_LINE = 0.1
"""Share of the radius by which axes of a row may miss each other: a pin with the usual play still goes through."""
PIN = 0.8
"""Share of the radius that has to be free: facets of a round of 8 sides take a tenth, axes that miss another."""
NEAR = 4.0
"""Radii between bores of one row, at most: more, and two rows are as likely. Chosen, not measured."""
PARALLEL = math.cos(math.radians(0.5))
"""As of holes that hint at fasteners."""


@dataclass(frozen=True, eq=False)
class Row:
    """Bores in a row with nothing in them. World frame."""

    parts: tuple[str, ...]
    """Of each bore, from the first to the last along the axis."""
    owners: tuple[str, ...]
    """The bodies of these parts."""
    axis: Array
    start: Array
    """(3,) m: where the first bore begins, on the axis."""
    length: float
    radius: float
    """m, of the narrowest bore."""

    @property
    def bodies(self) -> tuple[str, ...]:
        """Distinct, sorted."""
        return tuple(sorted(set(self.owners)))

    @property
    def alternates(self) -> bool:
        """Whether it goes from body to body and on or back, as knuckles of a hinge do, or a fork and its tongue."""
        return sum(one != other for one, other in pairwise(self.owners)) > 1

    def on(self, axis: Array | None, point: Array | None) -> bool:
        """Whether it lies on this line, as far as that is stated."""
        if axis is not None and abs(float(self.axis @ axis)) < PARALLEL:
            return False
        arm = np.zeros(3) if point is None else point - self.start
        return bool(np.linalg.norm(arm - float(arm @ self.axis) * self.axis) <= self.radius)


def empty_rows(design: Design) -> tuple[Row, ...]:
    """All of them, sorted by their parts and places."""
    kinematics = design.kinematics
    assert kinematics is not None
    parts = [p for p in design.assembly.parts if p.mesh is not None and len(p.mesh.faces)]
    of_part = [_bores(part, design.surfaces) for part in parts]
    bores, owner = all_cylinders(of_part), np.repeat(np.arange(len(parts)), [len(c.radii) for c in of_part])
    body = {name: str(b.name) for b in kinematics.bodies for name in b.parts}
    found = []
    for row in _rows(bores):
        for some in _near(bores, row):
            owners = tuple(body[parts[k].name] for k in owner[some])
            if len(set(owners)) < 2:
                continue
            axis = bores.axes[some[0]]
            ends = (bores.points[some] - bores.points[some[0]]) @ axis
            low, high = float((ends - bores.halves[some]).min()), float((ends + bores.halves[some]).max())
            radius, start = float(bores.radii[some].min()), bores.points[some[0]] + low * axis
            if not any(_meets(part, axis, start, high - low, PIN * radius) for part in parts):
                names = tuple(str(parts[k].name) for k in owner[some])
                found.append(Row(names, owners, axis, start, high - low, radius))
    return tuple(sorted(found, key=lambda row: (row.bodies, row.parts, tuple(np.round(row.start, 9)))))


def _bores(part: Part, surfaces: Mapping[str, MeshSurfaces]) -> Cylinders:
    """The bores of a part that go all round: one surface may be several of them, as in the knuckles of a leaf."""
    assert part.mesh is not None
    known, corners = surfaces.get(part.mesh.digest), part.mesh.vertices[part.mesh.faces]
    found: list[tuple[Array, Array, float, float]] = []
    for surface in known.surfaces if known is not None else ():
        if surface.kind != "cylinder" or surface.side > 0 or surface.sweep < ROUND_SWEEP:
            continue
        some = corners[surface.faces]
        along = (some - surface.point) @ surface.axis
        areas = 0.5 * np.linalg.norm(np.cross(some[:, 1] - some[:, 0], some[:, 2] - some[:, 0]), axis=1)
        order = np.argsort(along.min(axis=1), kind="stable")
        low, reached = along.min(axis=1)[order], np.maximum.accumulate(along.max(axis=1)[order])
        for piece in np.split(order, np.flatnonzero(low[1:] > reached[:-1] + SINGLE * surface.radius) + 1):
            start, end = float(along[piece].min()), float(along[piece].max())
            if areas[piece].sum() >= ROUND_SWEEP * surface.radius * (end - start) * PIN:
                middle = surface.point + 0.5 * (start + end) * surface.axis
                found.append((surface.axis, middle, surface.radius, 0.5 * (end - start)))
    R_WP, p_WP = part.X_WP[:3, :3], part.X_WP[:3, 3]
    return Cylinders(
        axes=np.array([axis for axis, *_ in found]).reshape(-1, 3) @ R_WP.T,
        points=np.array([point for _, point, *_ in found]).reshape(-1, 3) @ R_WP.T + p_WP,
        radii=np.array([radius for *_, radius, _ in found]),
        halves=np.array([half for *_, half in found]),
        sides=np.full(len(found), -1, dtype=np.int64),
    )


def _rows(bores: Cylinders) -> Iterator[Ints]:
    """Indices of bores on one line and of one size."""
    if len(bores.radii) < 2:
        return
    middle = bores.points.mean(axis=0)
    arms = bores.points - middle
    feet = arms - np.einsum("ij,ij->i", arms, bores.axes)[:, None] * bores.axes
    sets = UnionFind(len(bores.radii))
    near = KDTree(feet).query_ball_point(feet, ONE_LINE * bores.radii)
    one, other = np.repeat(np.arange(len(near)), [len(some) for some in near]), np.concatenate(near).astype(np.int64)
    gap, axes = bores.points[other] - bores.points[one], bores.axes[one]
    aside = np.linalg.norm(gap - np.einsum("ij,ij->i", gap, axes)[:, None] * axes, axis=1)
    small, large = np.sort([bores.radii[one], bores.radii[other]], axis=0)
    alike = (aside <= ONE_LINE * small) & (large <= ONE_SIZE * small)
    alike &= np.abs(np.einsum("ij,ij->i", axes, bores.axes[other])) >= PARALLEL
    for i, j in zip(one[alike].tolist(), other[alike].tolist(), strict=True):
        sets.union(i, j)
    members: dict[int, list[int]] = {}
    for k in range(len(bores.radii)):
        members.setdefault(sets.find(k), []).append(k)
    yield from (np.array(row) for row in members.values() if len(row) > 1)


def _near(bores: Cylinders, row: Ints) -> Iterator[Ints]:
    """The bores of a line in their order along it, split where they are far from each other."""
    axis = bores.axes[row[0]]
    at = (bores.points[row] - bores.points[row[0]]) @ axis
    row, at = row[np.argsort(at, kind="stable")], np.sort(at, kind="stable")
    free = (at[1:] - bores.halves[row[1:]]) - (at[:-1] + bores.halves[row[:-1]])
    yield from np.split(row, np.flatnonzero(free > NEAR * bores.radii[row].min()) + 1)


def _meets(part: Part, axis: Array, start: Array, length: float, radius: float) -> bool:
    """Whether a part comes into a round of this radius along the axis: by an edge, by a facet that a line of the round
    passes through, or as it fills all of it."""
    assert part.mesh is not None
    low, high = part.mesh.placed_box(part.X_WP)
    ends = np.array([start, start + length * axis])
    if (low > ends.max(axis=0) + radius).any() or (high < ends.min(axis=0) - radius).any():
        return False
    frame = np.stack([*perpendicular(axis), axis])
    points = (part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3] - start) @ frame.T
    corners = points[part.mesh.faces]
    flat = corners[..., :2]
    corners = corners[(flat.min(axis=1) < radius).all(axis=1) & (flat.max(axis=1) > -radius).all(axis=1)]
    if _edges_meet(corners, length, radius):
        return True
    angles = 0.25 * math.pi * np.arange(8) + 0.3
    lines = np.concatenate([np.zeros((1, 2)), 0.9 * radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)])
    return any(_passes(corners, line, length) for line in lines) or _within(corners, lines[1], length)


def _edges_meet(corners: Array, length: float, radius: float) -> bool:
    """Whether an edge of facets (m, 3, 3) comes into the round of this radius about z, from 0 to the length."""
    start, step = corners.reshape(-1, 3), (np.roll(corners, -1, axis=1) - corners).reshape(-1, 3)
    low, high = SINGLE * length, (1.0 - SINGLE) * length
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.sort((np.array([[low], [high]]) - start[:, 2]) / step[:, 2], axis=0)
        nearest = -(start[:, :2] * step[:, :2]).sum(axis=1) / (step[:, :2] ** 2).sum(axis=1)
    level = step[:, 2] == 0.0
    within = (start[:, 2] > low) & (start[:, 2] < high)
    first = np.where(level, np.where(within, 0.0, 2.0), np.maximum(ends[0], 0.0))
    last = np.where(level, np.where(within, 1.0, -1.0), np.minimum(ends[1], 1.0))
    at = np.clip(np.nan_to_num(nearest), first, np.maximum(first, last))
    away = np.linalg.norm(start[:, :2] + at[:, None] * step[:, :2], axis=1)
    return bool(((first <= last) & (away < radius)).any())


def _hits(corners: Array, line: Array) -> tuple[Array, Array]:
    """Heights (n,) at which a line along z at this place (2,) passes through facets (m, 3, 3), and their senses."""
    a, b, c = (corners[:, k, :2] - line for k in range(3))
    # barycentric weights of the place, times twice the facet's area seen along z
    weights = np.stack([_area(b, c), _area(c, a), _area(a, b)], axis=1)
    total = weights.sum(axis=1)
    hit = (np.abs(total) > 0.0) & ((weights >= 0.0).all(axis=1) | (weights <= 0.0).all(axis=1))
    return (weights[hit] * corners[hit][..., 2]).sum(axis=1) / total[hit], np.sign(total[hit])


def _passes(corners: Array, line: Array, length: float) -> bool:
    """Whether the line meets a facet between 0 and the length."""
    heights, _ = _hits(corners, line)
    return bool(((heights > SINGLE * length) & (heights < (1.0 - SINGLE) * length)).any())


def _within(corners: Array, line: Array, length: float) -> bool:
    """Whether the middle of the line is inside: a pin that fills all of the row, and is wider, passes its rim."""
    heights, senses = _hits(corners, line)
    return bool(abs(float(senses[heights < 0.5 * length].sum())) > 0.5)


def _area(one: Array, other: Array) -> Array:
    return one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]


def holds_something(row: Row, kinematics: Kinematics) -> bool:
    """Whether two of its bodies may move relative to each other otherwise than a pin in it lets them."""
    motions = Motions.of(kinematics)
    allowed = twists_of("cylindrical", row.axis, row.start)
    reach = max(row.length, row.radius)
    return any(_beyond(motions.relative(a, b), allowed, row.start, reach) for a, b in _pairs(row.bodies))


def _pairs(names: Sequence[str]) -> Iterator[tuple[str, str]]:
    return ((a, b) for k, a in enumerate(names) for b in names[k + 1 :])


def _beyond(relative: Array, allowed: Array, origin: Array, reach: float) -> bool:
    """Whether twists (k, 6) are not all within the span of others (f, 6), as displacements at the row."""
    moved, basis = (
        _at(twists, origin) / np.array([1.0, 1.0, 1.0, reach, reach, reach]) for twists in (relative, allowed)
    )
    inside, _ = np.linalg.qr(basis.T)
    left = moved - (moved @ inside) @ inside.T
    sizes = np.linalg.norm(moved, axis=1)
    return bool((np.linalg.norm(left, axis=1) > 1e-3 * np.where(sizes > 0.0, sizes, 1.0)).any())


def _at(twists: Array, origin: Array) -> Array:
    """Twists (k, 6) with the velocity at a point."""
    turned = twists[:, :3]
    return np.concatenate([turned, twists[:, 3:] + np.cross(turned, origin)], axis=1)
