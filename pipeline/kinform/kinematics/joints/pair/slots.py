"""Pins in slots: points and lines of contact on planes, which hold in both senses what faces beside them leave.

Points and lines are of one instant: where the bodies touch next is not known, and what they alone hold is in doubt
(`certainty`). Of a pin between the sides of a slot more is known. Where every motion that is left lets the planes slide
on themselves, the pin stays between them, as far as they reach, as a key does in its keyway. So the joint has two
readings: the pin holds, or it is drawn where it does not. Only the first may be chosen by a function that states it
(`bodies.readings`): a function that states the second states a motion that the drawn pin forbids.

Not of these are a pin between rounds, which it passes as the bodies move on, one of a mesh whose vertices scatter, one
whose play lets it turn, and one beside contact that is in doubt itself.
"""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import SINGLE, TINY
from kinform.kinematics.joints.pair.evidence import LOOSE_ANGLE, Evidence
from kinform.kinematics.joints.pair.freedoms import freedoms_beyond
from kinform.kinematics.joints.pair.one_sided import OPPOSING_SPEED, OtherReading
from kinform.model.arrays import Array, Flags
from kinform.model.tolerances import Tolerances

SLOT_PLAY = math.radians(5.0)
"""rad by which what a pin holds may turn until it touches either side of its slot: as with axes that mate, no play
excuses a greater angle."""
SLOT_OPPOSED = -0.999
"""Greatest cosine between what two sides of a slot hold: as in `contacts`. Their faces are parallel to 2.6°."""


def pin_reading(
    evidence: Evidence, twists: Array, preserved: Flags, basis: Array, sure: Flags, tolerances: Tolerances
) -> OtherReading | None:
    """What is free where pins do not hold, of a pair whose freedoms are `basis` (6, k), if all contact is of surfaces
    that are known (`sure` (items,)) and of pins in slots beside them; None if not."""
    pins = np.array([_on_plane(item.patch.flat and not item.patch.one_sided, item.angle) for item in evidence.items])
    if not pins.any() or pins.all() or not (pins | sure).all():
        return None
    free, freed = freedoms_beyond(evidence, twists, preserved, ~pins, tolerances, basis)
    out = tuple(int(k) for k in np.flatnonzero(pins))
    if not freed.shape[1] or not _stay(evidence, basis, out) or not _hold(evidence, freed, out):
        return None
    return OtherReading(evidence.form(free), free, out, "pin")


def _on_plane(flat: bool, angle: float) -> bool:
    """Is it a touch on a plane whose direction is known?"""
    return flat and angle < LOOSE_ANGLE


def _stay(evidence: Evidence, basis: Array, out: tuple[int, ...]) -> bool:
    """Do the planes of the items `out` keep their directions in all motions of the basis (6, k), as far as these are
    known? They are preserved by them, and so slide on themselves, however far the bodies move."""
    turns = basis[:3].T
    size = np.linalg.norm(turns, axis=1)
    for k in out:
        tilt = np.linalg.norm(cross(turns, evidence.items[k].normals[0]), axis=1)
        if (tilt > math.sin(evidence.items[k].angle) * size + SINGLE).any():
            return False
    return True


def _hold(evidence: Evidence, freed: Array, out: tuple[int, ...]) -> bool:
    """Do the items `out` oppose the motions (6, n) that they alone hold in both senses, and with little play?"""
    pieces = [slice(evidence.start[k], evidence.start[k + 1]) for k in out]
    rows = np.concatenate([evidence.rows[of] for of in pieces])
    gaps = np.concatenate([evidence.items[k].patch.gaps for k in out])
    speeds = rows @ freed
    size = np.linalg.norm(speeds, axis=1)
    unit = speeds / np.maximum(size, TINY)[:, None]
    holds = size > OPPOSING_SPEED * float(size.max())
    opposed = (unit[holds] @ unit[holds].T < SLOT_OPPOSED).any(axis=1)
    if not opposed.all():
        return False
    _, turns, mixed = np.linalg.svd(freed[:3], full_matrices=True)
    for turn, motion in zip(turns, mixed, strict=False):
        if turn <= SINGLE:
            continue
        levers = speeds @ motion * evidence.frame.length / turn
        for sense in (1.0, -1.0):
            against = sense * levers > OPPOSING_SPEED * float(np.abs(levers).max())
            if not against.any() or float((gaps[against] / np.abs(levers[against])).min()) > SLOT_PLAY:
                return False
    return True
