"""What the patches of a pair do not say: of which surfaces they are not, and which motions they leave.

Of the motions that are left, slides and turns are told apart: what opposes a slide does so by the angle of its normal
alone, and what opposes a turn by its lever, which is compared with nothing but the way of its own place. So a pin near
the axis of a long shaft holds it as one at the rim of a short one does.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.contacts.search.pair_view import PairView
from kinform.foundation.algebra.screws import Frame, rows
from kinform.foundation.algebra.vectors import cross
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch

ENCLOSED_HELD = 0.02
"""Singular value below which patches leave a motion that is to be looked at, rotation of a unit twist below which it
translates, and speed along its normal, as a share of that of its place, above which a point or a line holds a motion.
Chosen, not measured."""


def unread_surfaces(pair: PairView, patches: Sequence[Patch], reach: float) -> Flags:
    """(s, t): near surfaces of a and b that come within `reach` (m), and that no patch is of, nor one of either and a
    neighbour of the other: a fillet beside a face says nothing that the face does not say."""
    flags = pair.overlap(reach)
    of_a, columns = ({k: row for row, k in enumerate(side.ids.tolist())} for side in pair.near)
    a, b = pair.parts
    for patch in patches:
        i, j = patch.surfaces
        if j in columns:
            about = a.index.neighbours(a.surfaces, i)
            flags[[row for k, row in of_a.items() if k == i or k in about], columns[j]] = False
        if i in of_a:
            about = b.index.neighbours(b.surfaces, j)
            flags[of_a[i], [column for k, column in columns.items() if k in about]] = False
    return flags


@dataclass(frozen=True, eq=False)
class MotionsLeft:
    """Motions that patches leave, scaled in a frame."""

    frame: Frame
    slides: Array
    """(k, 6) orthonormal."""
    turns: Array
    """(m, 6) that turn by one radian while a point at the frame's length moves by one, across each other, and across
    the slides at the frame's centre."""

    def __len__(self) -> int:
        return len(self.slides) + len(self.turns)

    def velocities(self, points: Array) -> Array:
        """(n, k + m, 3) of points (n, 3) m: unit vectors in slides, then (m) in turns by one radian."""
        arms = (points - self.frame.centre) / self.frame.length
        turning = self.frame.length * (self.turns[:, 3:] + cross(self.turns[:, :3], arms[:, None]))
        sliding = np.broadcast_to(self.slides[:, 3:], (len(points), len(self.slides), 3))
        return np.concatenate([sliding, turning], axis=1)


def motions_left(patches: Sequence[Patch], frame: Frame) -> MotionsLeft:
    """The motions that patches leave, each of which counts alike."""
    shares = [np.sqrt(patch.weights / patch.weights.sum() / len(patches))[:, None] for patch in patches]
    held = np.concatenate(
        [share * rows(patch.points, patch.normals, frame) for patch, share in zip(patches, shares, strict=True)]
    )
    triangle = np.linalg.qr(held, mode="r") if len(held) > 6 else held
    _, values, right = np.linalg.svd(np.vstack([triangle, np.zeros((6, 6))]))
    left = right[:6][values[:6] < ENCLOSED_HELD]
    _, turning, mixed = np.linalg.svd(left[:, :3].T, full_matrices=True)
    count = int(np.count_nonzero(turning > ENCLOSED_HELD))
    across = mixed @ left
    return MotionsLeft(frame, across[count:], across[:count] / turning[:count, None])
