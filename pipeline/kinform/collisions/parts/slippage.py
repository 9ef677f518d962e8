"""Surfaces that a relative motion maps onto themselves.

A point keeps its distance from such a surface, so nothing ever comes to cross it but through its border, and there the
surfaces that share the border are met as well. Where these cross nothing either, as flush and parallel faces do, points
of them come to be inside (`deep_entry`): a collision is not missed when it is left out. Journals in bores, thrust
faces, guides and flanks of threads are all of this kind, which is why mating surfaces, whose facets overlap by their
chord errors, need not be told from collisions by any depth. The motions that a kind of surface admits are those of
slippage analysis (Gelfand and Guibas 2004).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.vectors import cross, perpendiculars
from kinform.foundation.rounding import SINGLE, SOLVED, TINY
from kinform.foundation.sorting import ascending, heads
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces, Surface


@dataclass(frozen=True)
class Allowed:
    """What a surface may be off and still count: `length` (m) for turns, `angle` (rad)."""

    length: float
    angle: float


@dataclass(frozen=True, eq=False)
class _Extent:
    """Middle (s, 3) and radius (s,) m of the facets of each surface of a mesh, part frame."""

    middle: Array
    radius: Array


def _extents(mesh: Mesh, surfaces: MeshSurfaces) -> _Extent:
    """Where the facets of each surface are."""
    count = len(surfaces.surfaces)
    order = ascending(surfaces.labels, count)
    ordered = surfaces.labels[order]
    starts = heads(ordered).nonzero()[0]
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    corners = mesh.faces[order].ravel()
    for k, column in enumerate(np.ascontiguousarray(mesh.vertices.T)):
        places = column[corners]
        low[ordered[starts], k] = np.minimum.reduceat(places, 3 * starts)
        high[ordered[starts], k] = np.maximum.reduceat(places, 3 * starts)
    return _Extent(0.5 * (low + high), 0.5 * np.linalg.norm(high - low, axis=1))


@dataclass(frozen=True, eq=False)
class Slippage:
    """What the motions that map each surface of a mesh onto itself leave over of some twists."""

    speed: Array
    """(s, k) m per unit of a twist that points of a surface leave it by; inf where no motion maps it onto itself."""
    radius: Array
    """(s,) m."""
    turns: Flags
    """(k,) whether a twist turns."""
    drift: Array
    """(s, k) share of what a twist that turns advances along its axis by which points of a surface leave it along
    that."""

    def within(self, allowed: Allowed) -> Flags:
        """(s,) which surfaces all twists map onto themselves, but for what is allowed."""
        limit = np.where(self.turns, allowed.length + allowed.angle * self.radius[:, None], allowed.angle)
        # what a screw advances adds up from turn to turn, however little it is
        # Share of the advance of a screw by which its threads' pitch may be off: a choice; fitted pitches are better.
        return np.asarray(((self.speed <= limit) & (self.drift <= 0.02)).all(axis=1))


class OwnMotions:
    """The motions that map each surface of a mesh onto itself; part frame."""

    def __init__(self, mesh: Mesh, surfaces: MeshSurfaces):
        self._extent = _extents(mesh, surfaces)
        self._bases = [
            (members, np.linalg.qr(np.swapaxes(self._at(twists, members), 1, 2))[0])
            for members, twists in _own_motions(surfaces.surfaces)
            if len(members)
        ]

    def slippage(self, twists: Array) -> Slippage:
        """Of unit twists (k, 6) (ω; v at the part's origin)."""
        speed = np.full((len(self._extent.radius), len(twists)), np.inf)
        drift = np.zeros_like(speed)
        axes = twists[:, :3]
        advance = np.abs(np.einsum("ki,ki->k", axes, twists[:, 3:]))
        for members, basis in self._bases:
            wanted = self._at(np.broadcast_to(twists, (len(members), *twists.shape)), members)
            rest = wanted - (wanted @ basis) @ np.swapaxes(basis, 1, 2)
            speed[members] = np.linalg.norm(rest[..., :3], axis=2) + np.linalg.norm(rest[..., 3:], axis=2)
            along = np.abs(np.einsum("ski,ki->sk", rest[..., 3:], axes))
            screws = advance > SINGLE * self._extent.radius[members, None]
            drift[members] = np.where(screws, along / np.maximum(advance, TINY), 0.0)
        return Slippage(speed, self._extent.radius, np.linalg.norm(axes, axis=1) > 0.0, drift)

    def _at(self, twists: Array, members: NDArray[np.int64]) -> Array:
        """Twists (n, k, 6) as velocities (m/s) of surfaces: of the rim by the turn, and of the middle."""
        omega = twists[..., :3]
        size = np.maximum(self._extent.radius[members], SOLVED)[:, None, None]
        return np.concatenate(
            [size * omega, twists[..., 3:] + cross(omega, self._extent.middle[members, None])], axis=2
        )


def _own_motions(surfaces: Sequence[Surface]) -> list[tuple[NDArray[np.int64], Array]]:
    """Surfaces (n,), and of each (n, m, 6) twists that map it onto itself, by their number m; of a plane of facets
    without area none are known."""
    if not surfaces:
        return []
    axes, points = (np.array([getattr(surface, name) for surface in surfaces]) for name in ("axis", "point"))
    turns, slides = np.hstack([axes, cross(points, axes)]), np.hstack([np.zeros_like(axes), axes])
    kinds = np.array([surface.kind for surface in surfaces])
    planes = np.flatnonzero((kinds == "plane") & axes.any(axis=1))
    flat = np.zeros((len(planes), 3, 6))
    flat[:, 0], flat[:, 1:, 3:] = turns[planes], np.stack(perpendiculars(axes[planes]), axis=1)
    spheres = np.flatnonzero(kinds == "sphere")
    about = np.broadcast_to(np.eye(3), (len(spheres), 3, 3))
    round_ = np.concatenate([about, cross(np.broadcast_to(points[spheres, None], about.shape), about)], axis=2)
    cylinders = np.flatnonzero(kinds == "cylinder")
    single = np.flatnonzero(np.isin(kinds, ("cone", "torus", "revolution", "extrusion", "helicoid")))
    pitch = np.array([surfaces[n].pitch if kinds[n] == "helicoid" else 0.0 for n in single.tolist()])
    one = np.where((kinds[single] == "extrusion")[:, None], slides[single], turns[single])
    one = one + (pitch / (2.0 * np.pi))[:, None] * slides[single]
    return [
        (np.append(planes, spheres), np.concatenate([flat, round_])),
        (cylinders, np.stack([turns[cylinders], slides[cylinders]], axis=1)),
        (single, one[:, None]),
    ]
