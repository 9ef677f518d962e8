"""One basis of a space of twists, whichever computed it: of a `general` joint, whose freedoms have no names.

Singular vectors of equal singular values are any vectors of their space, and the last bit decides which. Here turns
come first, each about a direction of unit length, then slides. Directions are axes of the world where they can be any,
and of a plane those that its normal tells. What turns do of slides is left out, seen from the centre of the contact.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.screws import Frame, twist_at_origin
from kinform.foundation.algebra.vectors import canonical, cross, norm
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED
from kinform.kinematics.constants import SAME_DIRECTION
from kinform.model.arrays import Array


def canonical_twists(basis: Array, frame: Frame) -> Array:
    """(k, 6) twists (ω; v at the world's origin) that span what `basis` does, (6, k) orthonormal and scaled in `frame`.
    Where it is not clear which of them turn, they are those of `basis`."""
    if not basis.shape[1]:
        return np.zeros((0, 6))
    _, values, right = np.linalg.svd(basis[:3], full_matrices=True)
    turning = int(np.count_nonzero(values > SINGLE))
    if np.any(values[turning:] > SOLVED):
        return twist_at_origin(basis, frame).T
    mixed = basis @ right.T
    turns, slides = mixed[:, :turning], directions(mixed[3:, turning:])
    axes = directions(turns[:3])
    velocity = turns[3:] @ np.linalg.lstsq(turns[:3], axes, rcond=None)[0] if turning else np.zeros((3, 0))
    velocity = frame.length * (velocity - slides @ (slides.T @ velocity))
    about = cross(frame.centre, axes.T).T
    there = without_noise(velocity + about, norm(frame.centre) + frame.length)
    return np.hstack([np.vstack([axes, there]), np.vstack([np.zeros_like(slides), slides])]).T


def directions(space: Array) -> Array:
    """(3, r) perpendicular unit vectors that span the independent columns (3, r): axes of the world where these are
    all; of a plane the first is across the first axis of those farthest from its normal."""
    count = space.shape[1]
    if count == 0:
        return space
    if count == 3:
        return np.eye(3)
    if count == 1:
        return without_noise(canonical(space[:, 0]), 1.0)[:, None]
    normal = without_noise(canonical(np.linalg.svd(space)[0][:, 2]), 1.0)
    far = np.abs(normal) <= np.abs(normal).min() + SAME_DIRECTION
    first = cross(np.eye(3)[int(np.argmax(far))], normal)
    first = canonical(first / norm(first))
    return np.column_stack([first, without_noise(canonical(cross(normal, first)), 1.0)])


def without_noise(numbers: Array, size: float) -> Array:
    """The numbers, with 0 in place of those that are the rounding of `size`."""
    return np.where(np.abs(numbers) < ARITHMETIC * size, 0.0, numbers)
