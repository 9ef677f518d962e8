"""Points and lines that hold what the patches beside them leave: the cross pin of a shaft, in a slot of its bore, which
keeps it from turning; the pin of a ball in its socket; a flat under a pin.

Beside patches, surfaces that merely pass close to each other are many, and say little. Those count that hold a motion
which all patches leave, in both senses: as two sides of a slot do, or the two ends of one line. What opposes a motion
in one sense only is a stop.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.contacts import constants
from kinform.contacts.higher.points_and_lines import may_touch, touches_between
from kinform.contacts.mating.unread import MotionsLeft, motions_left, unread_surfaces
from kinform.contacts.search.pair_view import PairView
from kinform.foundation.algebra.screws import Frame
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch


def holding_touches(pair: PairView, patches: Sequence[Patch]) -> list[Patch]:
    """Points and lines of contact beside these patches that hold what these leave, in the frame of the pair.

    None beside other points and lines, and none of surfaces that have a patch, or that are next to one that has.
    """
    if not patches or any(patch.kind in constants.TOUCHING for patch in patches):
        return []
    if not may_touch(pair, pair.overlap(pair.tolerance)):
        return []
    unread = unread_surfaces(pair, patches, pair.tolerance)
    if not may_touch(pair, unread):
        return []
    left = motions_left(patches, Frame.of(np.concatenate([patch.points for patch in patches])))
    if not len(left):
        return []
    play = max([_play(patch) for patch in patches if patch.kind in constants.ROUND_KINDS], default=0.0)
    play = max(play, constants.EXACT_GAP * pair.tolerance)

    def opposed(points: Array, normals: Array) -> Flags:
        return _opposed(left, points, normals, play)

    touches = touches_between(pair, unread, opposed)
    if not touches:
        return []
    held = opposed(*(np.concatenate([getattr(patch, name) for patch in touches]) for name in ("points", "normals")))
    owner = np.repeat(np.arange(len(touches)), [len(patch.points) for patch in touches])
    return [touches[k] for k in np.unique(owner[held])]


def _play(patch: Patch) -> float:
    """m by which the axis or the centre of the patch may be elsewhere."""
    return max(patch.gap, 0.0) + patch.offset + constants.SIGMAS * patch.uncertainty[1]


def _opposed(left: MotionsLeft, points: Array, normals: Array, play: float) -> Flags:
    """(n,) which samples, at points (n, 3) m with normals (n, 3), hold some motion that is left, and have another that
    opposes what they let pass. No lever within `play` (m) of the axis holds a turn."""
    count, velocities = len(left.slides), left.velocities(points)
    speeds = (velocities * normals[:, None]).sum(axis=2)
    cosines, levers, way = speeds[:, :count], speeds[:, count:], np.linalg.norm(velocities[:, count:], axis=2)
    turned = np.abs(levers) > np.maximum(constants.ENCLOSED_HELD * way, play)
    holds = np.flatnonzero(turned.any(axis=1) | (np.linalg.norm(cosines, axis=1) > constants.ENCLOSED_HELD))
    flags = np.zeros(len(points), dtype=bool)
    slide, lever = cosines[holds], np.where(turned, levers, 0.0)[holds]
    # of two samples, levers are shares of the longer one's
    slid, long = (slide**2).sum(axis=1), (lever**2).sum(axis=1)
    scale = np.maximum(np.maximum(long[:, None], long), np.finfo(np.float64).tiny)
    size = np.sqrt(slid[:, None] + long[:, None] / scale)
    cosine = (slide @ slide.T + lever @ lever.T / scale) / (size * size.T)
    flags[holds] = (cosine < constants.OPPOSITE_COSINE).any(axis=1)
    return flags
