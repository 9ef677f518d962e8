"""What making axes agree has moved, joint by joint."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot, lengths
from kinform.foundation.rounding import ARITHMETIC
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint, Misfit, Move

_NONE = np.zeros(3)
"""Stands for the axis or point of a joint that has none."""


def moves_between(before: Sequence[Joint], after: Sequence[Joint]) -> tuple[Move, ...]:
    """By how much each joint was moved, those that were; the same joints in the same order.

    The turn of its axis; the shift of its line across itself, or of its centre.
    """
    joints = [
        (old, new)
        for old, new in zip(before, after, strict=True)
        if not (old.axis is new.axis and old.point is new.point)
    ]
    axes, points = ([(_place(getattr(a, of)), _place(getattr(b, of))) for a, b in joints] for of in ("axis", "point"))
    axis, axis_now = np.array(axes).reshape(-1, 2, 3).swapaxes(0, 1)
    point, point_now = np.array(points).reshape(-1, 2, 3).swapaxes(0, 1)
    angles = lengths(cross(axis, axis_now))
    placed = np.array([old.point is not None and new.point is not None for old, new in joints], dtype=bool)
    shifts = np.where(placed[:, None], point_now - point, 0.0)
    distances = lengths(shifts - dot(axis_now, shifts)[:, None] * axis_now)
    rounding = ARITHMETIC * np.abs(point).max(axis=1, initial=0.0)
    moves = zip(
        joints, (angles * (angles > ARITHMETIC)).tolist(), (distances * (distances > rounding)).tolist(), strict=True
    )
    return tuple(Move(old.name, angle, distance) for (old, _), angle, distance in moves if angle or distance)


def _place(vector: Array | None) -> Array:
    return _NONE if vector is None else vector


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
