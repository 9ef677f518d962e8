"""Mates of a pair: crossings that lie on a mating surface to within its errors are no collision."""

from __future__ import annotations

from collections.abc import Sequence, Set

import numpy as np

from kinform.collisions.constants import MATE_ROUNDING
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch
from kinform.model.surfaces import MeshSurfaces, Surface

SurfacePair = tuple[int, int]

_SHAPELESS = ("freeform", "other", "extrusion", "revolution", "torus", "helicoid")
"""Mates of these are left out as they are: their facets say no more than that they touch."""


class Mates:
    """The mates of two parts, all in the frame of the first; `near`: for each surface those that share an edge with
    it."""

    def __init__(
        self,
        first: str,
        patches: Sequence[Patch],
        surfaces: MeshSurfaces,
        near: tuple[list[set[int]], list[set[int]]],
        size: float,
    ):
        self._surfaces, self._near = surfaces, near
        self._pairs = [_of(patch, first) for patch in patches]
        self.slacks = [
            patch.chord + 2.0 * abs(patch.gap) + sum(patch.uncertainty[1:]) + MATE_ROUNDING * size for patch in patches
        ]
        """m, of each: how far its points may be off the surface."""
        self._bare: Set[SurfacePair] = {
            pair for pair, patch in zip(self._pairs, patches, strict=True) if patch.kind in _SHAPELESS
        }

    def along(self, pair: SurfacePair, segments: Array) -> Flags:
        """(n,) which segments (n, 2, 3) m lie on a mate that both surfaces belong to or border."""
        out = np.zeros(len(segments), dtype=bool)
        for mate, slack in zip(self._pairs, self.slacks, strict=True):
            if pair[0] not in self._near[0][mate[0]] or pair[1] not in self._near[1][mate[1]]:
                continue
            if mate in self._bare and pair == mate:
                return np.ones(len(segments), dtype=bool)
            away = _distance(self._surfaces.surfaces[mate[0]], segments.reshape(-1, 3))
            if away is not None:
                out |= (away.reshape(-1, 2) <= slack).all(axis=1)
        return out


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
