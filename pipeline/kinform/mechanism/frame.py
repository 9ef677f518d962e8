"""The frame in which the loops of a mechanism are scaled: a centre and a length, so that turns and slides compare.

Coordinates, residuals and singular values are in rad, or in shares of this length. Two questions need it. Where joints
are stepped along, the points of the joints say how large the linkage is (`joint_frame`). Where only their twists are
compared, as in the count of freedoms, also joints without a point count: then the axes themselves do (`axes_frame`),
whose points nearest to each other are independent of which point of an axis was stated.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.screws import Frame
from kinform.foundation.algebra.vectors import cross, norm
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint

LEAST_FRAME = 0.05
"""Share of the assembly's size that the length is at least, as joints may meet in one point, and have no size of their
own then. Chosen, not measured."""
PLACED = ("revolute", "screw", "cylindrical", "spherical", "universal")
"""Types of joints whose point says where the mechanism is; that of a slide may be anywhere along it."""


def joint_frame(joints: Sequence[Joint], size: float) -> Frame:
    """Centre and half the diagonal (m) of the box of the joints' points; `size` of the assembly (m)."""
    placed = [j.point for j in joints if j.point is not None and j.type in PLACED]
    placed = placed or [j.point for j in joints if j.point is not None]
    if not placed:
        return Frame(np.zeros(3), size)
    low, high = np.min(placed, axis=0), np.max(placed, axis=0)
    return Frame(0.5 * (low + high), max(0.5 * norm(high - low), LEAST_FRAME * size))


def axes_frame(spaces: Sequence[Array], size: float) -> Frame:
    """Centre and size of the axes of some joints, so that turns and slides compare. Axes that meet have
    no size of their own: then a share of the assembly's counts."""
    middle = _slowest(spaces)
    turns = np.array([t for space in spaces for t in _by_turn(space) if _turns(t, middle, size)]).reshape(-1, 6)
    if not len(turns):
        return Frame(np.zeros(3), size)
    # the point of an axis nearest to the origin may be far away: take those nearest to the middle of all axes
    feet = _feet(turns, np.zeros(3))
    axes = turns[:, :3] / np.linalg.norm(turns[:, :3], axis=1)[:, None]
    across = np.eye(3) - axes[:, :, None] * axes[:, None, :]
    start = feet.mean(axis=0)
    missing = np.einsum("nij,nj->i", across, feet - start)
    centre = start + np.linalg.lstsq(across.sum(axis=0), missing, rcond=SINGLE)[0]
    frame = Frame.of(np.vstack([_feet(turns, centre), centre]))
    return Frame(frame.centre, max(frame.length, LEAST_FRAME * size))


def _by_turn(space: Array) -> Array:
    """The same twists (f, 6) combined so that what turns and what slides are apart: of a turn and a slide, each with a
    part of the other, the axis may be anywhere, and so may that of a slide that turns by rounding."""
    if len(space) < 2:
        return space
    left, values, _ = np.linalg.svd(space[:, :3])
    # Share of the fastest turn of a joint's freedoms below which a combination of them is a slide.
    turning = int(np.count_nonzero(values > 1e-3 * values[0])) if values[0] > 0.0 else 0
    return np.asarray(left.T[:turning] @ space) if 0 < turning < len(space) else space


def _slowest(spaces: Sequence[Array]) -> Array:
    """(3,) the point that all the twists together move least: beside their axes, wherever in the world these are."""
    twists = np.concatenate([np.zeros((0, 6)), *spaces])
    omega, velocity = twists[:, :3], twists[:, 3:]
    across = (omega**2).sum() * np.eye(3) - omega.T @ omega
    return np.asarray(np.linalg.lstsq(across, cross(omega, velocity).sum(axis=0), rcond=SINGLE)[0])


def _turns(twist: Array, middle: Array, size: float) -> bool:
    """Whether a twist turns, beyond the rounding of a slide, seen from the `middle` (3,) of all."""
    return norm(twist[:3]) * size > SOLVED * norm(twist[3:] + cross(twist[:3], middle))


def _feet(turns: Array, centre: Array) -> Array:
    """(n, 3) points of the axes of the twists (n, 6) nearest to `centre`."""
    omega = turns[:, :3]
    velocity = turns[:, 3:] + cross(omega, centre)
    feet: Array = centre + cross(omega, velocity) / (omega**2).sum(axis=1)[:, None]
    return feet
