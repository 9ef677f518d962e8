"""What making axes agree has moved, joint by joint."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross, norm
from kinform.kinematics.constants import UNMOVED
from kinform.model.kinematics import Joint, Misfit, Move


def moves_between(before: Sequence[Joint], after: Sequence[Joint]) -> tuple[Move, ...]:
    """By how much each joint was moved, those that were; the same joints in the same order."""
    moves = (_move(old, new) for old, new in zip(before, after, strict=True))
    return tuple(move for move in moves if move.angle > 0.0 or move.distance > 0.0)


def misfit_of(moves: Sequence[Move]) -> Misfit:
    """The greatest of all moves, and where."""
    turned = max(moves, key=lambda move: move.angle, default=None)
    shifted = max(moves, key=lambda move: move.distance, default=None)
    return Misfit(
        angle=0.0 if turned is None else turned.angle,
        distance=0.0 if shifted is None else shifted.distance,
        angle_at="" if turned is None or turned.angle == 0.0 else turned.joint,
        distance_at="" if shifted is None or shifted.distance == 0.0 else shifted.joint,
    )


def _move(old: Joint, new: Joint) -> Move:
    """The turn of its axis; the shift of its line across itself, or of its centre."""
    angle = distance = 0.0
    if old.axis is new.axis and old.point is new.point:
        return Move(old.name, angle, distance)
    if old.axis is not None and new.axis is not None:
        angle = norm(cross(old.axis, new.axis))
    if old.point is not None and new.point is not None:
        shift = new.point - old.point
        if new.axis is not None:
            shift = shift - new.axis * float(new.axis @ shift)
        distance = norm(shift)
    rounding = UNMOVED * (0.0 if old.point is None else float(np.abs(old.point).max()))
    return Move(old.name, angle if angle > UNMOVED else 0.0, distance if distance > rounding else 0.0)
