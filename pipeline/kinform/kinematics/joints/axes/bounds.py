"""How well each joint's axis is known, and by how much it may be moved to agree with others.

Two bounds hold, both. What is beyond the uncertainty of an axis is the designer's error, not the fit's. And what is
within it but beyond the alignment is not known to be meant: a short journal of a noisy mesh has an axis that is
uncertain by degrees, and turning it into line with its neighbours would be a guess. A tolerance of directions says of
places what it says at the joint's own ends: a line that is turned by the alignment about the middle of the contact
misses its old place by the alignment times the contact's extent, and no more is forgiven to a shift. So no absolute
length decides: the bound grows with the joint. How uncertain a line is depends on where: lines that are made to meet
are shifted by no more than they are uncertain at the point where they meet, which their tilt has part in.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.vectors import box, norm
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.mechanism.constants import SIGMAS
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint, Move

CARRIERS = ("cylinder", "cone", "sphere")
"""Kinds of patches whose fits say best where a joint is."""


@dataclass(frozen=True, eq=False)
class MoveBounds:
    """Of each joint, for directions (rad) and places (m)."""

    sigma: Array
    """(joints, 2) standard uncertainty."""
    allowed: Array
    """(joints, 2) the most that the alignment allows."""
    used: Array
    """(joints, 2) what of that moves have used."""

    @property
    def most(self) -> Array:
        """(joints, 2) the most that it may still be moved by: by alignment and uncertainty, where it is."""
        return np.maximum(np.minimum(SIGMAS * self.sigma, self.allowed) - self.used, 0.0)

    def after(self, moves: Sequence[Move], joints: Sequence[Joint]) -> MoveBounds:
        """The bounds of these joints after moves, all of them."""
        made = {move.joint: (move.angle, move.distance) for move in moves}
        used = np.array([made.get(joint.name, (0.0, 0.0)) for joint in joints]).reshape(-1, 2)
        return replace(self, used=used)


def move_bounds(joints: Sequence[Joint], patches: Sequence[Patch], alignment: float, reach: float) -> MoveBounds:
    """The bounds of joints; `alignment` (rad) of the tolerances, `reach`: size of the assembly (m)."""
    sigma, allowed = np.zeros((len(joints), 2)), np.zeros((len(joints), 2))
    for k, joint in enumerate(joints):
        touching = [patches[p] for p in joint.patches]
        sigma[k] = _uncertainty(joint, touching, reach)
        allowed[k] = alignment, alignment * _extent(touching, reach)
    return MoveBounds(sigma, allowed, np.zeros_like(sigma))


def uncertainties(joints: Sequence[Joint], patches: Sequence[Patch]) -> Array:
    """(joints, 2): of the direction (rad) and of the place (m) of each joint, by its best patch; 0 where it has none.
    Patches on facets of no known surface have no say."""
    out = np.zeros((len(joints), 2))
    for k, joint in enumerate(joints):
        mating = [patches[p] for p in joint.patches if not patches[p].one_sided]
        carriers = [p for p in mating if p.kind in CARRIERS] or mating
        out[k] = [min((p.uncertainty[n] for p in carriers), default=0.0) for n in (0, 1)]
    return out


def _uncertainty(joint: Joint, touching: Sequence[Patch], reach: float) -> tuple[float, float]:
    """By the best patch of those that say best where a joint is; never better than doubles know."""
    carriers = [p for p in touching if p.kind in CARRIERS]
    if not carriers and joint.axis is not None:
        carriers = [p for p in touching if any(p.axis.tolist())]
    angle = min((p.uncertainty[0] for p in carriers if any(p.axis.tolist())), default=0.0)
    position = min((p.uncertainty[1] for p in carriers), default=0.0)
    away = 0.0 if joint.point is None else Frame(joint.point, 1.0).rounding
    return max(angle, SOLVED), max(position, SOLVED * reach, away)


def _extent(touching: Sequence[Patch], reach: float) -> float:
    """m: diagonal of the box of the contact; the assembly's size where a joint was stated."""
    points = [p.points for p in touching if len(p.points)]
    if not points:
        return reach
    low, high = box(np.concatenate(points))
    return norm(high - low)
