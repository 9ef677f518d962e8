"""Points and lines that hold what the patches beside them leave: the cross pin of a shaft, in a slot of its bore, which
keeps it from turning; the pin of a ball in its socket; a flat under a pin.

Beside patches, surfaces that merely pass close to each other are many, and say little. Those count that hold a motion
which all patches leave, in both senses: as two sides of a slot do, or the two ends of one line. What opposes a motion
in one sense only is a stop, and says nothing; but where one pin is at two stops, at the corner of a slot, neither of
two motions that are left is free.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from kinform.contacts.constants import EXACT_GAP, TOUCH, TOUCHING
from kinform.contacts.higher.constants import ROUND_KINDS, STRAIGHT_COSINE
from kinform.contacts.higher.points_and_lines import may_touch, touches_between
from kinform.contacts.mating.unread import ENCLOSED_HELD, MotionsLeft, motions_left, unread_surfaces
from kinform.contacts.search.pair_view import PairView
from kinform.foundation.algebra.screws import Frame
from kinform.foundation.constants import COVERAGE
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch


def holding_touches(pair: PairView, patches: Sequence[Patch]) -> list[Patch]:
    """Points and lines of contact beside these patches that hold what these leave, or one pin at the corner of two
    walls, in the frame of the pair.

    None beside other points and lines, and none of surfaces that have a patch, or that are next to one that has.
    """
    if not patches or any(patch.kind in TOUCHING for patch in patches):
        return []
    if not may_touch(pair, pair.overlap(pair.tolerance)):
        return []
    unread = unread_surfaces(pair, patches, pair.tolerance)
    if not may_touch(pair, unread):
        return []
    left = motions_left(patches, Frame.of(np.concatenate([patch.points for patch in patches])))
    if not len(left):
        return []
    play = max([_play(patch) for patch in patches if patch.kind in ROUND_KINDS], default=0.0)
    play = max(play, EXACT_GAP * pair.tolerance)

    def opposed(points: Array, normals: Array) -> Flags:
        return _any_cosine(left, points, normals, play, _opposite)

    def wanted(points: Array, normals: Array) -> Flags:
        flags = opposed(points, normals)
        return flags if flags.any() or len(left) != 2 else _any_cosine(left, points, normals, play, _askew)

    touches = touches_between(pair, unread, wanted)
    if not touches:
        return []
    held = opposed(*(np.concatenate([getattr(patch, name) for patch in touches]) for name in ("points", "normals")))
    owner = np.repeat(np.arange(len(touches)), [len(patch.points) for patch in touches])
    if held.any() or len(left) != 2:
        return [touches[k] for k in np.unique(owner[held])]
    return _cornered(pair, touches, left, play)


def _cornered(pair: PairView, touches: list[Patch], left: MotionsLeft, play: float) -> list[Patch]:
    """Those of a pin, or a ball, that touches two planes which oppose different motions."""
    close = [p for p in touches if p.flat and float(np.abs(p.gaps).max()) <= TOUCH * pair.tolerance]
    pins: dict[tuple[int, int], list[Patch]] = {}
    for patch in close:
        side = 0 if patch.radii[0] > 0.0 else 1
        pins.setdefault((side, patch.surfaces[side]), []).append(patch)
    out = []
    for walls in pins.values():
        points, normals = (np.concatenate([getattr(patch, name) for patch in walls]) for name in ("points", "normals"))
        askew = _any_cosine(left, points, normals, play, _askew)
        owner = np.repeat(np.arange(len(walls)), [len(patch.points) for patch in walls])
        if len(walls) > 1:
            out += [walls[k] for k in np.unique(owner[askew])]
    return out


def _play(patch: Patch) -> float:
    """m by which the axis or the centre of the patch may be elsewhere."""
    return max(patch.gap, 0.0) + patch.offset + COVERAGE * patch.uncertainty[1]


def _opposite(cosine: Array) -> Flags:
    return np.asarray(cosine < -STRAIGHT_COSINE)


def _askew(cosine: Array) -> Flags:
    # two walls within 60° of perpendicular are a corner for a pin
    return np.asarray(np.abs(cosine) < 0.5)


def _any_cosine(
    left: MotionsLeft, points: Array, normals: Array, play: float, wanted: Callable[[Array], Flags]
) -> Flags:
    """(n,) which samples, at points (n, 3) m with normals (n, 3), hold some motion that is left, and have another of
    which the cosine between what the two hold is `wanted`. No lever within `play` (m) of the axis holds a turn."""
    count, velocities = len(left.slides), left.velocities(points)
    speeds = (velocities * normals[:, None]).sum(axis=2)
    cosines, levers, way = speeds[:, :count], speeds[:, count:], np.linalg.norm(velocities[:, count:], axis=2)
    turned = np.abs(levers) > np.maximum(ENCLOSED_HELD * way, play)
    holds = np.flatnonzero(turned.any(axis=1) | (np.linalg.norm(cosines, axis=1) > ENCLOSED_HELD))
    flags = np.zeros(len(points), dtype=bool)
    slide, lever = cosines[holds], np.where(turned, levers, 0.0)[holds]
    # of two samples, levers are shares of the longer one's
    slid, long = (slide**2).sum(axis=1), (lever**2).sum(axis=1)
    scale = np.maximum(np.maximum(long[:, None], long), np.finfo(np.float64).tiny)
    size = np.sqrt(slid[:, None] + long[:, None] / scale)
    cosine = (slide @ slide.T + lever @ lever.T / scale) / (size * size.T)
    flags[holds] = wanted(cosine).any(axis=1)
    return flags
