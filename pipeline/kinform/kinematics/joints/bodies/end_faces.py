"""Surfaces of parts that look along the axis of a joint or against it, and which of them meet whenever they come to one
height.

Seen along the axis, an edge of facets lies at the same distances from it however the bodies turn. Two surfaces meet in
every position of the rotation if there is a circle about the axis on which the openings of the one are narrower than
the widest piece of the other: a collar and the wall round its bore do, the lugs of a bayonet do not.

Planes across the axis count, and what leans towards it of cones, tori and surfaces of revolution whose axes are
parallel to it, as of a ring of round wire: these have no one height, but begin at one and end at another.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.vectors import cross, normalised, perpendicular
from kinform.foundation.rounding import SINGLE, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Mesh, Part
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces, Surface

ACROSS = 0.01
"""Sine up to which the normal of a plane is along the axis, as of the faces that end a motion elsewhere. Chosen, not
measured."""
ROUND = ("cone", "torus", "revolution")
"""Kinds of surfaces that have an axis, of which facets may look along it. Threads do not end a translation: they turn
it into a screw."""
LEANS = 0.5
"""Cosine of a normal to the axis from which on a facet stands across the way: less steep ones wedge. Chosen, not
measured."""
CIRCLES = 12
"""Circles on which two faces are compared, from the inner edge of what they have in common to the outer one, each
larger than the one before by the same factor. Chosen, not measured."""
MOST_SAGITTA = 0.04
"""Distance of an edge from its circle, as a share of the radius, up to which it stands for a piece of that circle: a
cylinder of 12 facets, the coarsest that is one, has 0.034 (`Tolerances.smooth_edge`)."""


@dataclass(frozen=True, eq=False)
class Line:
    """The axis of a joint."""

    axis: Array
    point: Array

    @cached_property
    def across(self) -> tuple[Array, Array]:
        """Two unit vectors that make a right-handed frame with it."""
        return perpendicular(self.axis)


class EndSurfaces:
    """The planes of one mesh, and what leans towards its axis of each cone, torus and surface of revolution; their
    outlines once asked for."""

    def __init__(self, mesh: Mesh, known: MeshSurfaces):
        self._mesh, self.noise, self.size = mesh, known.noise, mesh.diagonal
        self._facets: list[Ints] = []
        self._outlines: dict[int, Array] = {}
        normals, levels = [], []
        for surface in known.surfaces:
            if surface.kind == "plane":
                level = float(surface.axis @ surface.point)
                found = [(surface.axis, surface.faces, (level, level))]
            elif surface.kind in ROUND:
                found = self._leaning(surface)
            else:
                continue
            self._facets += [facets for _, facets, _ in found]
            normals += [normal for normal, _, _ in found]
            levels += [level for _, _, level in found]
        self.normals = np.array(normals).reshape(-1, 3)
        self.levels = np.array(levels).reshape(-1, 2)
        """(n, 2) m along the normals: where each begins and ends."""

    def _leaning(self, surface: Surface) -> list[tuple[Array, Ints, tuple[float, float]]]:
        corners = self._mesh.vertices[self._mesh.faces[surface.faces]]
        spans = normalised(cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
        out = []
        for normal in (surface.axis, -surface.axis):
            some = spans @ normal > LEANS
            if some.any():
                heights = corners[some] @ normal
                out.append((normal, surface.faces[some], (float(heights.min()), float(heights.max()))))
        return out

    def across(self, part: Part, line: Line) -> list[Piece]:
        """Those across a line, of a part with this mesh."""
        R_PW = part.X_WP[:3, :3].T
        axis, origin = R_PW @ line.axis, R_PW @ (line.point - part.X_WP[:3, 3])
        cosines = self.normals @ axis
        across = np.flatnonzero(cosines * cosines > 1.0 - ACROSS**2)
        if not len(across):
            return []
        frame = origin, R_PW @ line.across[0], R_PW @ line.across[1]
        levels = (self.levels[across] - (self.normals[across] @ origin)[:, None]) / np.abs(cosines[across])[:, None]
        return [
            Piece(part.name, 1 if cosines[k] > 0.0 else -1, (low, high), self, k, frame)
            for k, (low, high) in zip(across.tolist(), levels.tolist(), strict=True)
        ]

    def outline(self, k: int) -> Array:
        """(n, 2, 3) m: the edges round a surface, which is on their left seen from outside."""
        if k not in self._outlines:
            vertices, own = self._mesh.vertices, self._mesh.faces[self._facets[k]]
            start, end = own.ravel(), np.roll(own, -1, axis=1).ravel()
            single = ~np.isin(start * len(vertices) + end, end * len(vertices) + start)
            self._outlines[k] = vertices[np.stack([start[single], end[single]], axis=1)]
        return self._outlines[k]


@dataclass(frozen=True, eq=False)
class Piece:
    """A surface of one part that looks along a line or against it."""

    part: PartName
    sense: int
    """1: along; −1: against."""
    levels: tuple[float, float]
    """m, in the sense in which it looks: where it begins and ends."""
    ends: EndSurfaces
    number: int
    frame: tuple[Array, Array, Array]
    """A point of the axis, and two unit vectors that make a right-handed frame with it, in the part frame."""

    @property
    def likeness(self) -> tuple[object, ...]:
        """Equal for surfaces that have one outline, but for rounding and for how they are turned about the axis."""
        origin, u, v = self.frame
        axis = cross(u, v)
        foot = (origin - (origin @ axis) * axis) / self.ends.size
        return self.ends, self.number, self.sense, *(np.round([*axis, *foot], 9) + 0.0).tolist()

    @property
    def edges(self) -> Array:
        """(n, 2, 2) m across the axis, which is the origin: the surface is on their left, seen against the axis."""
        origin, u, v = self.frame
        edges = self.ends.outline(self.number) - origin
        flat = np.stack([edges @ u, edges @ v], axis=-1)
        return flat if self.sense > 0 else flat[:, ::-1]


@dataclass(frozen=True, eq=False)
class Face:
    """Surfaces at one height that look in one sense."""

    pieces: tuple[Piece, ...]

    @cached_property
    def levels(self) -> tuple[float, float]:
        """m, in the sense in which they look: where they begin and end."""
        begins, ends = zip(*(piece.levels for piece in self.pieces), strict=True)
        return min(begins), max(ends)

    @property
    def parts(self) -> tuple[PartName, ...]:
        """Sorted."""
        return tuple(sorted({piece.part for piece in self.pieces}))

    @cached_property
    def outline(self) -> Outline:
        """What is seen of it along the axis."""
        noise = max(piece.ends.noise for piece in self.pieces)
        return Outline(np.concatenate([piece.edges for piece in self.pieces]), noise)


@dataclass(frozen=True, eq=False)
class Outline:
    """A face as seen along an axis, which is the origin."""

    edges: Array
    """(n, 2, 2) m: the edges round it; it is on their left."""
    noise: float
    """m: scatter of its vertices."""

    @cached_property
    def span(self) -> tuple[float, float]:
        """m: its least and greatest distance from the axis."""
        start, along = self.edges[:, 0], self.edges[:, 1] - self.edges[:, 0]
        share = np.clip(-_dot(start, along) / np.maximum(_dot(along, along), TINY), 0.0, 1.0)
        nearest = start + share[:, None] * along
        near = 0.0 if self.winding(np.zeros(2)) else math.sqrt(float(_dot(nearest, nearest).min()))
        return near, math.sqrt(float(_dot(start, start).max()))

    @cached_property
    def sagitta(self) -> float:
        """m: greatest distance of its edges from circles about the axis that they stand for."""
        start, end = self.edges[:, 0], self.edges[:, 1]
        from_axis = np.sqrt(_dot(start, start))
        middle = 0.5 * (start + end)
        inside = from_axis - np.sqrt(_dot(middle, middle))
        round_ = np.abs(np.sqrt(_dot(end, end)) - from_axis) <= SINGLE * from_axis + self.noise
        round_ &= inside <= MOST_SAGITTA * from_axis
        return float(inside[round_].max(initial=0.0))

    def winding(self, place: Array) -> int:
        """How often its edges go round a place (2,): 0 beside it, 1 on it."""
        (x, y), (u, v) = (self.edges[:, 0] - place).T, (self.edges[:, 1] - place).T
        left = x * v - u * y
        return int(np.count_nonzero((y <= 0.0) & (v > 0.0) & (left > 0.0))) - int(
            np.count_nonzero((y > 0.0) & (v <= 0.0) & (left < 0.0))
        )

    def on_circle(self, radius: float) -> tuple[float, float]:
        """rad: the widest opening and the widest piece of it on a circle about the axis."""
        start, along = self.edges[:, 0], self.edges[:, 1] - self.edges[:, 0]
        square, half = np.maximum(_dot(along, along), TINY), _dot(start, along)
        root = half * half - square * (_dot(start, start) - radius * radius)
        angles, sides = [], []
        for side in (1, -1):
            # an edge that goes outwards through the circle has the face before it, counterclockwise
            share = (side * np.sqrt(np.maximum(root, 0.0)) - half) / square
            place = (start + share[:, None] * along)[(root > 0.0) & (share >= 0.0) & (share < 1.0)]
            angles.append(np.arctan2(place[:, 1], place[:, 0]))
            sides.append(np.full(len(place), side))
        angle, step = np.concatenate(angles), np.concatenate(sides)
        if not len(angle):
            return (0.0, math.tau) if self.winding(np.array([radius, 0.0])) > 0 else (math.tau, 0.0)
        order = np.argsort(angle, kind="stable")
        angle, step = angle[order], step[order]
        wide = np.append(angle[1:], angle[0] + math.tau) - angle
        most = int(wide.argmax())
        middle = angle[most] + 0.5 * wide[most]
        count = np.cumsum(step)
        count += self.winding(radius * np.array([math.cos(middle), math.sin(middle)])) - count[most]
        return _widest(count > 0, wide)


def _dot(a: Array, b: Array) -> Array:
    """(n,) inner products of vectors (n, 2)."""
    return np.asarray(a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1])


def _widest(on: Flags, wide: Array) -> tuple[float, float]:
    """The widest opening and the widest piece of a circle, by pieces (n,) that follow each other round it."""
    if on.all() or not on.any():
        return (0.0, math.tau) if on.all() else (math.tau, 0.0)
    first = int(np.flatnonzero(on != np.roll(on, 1))[0])
    on, wide = np.roll(on, -first), np.roll(wide, -first)
    heads = np.flatnonzero(np.append(True, on[1:] != on[:-1]))
    runs, kind = np.add.reduceat(wide, heads), on[heads]
    return float(runs[~kind].max()), float(runs[kind].max())


def joined(pieces: Sequence[Piece], level: float) -> list[Face]:
    """Surfaces that look in one sense, those that begin within `level` (m) of each other as one face."""
    out: list[list[Piece]] = []
    for piece in sorted(pieces, key=lambda piece: (piece.levels, piece.part)):
        if not out or piece.levels[0] - out[-1][0].levels[0] > level:
            out.append([])
        out[-1].append(piece)
    return [Face(tuple(some)) for some in out]


def always_meet(face: Outline, other: Outline, slack: float) -> bool:
    """Whether two faces that look at each other meet however they are turned about the axis, by more than facets and
    `slack` (m) may pretend."""
    if not len(face.edges) or not len(other.edges):
        return False
    near, far = max(face.span[0], other.span[0]), min(face.span[1], other.span[1])
    near += slack + face.sagitta + other.sagitta + face.noise + other.noise + SINGLE * far
    if near >= far:
        return False
    for k in range(CIRCLES):
        radius = near * (far / near) ** (k / CIRCLES)
        openings, pieces = zip(face.on_circle(radius), other.on_circle(radius), strict=True)
        if openings[0] < pieces[1] - SINGLE or openings[1] < pieces[0] - SINGLE:
            return True
    return False
