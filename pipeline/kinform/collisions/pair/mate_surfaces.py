"""Mates of a pair: crossings that lie on a mating surface to within its errors are no collision."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Set
from functools import cached_property
from typing import Any

import numpy as np

from kinform.foundation.rounding import SINGLE
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.surfaces import MeshSurfaces, Surface

ALONG_AXIS = 0.9
"""Cosine between axes of cylinders and of a turn (26°), below which it is not computed how far points are off: a
choice; the distance to the axis then says little of that to the surface."""


SurfacePair = tuple[int, int]

_SHAPELESS = ("freeform", "other", "extrusion", "revolution", "torus", "helicoid")
"""Mates of these are left out as they are: their facets say no more than that they touch."""


class Mates:
    """The mates of two parts; `near`: for each surface those that share an edge with it. A point is on a mate that is
    on both of its surfaces: of two that keep a gap, neither stands for the other."""

    def __init__(
        self,
        first: str,
        patches: Sequence[Patch],
        surfaces: tuple[MeshSurfaces, MeshSurfaces],
        near: tuple[list[set[int]], list[set[int]]],
        size: float,
    ):
        self._surfaces, self._near = surfaces, near
        self._pairs = [_of(patch, first) for patch in patches]
        self.slacks = [
            patch.chord + 2.0 * abs(patch.gap) + sum(patch.uncertainty[1:]) + SINGLE * size for patch in patches
        ]
        """m, of each: how far its points may be off either surface."""
        self._bare: Set[SurfacePair] = {
            pair for pair, patch in zip(self._pairs, patches, strict=True) if patch.kind in _SHAPELESS
        }

    def __bool__(self) -> bool:
        return bool(self._pairs)

    def along(self, pairs: tuple[Ints, Ints], segments: tuple[Array, Array]) -> Flags:
        """(n,) which segments (n, 2, 3) m, in the frame of either part, each of facets of surfaces `pairs` (n,) of
        either part, lie on a mate that both surfaces belong to or border."""
        out = np.zeros(len(pairs[0]), dtype=bool)
        for mate, slack, border in zip(self._pairs, self.slacks, self._borders, strict=True):
            if mate in self._bare:
                out |= (pairs[0] == mate[0]) & (pairs[1] == mate[1])
            rows = np.flatnonzero(border[0][pairs[0]] & border[1][pairs[1]] & ~out)
            if len(rows):
                away = _greater(
                    _distance(surface, seen[rows].reshape(-1, 3))
                    for surface, seen in zip(self._of(mate), segments, strict=True)
                )
                out[rows] = (away.reshape(-1, 2) <= slack).all(axis=1) if away is not None else False
        return out

    def _of(self, mate: SurfacePair) -> tuple[Surface, Surface]:
        first, second = (own.surfaces[n] for own, n in zip(self._surfaces, mate, strict=True))
        return first, second

    @cached_property
    def _borders(self) -> list[tuple[Flags, Flags]]:
        """Of each mate, which surfaces of either part are its own or border it."""
        out = []
        for mate in self._pairs:
            flags = [np.zeros(len(near), dtype=bool) for near in self._near]
            for some, near, surface in zip(flags, self._near, mate, strict=True):
                some[list(near[surface])] = True
            out.append((flags[0], flags[1]))
        return out

    def surely_along(self, pairs: tuple[Ints, Ints], kept: tuple[Kept, Kept]) -> Flags:
        """(n,) which facets of surfaces `pairs` (n,) each lie along a mate wherever they cross as they turn or slide
        by what their points keep, as either part sees it."""
        out = np.zeros(len(pairs[0]), dtype=bool)
        for mate, slack, border in zip(self._pairs, self.slacks, self._borders, strict=True):
            if mate in self._bare:
                out |= (pairs[0] == mate[0]) & (pairs[1] == mate[1])
            rows = np.flatnonzero(border[0][pairs[0]] & border[1][pairs[1]] & ~out)
            if len(rows):
                away = _greater(k.furthest(surface, rows) for surface, k in zip(self._of(mate), kept, strict=True))
                out[rows] = away <= slack if away is not None else False
        return out


@dataclass(frozen=True, eq=False)
class Kept:
    """Boxes (n, 2), from `low` to `high`, of what points of a part keep: distance from an axis and height, or the
    shadow along it."""

    low: Array
    high: Array
    turning: bool
    X_KA: Array
    """(4, 4) pose of the part where z is the axis."""
    span: tuple[float, float]
    """m: of the part along the axis."""

    def furthest(self, surface: Surface, rows: Ints) -> Array | None:
        """(k,) m that no point of some of the boxes is further from a surface of the part; None where it is not
        told."""
        low, high = self.low[rows], self.high[rows]
        point, axis = self.X_KA[:3, :3] @ surface.point + self.X_KA[:3, 3], self.X_KA[:3, :3] @ surface.axis
        if surface.kind == "plane":
            if self.turning:
                middle, half = (f(low[:, 1], high[:, 1]) for f in (_middle, _half))
                away = np.abs((middle - point[2]) * axis[2] - point[:2] @ axis[:2]) + half * abs(axis[2])
                return np.asarray(away + np.hypot(*axis[:2]) * high[:, 0])
            middle, half = _middle(low, high), _half(low, high)
            along = _middle(*self.span), _half(*self.span)
            away = np.abs((middle - point[:2]) @ axis[:2] + (along[0] - point[2]) * axis[2])
            return np.asarray(away + half @ np.abs(axis[:2]) + along[1] * abs(axis[2]))
        if surface.kind != "cylinder" or not self.turning or abs(axis[2]) < ALONG_AXIS:
            return None
        # the distance of its own axis from that of the turn is greatest at one end of the heights
        shifts = [point[:2] + (side[:, 1, None] - point[2]) * axis[:2] / axis[2] for side in (low, high)]
        shift = np.maximum(*(np.hypot(*shift.T) for shift in shifts))
        outer, inner = high[:, 0] + shift, (low[:, 0] - shift) * abs(axis[2])
        return np.asarray(np.maximum(outer - surface.radius, surface.radius - inner))


def _greater(both: Iterable[Array | None]) -> Array | None:
    """(n,) the greater of what is told of two; None where nothing is told of either."""
    told = [values for values in both if values is not None]
    return np.asarray(np.max(told, axis=0)) if told else None


def _middle(low: Any, high: Any) -> Any:
    return 0.5 * (low + high)


def _half(low: Any, high: Any) -> Any:
    return 0.5 * np.abs(high - low)


def _of(patch: Patch, first: str) -> SurfacePair:
    """Its surfaces, that of the first part first."""
    a, b = patch.surfaces
    return (a, b) if patch.parts[0] == first else (b, a)


def _distance(surface: Surface, points: Array) -> Array | None:
    """(n,) m distance of points (n, 3) from a plane, cylinder, cone or sphere; None for other kinds."""
    away = points - surface.point
    if surface.kind == "plane":
        return np.asarray(np.abs(away @ surface.axis))
    if surface.kind == "sphere":
        return np.asarray(np.abs(np.linalg.norm(away, axis=1) - surface.radius))
    if surface.kind not in ("cylinder", "cone"):
        return None
    height = away @ surface.axis
    across = np.linalg.norm(away - height[:, None] * surface.axis, axis=1)
    if surface.kind == "cylinder":
        return np.asarray(np.abs(across - surface.radius))
    return np.asarray(np.abs(across * np.cos(surface.half_angle) - height * np.sin(surface.half_angle)))
