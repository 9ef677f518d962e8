"""Which way parts go that overlap as they are drawn: on into each other, or apart.

How deep they are does not tell: a plate that goes through another is never deeper in it than both are thick. The volume
that they share tells: it grows the way they go on into each other, and shrinks the way that they part. Where it only
shrinks, and as soon both ways, either may lead through. That is asked within a few thicknesses of each piece of the
overlap, so that what rubs along, is pressed together or threaded, and shares as much wherever it goes, is neither.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property, partial
from itertools import pairwise

import numpy as np
from manifold3d import Manifold

from kinform.collisions.pair.course import narrowed
from kinform.contacts.overlap.solids import ScaledSolid, bounds_volume, overlap_of, scaled_solid
from kinform.foundation.algebra.displacements import inverse
from kinform.foundation.meshes.boxes import bounds, box_corners
from kinform.foundation.rounding import TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.assembly import Mesh

OVERLAP_STEPS = (0.25, 0.5, 1.0, 2.0, 4.0)
"""Thicknesses of a piece of the overlap that it travels until it is asked what the parts share there: two plates that
are drawn in each other by all of one's thickness have parted after twice as much, two ridges crest in crest after
more."""
OVERLAP_SOON = 4
"""So many of these, the first, tell whether parts go on into each other: on a longer way others of their features may
meet."""
OVERLAP_GROWS = 1.15
"""Parts that come to share so many times as much go into each other: those of robots that rub on each other, or are
pressed together, share as much to within a few per cent over such a way."""
OVERLAP_SHRINKS = 0.5
"""Parts that come to share less than this part: a leaf that turns out of another has left it by half where its far end
has travelled as far as it was in it."""


Pose = Callable[[float], Array]
"""(4, 4) of the second part in the first, at a parameter of a motion."""


@dataclass(frozen=True, eq=False)
class _Piece:
    """One connected piece of an overlap, with what of either part is about it."""

    thickness: float
    """m: twice its volume over its area: of a plate, how thick it is."""
    corners: Array
    """(8, 3) m, first part's frame: of its box."""
    volume: float
    solids: tuple[Manifold, Manifold]
    """What both parts are about it, and the volume that they share, about its middle and in units of its size."""
    middle: Array
    size: float
    """(3,) m, first part's frame, and m."""

    def share(self, moved: Array) -> float:
        """The volume that the parts share here once the second is displaced (4, 4), in the first's frame, by its share
        of what it was."""
        R, p = moved[:3, :3], moved[:3, 3]
        place = np.concatenate([R, ((R @ self.middle + p - self.middle) / self.size)[:, None]], axis=1)
        first, second = self.solids
        return float((first ^ second.transform(place)).volume()) / self.volume

    def travelled(self, moved: Array) -> float:
        """m: what of its box goes furthest."""
        return float(np.linalg.norm(self.corners @ moved[:3, :3].T + moved[:3, 3] - self.corners, axis=1).max())


class DrawnOverlap:
    """The overlap of two meshes, the second at a pose (4, 4) in the first: its largest pieces that are thicker than
    `least` (m)."""

    def __init__(self, first: Mesh, second: Mesh, pose: Array, least: float):
        self._meshes, self._pose, self._least = (first, second), pose, least
        self._back = inverse(pose)

    @cached_property
    def _pieces(self) -> list[_Piece]:
        if not all(map(bounds_volume, self._meshes)):
            return []
        first, second = (scaled_solid(mesh, role) for role, mesh in enumerate(self._meshes))
        if first is None or second is None:
            return []
        other = first.of(second, self._pose)
        overlap = overlap_of(first, other, self._least**3)
        if len(overlap.ends) < 2:
            return []
        volumes, areas = overlap.sizes
        thickness = 2.0 * volumes / areas
        corners = overlap.corners.reshape(-1, 3)
        boxes = [corners[3 * i : 3 * j] for i, j in pairwise(overlap.ends)]
        order = np.lexsort((np.arange(len(volumes)), -volumes))
        # Pieces that are asked about, the largest: a choice.
        largest = order[thickness[order] > self._least][:4].tolist()
        return [_piece(first, other, float(thickness[k]), *bounds(boxes[k])) for k in largest]

    def leads_in(self, pose: Pose, start: float, end: float, spare: float = 0.0) -> float | None:
        """How far a motion from `start`, where the parts are as here, up to `end` goes until it is seen to lead on into
        the overlap, or to lead as well that way as apart, and has gone on by more than `spare` (m); None where it does
        not."""
        found = [
            self._reached(piece, pose, max(OVERLAP_STEPS[-1] * piece.thickness, spare), start, end)
            for piece in self._pieces
            if self._piece_leads_in(piece, pose, start, end)
        ]
        return min(found, default=None)

    def _piece_leads_in(self, piece: _Piece, pose: Pose, start: float, end: float) -> bool:
        ways = list(self._displaced(piece, pose, start, end))
        shares = [piece.share(moved) for moved in ways]
        if max(shares[:OVERLAP_SOON]) > OVERLAP_GROWS:
            return True
        if min(shares) >= OVERLAP_SHRINKS:
            return False
        back = [piece.share(inverse(moved)) for moved in ways]
        return max(back[:OVERLAP_SOON]) <= OVERLAP_GROWS and min(back) < OVERLAP_SHRINKS

    def _displaced(self, piece: _Piece, pose: Pose, start: float, end: float) -> Iterator[Array]:
        """(4, 4) how the piece is displaced where it has travelled so many thicknesses, as far as it does up to
        `end`."""
        at = start
        for step in OVERLAP_STEPS:
            at = self._reached(piece, pose, step * piece.thickness, at, end)
            yield self._moved(pose, at)
            if at >= end:
                return

    def _reached(self, piece: _Piece, pose: Pose, way: float, start: float, end: float) -> float:
        """The parameter after `start` at which a piece has travelled so far (m), or the end."""
        beyond, low, high = partial(self._beyond, piece, pose, way), start, end
        while high > low and beyond(0.5 * (low + high)):
            high = 0.5 * (low + high)
        # Share of the way to which these places are found: a choice.
        return narrowed(low, high, 1e-3 * high, beyond)[1]

    def _beyond(self, piece: _Piece, pose: Pose, way: float, s: float) -> bool:
        return piece.travelled(self._moved(pose, s)) > way

    def _moved(self, pose: Pose, s: float) -> Array:
        """(4, 4) displacement of the second part at s, in the first's frame."""
        return np.asarray(pose(s) @ self._back)


def _piece(first: ScaledSolid, other: Manifold, thickness: float, low: Array, high: Array) -> _Piece:
    """A piece of the overlap of a solid and of another in its unit and from its origin: so thick, in this box (3,)
    (m)."""
    way = OVERLAP_STEPS[-1] * thickness
    centre, size = 0.5 * (low + high), float((high - low).max()) + way
    about = []
    for solid, margin in ((first.solid, way), (other, 2.0 * way)):
        begin, end = ((side - first.middle) / first.scale for side in (low - margin, high + margin))
        cut = solid ^ Manifold.cube((end - begin).tolist()).translate(begin.tolist())
        about.append(cut.translate(((first.middle - centre) / first.scale).tolist()).scale([first.scale / size] * 3))
    volume = max(float((about[0] ^ about[1]).volume()), TINY)
    return _Piece(thickness, box_corners(low, high, np.eye(4)), volume, (about[0], about[1]), centre, size)
