"""Surfaces of parts that would mate if the parts were moved, and the motions that make most of them do so.

A cylinder and a bore of its radius, a ball and its socket, two bores of one radius end to end, two planes that face
each other: each says by how much one side would have to move. What is missing to the pose that the designer meant is a
vector that many of them agree on.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.model.assembly import Part
from kinform.model.surfaces import MeshSurfaces, Surface

PARALLEL = 2e-3
"""Sine up to which axes and normals are parallel: 0.1°, what recovery from coarse meshes leaves."""
ROOM = 0.1
"""Share of its radius by which a bore may be larger than its shaft: a running fit of a printed part."""
PRESSED = 0.03
"""Share of its radius by which a shaft may be larger than its bore: what can be pressed."""
ROUND = 0.75 * np.pi
"""Angle (rad) from which a cylinder tells where its axis is: less is a fillet."""
SAME = 2e-3
"""Share of the size of a surface by which two vectors for it may differ. Chosen, not measured."""
VECTORS = 8
"""Vectors that are proposed, at most: each costs the contacts of the parts that it moves."""
CLUSTERS = 24
"""Offsets of each kind that are combined, the ones that most surfaces agree on."""


@dataclass(frozen=True, eq=False)
class Mates:
    """Pairs of surfaces that would mate after a translation t (m, world): P (t − d) = 0, and in reach along them."""

    projections: Array
    """(n, 3, 3) P: on what the pair determines."""
    offsets: Array
    """(n, 3) m: d, the least t that makes the pair mate."""
    between: Array
    """(n, 3) m: from the middle of the moved surface to that of the other."""
    reach: Array
    """(n,) m: as far may the middles be from each other along the surface."""
    within: Array
    """(n,) m: by so much may t be off."""
    firm: Flags
    """(n,) A shaft in its bore, a ball in its socket: the radius says that they belong together. Else planes that face
    each other, and bores in line."""
    marks: Array
    """(n, 4) the same for one moved plane, or one moved axis, whatever it mates with."""

    def met(self, shift: Array) -> Flags:
        """(n,) Which of them mate after this shift."""
        off = np.einsum("nij,nj->ni", self.projections, shift - self.offsets)
        apart = self.between - shift
        along = apart - np.einsum("nij,nj->ni", self.projections, apart)
        near = np.linalg.norm(along, axis=1) <= self.reach
        return np.asarray((np.linalg.norm(off, axis=1) <= self.within) & near)

    def gain(self, shift: Array) -> tuple[float, bool]:
        """How many more mate after the shift than before it, by a half those that are not firm; and whether all of the
        shift is confirmed: no single one of these decides some of it, as any would. Nought where nothing is."""
        now, then = self.met(np.zeros(3)), self.met(shift)
        weights = np.where(self.firm, 1.0, 0.5)
        new = np.flatnonzero(then & ~now).astype(np.int64)
        more = float(weights[new].sum() - weights[now & ~then].sum())
        if self._confirmed(shift, new):
            return more, True
        follows = bool(self.firm[new].any()) and _determines(self.projections[new].sum(axis=0), shift)
        return (more if follows else 0.0), False

    def _confirmed(self, shift: Array, new: NDArray[np.int64]) -> bool:
        """Whether all of the shift follows from the others, whichever is left out of those that are not firm."""
        firm = self.projections[new[self.firm[new]]].sum(axis=0)
        others = {tuple(np.round(self.marks[k] / self.within[k]).tolist()): k for k in new[~self.firm[new]]}
        each = list(others.values())[:CLUSTERS]
        total = firm + self.projections[each].sum(axis=0)
        left = [total - self.projections[k] for k in each] or [total]
        return all(_determines(rows, shift) for rows in left)


def _determines(rows: Array, shift: Array) -> bool:
    """Whether a sum of projections leaves no part of the shift open."""
    values, axes = np.linalg.eigh(rows)
    open_ = axes[:, values < 0.5 * PARALLEL]
    return bool(np.linalg.norm(open_.T @ shift) <= PARALLEL * np.linalg.norm(shift))


Row = tuple[Array, Array, Array, float, float, bool, Array]
"""Of one pair in `Mates`."""
Placed = tuple[Surface, Array, Array, float]
"""A surface with its axis, its middle and half its length or breadth (m), in the world."""


def _placed(part: Part, surfaces: Mapping[str, MeshSurfaces], scale: float) -> list[Placed]:
    """Surfaces that determine a place."""
    mesh = part.mesh
    assert mesh is not None
    R, p = part.X_WP[:3, :3], part.X_WP[:3, 3]
    out = []
    for surface in surfaces[mesh.digest].surfaces:
        if surface.kind == "cylinder" and surface.sweep >= ROUND:
            low, high = surface.extent
            middle, half = surface.point + 0.5 * (low + high) * surface.axis, 0.5 * (high - low)
        elif surface.kind == "sphere":
            middle, half = surface.point, 0.0
        elif surface.kind == "plane":
            points = mesh.vertices[np.unique(mesh.faces[surface.faces])]
            middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
            half = 0.5 * float(np.linalg.norm(np.ptp(points, axis=0)))
        else:
            continue
        out.append((surface, R @ surface.axis, R @ (scale * middle) + p, scale * half))
    return out


def mates_of(
    moved: Iterable[Part], others: Iterable[Part], surfaces: Mapping[str, MeshSurfaces], scale: float = 1.0
) -> Mates:
    """The surfaces of the moved parts, `scale` times as large about the origins of their frames, that would mate with
    those of the others."""
    mine = [item for part in moved if part.mesh is not None for item in _placed(part, surfaces, scale)]
    theirs = [item for part in others if part.mesh is not None for item in _placed(part, surfaces, 1.0)]
    rows: list[Row] = []
    for kind in ("cylinder", "sphere", "plane"):
        here, there = ([item for item in side if item[0].kind == kind] for side in (mine, theirs))
        if here and there:
            rows += _of_kind(kind, here, there, scale)
    if not rows:
        none = np.zeros((0, 3))
        return Mates(np.zeros((0, 3, 3)), none, none, none[:, 0], none[:, 0], none[:, 0] > 0.0, np.zeros((0, 4)))
    return Mates(*(np.array(column) for column in zip(*rows, strict=True)))


def _of_kind(kind: str, here: list[Placed], there: list[Placed], scale: float) -> list[Row]:
    """The rows of `Mates` of one kind of surface."""
    axes, axes_o = (np.array([item[1] for item in side]) for side in (here, there))
    sides, sides_o = (np.array([item[0].side for item in side]) for side in (here, there))
    radii, radii_o = (np.array([item[0].radius for item in side]) for side in (here, there))
    radii = scale * radii
    if kind == "plane":
        firm = np.zeros((len(here), len(there)), dtype=bool)
        fits = axes @ axes_o.T < -(1.0 - 0.5 * PARALLEL**2)
    else:
        inside = sides[:, None] > 0
        inner = np.where(inside, radii[:, None], radii_o[None])
        outer = np.where(inside, radii_o[None], radii[:, None])
        firm = (sides[:, None] * sides_o[None] < 0) & (outer >= (1.0 - PRESSED) * inner)
        firm &= outer <= (1.0 + ROOM) * inner
        fits = firm
        if kind == "cylinder":
            bores = (sides[:, None] < 0) & (sides_o[None] < 0)
            fits = fits | (bores & (np.abs(radii[:, None] - radii_o[None]) <= SAME * radii[:, None]))
            fits &= np.abs(axes @ axes_o.T) > 1.0 - 0.5 * PARALLEL**2
    rows: list[Row] = []
    for i, j in zip(*np.nonzero(fits), strict=True):
        (_, axis, middle, half), (_, _, other, half_o) = here[i], there[j]
        along = np.outer(axis, axis)
        P = along if kind == "plane" else np.eye(3) - along if kind == "cylinder" else np.eye(3)
        within = SAME * half if kind == "plane" else SAME * radii[i] + (abs(radii[i] - radii_o[j]) if firm[i, j] else 0)
        mark = np.array([*axis, axis @ middle] if kind == "plane" else [*(P @ middle), radii[i]])
        # bores in line end on each other: as far apart as a facet is off
        reach = half + half_o + (0.0 if firm[i, j] else within)
        rows.append((P, P @ (other - middle), other - middle, reach, float(within), bool(firm[i, j]), mark))
    return rows


def vectors(mates: Mates, longest: float) -> list[tuple[Array, float, bool]]:
    """Translations (m, world) up to some length, after which more surfaces mate, with how many more and whether that
    confirms them; those that are first, then the best, then the shortest."""
    flat = np.linalg.matrix_rank(mates.projections, tol=0.5, hermitian=True) == 1
    proposals, flats = (_clusters(mates, chosen, longest) for chosen in (~flat, flat))
    combined = [*proposals]
    for vector in [np.zeros(3), *proposals]:
        for flat in flats:
            combined.append(vector + flat if abs(vector @ flat) < PARALLEL * (flat @ flat) else _both(vector, flat))
    for one, other in itertools.combinations(flats, 2):
        if abs(one @ other) <= PARALLEL * np.linalg.norm(one) * np.linalg.norm(other):
            combined.append(one + other)
    for one, other in itertools.combinations(proposals, 2):
        combined.append(_both(one, other))
    found: list[tuple[Array, float, bool]] = []
    for vector in combined:
        size = float(np.linalg.norm(vector))
        if not 0.0 < size <= longest:
            continue
        gain, confirmed = mates.gain(vector)
        if gain > 0.0 and not any(np.allclose(vector, known, atol=1e-3 * size) for known, *_ in found):
            found.append((vector, gain, confirmed))
    found.sort(key=lambda item: (not item[2], -item[1], round(float(np.linalg.norm(item[0])), 9), *item[0].tolist()))
    return found[:VECTORS]


def _both(one: Array, other: Array) -> Array:
    """The vector with both as its components along themselves, the least there is."""
    rows = np.array([one, other])
    return np.asarray(np.linalg.lstsq(rows, np.einsum("ij,ij->i", rows, rows), rcond=1e-6)[0])


def _clusters(mates: Mates, chosen: Flags, longest: float) -> list[Array]:
    """Offsets of these that are not nought, the ones that most agree on first."""
    lengths = np.linalg.norm(mates.offsets, axis=1)
    rows = np.flatnonzero(chosen & (lengths > mates.within) & (lengths <= longest))
    counts: list[tuple[int, float, int]] = []
    taken = np.zeros(len(lengths), dtype=bool)
    for row in rows:
        if taken[row]:
            continue
        alike = rows[np.linalg.norm(mates.offsets[rows] - mates.offsets[row], axis=1) <= mates.within[row]]
        taken[alike] = True
        counts.append((-len(alike), float(lengths[row]), int(row)))
    return [mates.offsets[row] for _, _, row in sorted(counts)[:CLUSTERS]]
