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
from collections.abc import Iterator

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.rounding import SINGLE
from kinform.kinematics.joints.pair.constants import OPPOSING_SPEED
from kinform.kinematics.joints.pair.evidence import LOOSE_ANGLE, Evidence
from kinform.kinematics.joints.pair.motion_cone import WITHIN
from kinform.kinematics.joints.pair.suspects import AtRest, Suspect, suspect
from kinform.model.arrays import Array

SLOT_PLAY = math.radians(5.0)
"""rad by which what a pin holds may turn until it touches either side of its slot: as with axes that mate, no play
excuses a greater angle."""


def pins(pair: AtRest) -> Iterator[Suspect]:
    """Touches on planes whose directions are known, if all else is of surfaces that are known."""
    flags = np.array(
        [item.patch.flat and not item.patch.one_sided and item.angle < LOOSE_ANGLE for item in pair.evidence.items]
    )
    if not pair.touching and flags.any() and not flags.all() and (flags | pair.sure).all():
        yield suspect(flags, "pin")


def is_slot(pair: AtRest, of: Suspect, free: Array, freed: Array) -> Array | None:
    """What is free where pins do not hold; None where they are not in slots: where the cone of motions has in one sense
    what they hold, or their play lets it turn."""
    along = pair.cone.beyond.T @ freed
    in_one_sense = along.size and float(np.linalg.svd(along, compute_uv=False)[0]) > WITHIN
    if in_one_sense or not _stay(pair.evidence, pair.basis, of.items):
        return None
    return free if _play(pair.evidence, freed, of.items) <= SLOT_PLAY else None


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


def _play(evidence: Evidence, freed: Array, out: tuple[int, ...]) -> float:
    """rad by which the motions (6, n) that the items `out` alone hold may turn until they hold, in either sense; a
    lever that is short sees that better than its row does."""
    rows = np.concatenate([evidence.rows[evidence.start[k] : evidence.start[k + 1]] for k in out])
    gaps = np.concatenate([evidence.items[k].patch.gaps for k in out])
    _, turns, mixed = np.linalg.svd(freed[:3], full_matrices=True)
    most = 0.0
    for turn, motion in zip(turns, mixed, strict=False):
        if turn > SINGLE:
            levers = rows @ (freed @ motion) * evidence.frame.length / turn
            least = OPPOSING_SPEED * float(np.abs(levers).max())
            for sense in (1.0, -1.0):
                against = sense * levers > least
                most = max(most, float((gaps[against] / np.abs(levers[against])).min(initial=math.inf)))
    return most
