"""Screw algebra: twists and rows in scaled coordinates, motions of lines and points.

A twist is (ω; v), v the velocity of the point at the reference. The scaled twist of a `Frame` with
centre c and length L is (L·ω; v_c): all six numbers are velocities, so that singular values of
constraint rows compare rotations with translations at the size of the contact.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import box, cross, lengths, norm, weighted_mean
from kinform.foundation.rounding import SINGLE, TINY
from kinform.frozen import dataclass
from kinform.model.arrays import Array


@dataclass(frozen=True, eq=False)
class Frame:
    """Centre (3,) m in W and length (m) that scale twists and rows."""

    centre: Array
    length: float

    @property
    def rounding(self) -> float:
        """Share of a unit scaled twist that is not known where it stems from coordinates of the world: these are
        rounded the more coarsely the farther the centre is from the origin."""
        # Spacings of doubles by which a coordinate that follows from a few others is off: positions of parts, what is
        # measured on them, and twists each add one or two. Chosen, not measured.
        return 8.0 * float(np.finfo(np.float64).eps) * norm(self.centre) / self.length

    @staticmethod
    def of(points: Array) -> Frame:
        """Centre and half diagonal of the box of the points (n, 3)."""
        low, high = box(points)
        half = 0.5 * norm(high - low)
        return Frame(0.5 * (low + high), half if half > 0.0 else 1.0)

    @staticmethod
    def about(points: Array, weights: Array) -> Frame:
        """The mean of points (n, 3) by weights (n,), and how far the farthest is from it: however they are turned."""
        centre = weighted_mean(points, weights)
        length = float(lengths(points - centre).max())
        return Frame(centre, length if length > 0.0 else 1.0)


def rows(points: Array, normals: Array, frame: Frame) -> Array:
    """Constraint rows (n, 6) [((p − c)/L) × n, n] against scaled twists."""
    return np.hstack([cross((points - frame.centre) / frame.length, normals), normals])


def rotation(axis: Array, point: Array, frame: Frame, pitch: float = 0.0) -> Array:
    """Scaled unit twist (6,) of a rotation about the line (unit axis, point) that advances by `pitch` (m) a turn."""
    velocity = cross(axis, frame.centre - point)
    if pitch:
        velocity = velocity + pitch / (2.0 * np.pi) * axis
    twist = np.concatenate([axis, velocity / frame.length])
    unit: Array = twist / norm(twist)
    return unit


def translation(direction: Array) -> Array:
    """Scaled unit twist (6,) of a translation along the unit direction."""
    twist = np.zeros(6)
    twist[3:] = direction
    return twist


def twist_at_origin(scaled: Array, frame: Frame) -> Array:
    """Twists (ω; v at the world's origin), columns (6, k), of scaled twists (6, k)."""
    omega = scaled[:3] / frame.length
    return np.vstack([omega, scaled[3:] + cross(frame.centre, omega.T).T])


def scaled(twists: Array, frame: Frame) -> Array:
    """Scaled twists (6, k) of twists (ω; v at the world's origin), columns (6, k)."""
    omega = twists[:3]
    at_centre = twists[3:] + cross(omega.T, frame.centre).T
    return np.concatenate([omega * frame.length, at_centre])


def span(vectors: Array, tolerance: float = SINGLE) -> Array:
    """Orthonormal basis (n, r) of the span of the columns of `vectors` (n, k)."""
    if not vectors.shape[1]:
        return np.zeros((len(vectors), 0))
    left, values, _ = np.linalg.svd(vectors, full_matrices=False)
    return np.asarray(left[:, values > tolerance * max(float(values[0]), TINY)])


def bracket(a: Array, b: Array) -> Array:
    """Lie bracket [a, b] of twists (…, 6): the rate of b when it is carried along by a."""
    turn = cross(a[..., :3], b[..., :3])
    return np.concatenate([turn, cross(a[..., :3], b[..., 3:]) + cross(a[..., 3:], b[..., :3])], axis=-1)
