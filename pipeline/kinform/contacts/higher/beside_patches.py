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
from kinform.contacts.mating.unread import motions_left, unread_surfaces
from kinform.contacts.search.pair_view import PairView
from kinform.foundation.algebra.screws import Frame, rows
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
    frame = Frame.of(np.concatenate([patch.points for patch in patches]))
    left = motions_left(patches, frame)
    if not len(left):
        return []

    def opposed(points: Array, normals: Array) -> Flags:
        return _opposed(rows(points, normals, frame) @ left.T)

    touches = touches_between(pair, unread, opposed)
    if not touches:
        return []
    held = opposed(*(np.concatenate([getattr(patch, name) for patch in touches]) for name in ("points", "normals")))
    owner = np.repeat(np.arange(len(touches)), [len(patch.points) for patch in touches])
    return [touches[k] for k in np.unique(owner[held])]


def _opposed(speeds: Array) -> Flags:
    """(n,) which samples, with speeds (n, k) along their normals for each motion that is left, have another that
    opposes what they let pass."""
    size = np.linalg.norm(speeds, axis=1)
    holds = np.flatnonzero(size > constants.ENCLOSED_HELD)
    flags = np.zeros(len(speeds), dtype=bool)
    unit = speeds[holds] / size[holds, None]
    flags[holds] = (unit @ unit.T < constants.OPPOSITE_COSINE).any(axis=1)
    return flags
