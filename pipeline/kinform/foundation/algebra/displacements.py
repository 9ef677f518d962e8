"""Finite motions: displacements of twists and back, by Rodrigues' formula, and what they do to twists."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from kinform.foundation.algebra.rotations import matrices, rotation_vectors, turned
from kinform.foundation.algebra.vectors import cross, cross_matrix
from kinform.model.arrays import Array

UNMOVED = np.eye(4)
"""The displacement of what stays where it is."""


def displacement(twist: Array) -> Array:
    """(…, 4, 4) exponentials of twists (…, 6) (ω; v at the origin) over unit time."""
    omega, v = twist[..., :3], twist[..., 3:]
    square = (omega * omega).sum(axis=-1)[..., None]
    small = square < 1e-4
    safe = np.where(small, 1.0, square)
    angle = np.sqrt(safe)
    versine = np.where(small, 0.5 - square / 24.0 + square * square / 720.0, 2.0 * np.sin(0.5 * angle) ** 2 / safe)
    rest = np.where(small, 1.0 / 6.0 - square / 120.0 + square * square / 5040.0, (1.0 - np.sin(angle) / angle) / safe)
    across = cross(omega, v)
    out = np.zeros((*twist.shape[:-1], 4, 4))
    out[..., :3, :3] = turned(omega)
    out[..., :3, 3] = v + versine * across + rest * cross(omega, across)
    out[..., 3, 3] = 1.0
    return out


def displacements_along(twist: Array) -> Callable[[float], Array]:
    """Displacements (4, 4) of a unit twist (ω; v at the origin), |ω| 1 or 0, by how far it goes: many of one motion."""
    spin = cross_matrix(twist[:3])
    still, sine, versine, way, rest = np.eye(4), *np.zeros((4, 4, 4))
    sine[:3, :3], way[:3, 3] = spin, twist[3:]
    versine[:3, :3], versine[:3, 3] = spin @ spin, spin @ twist[3:]
    rest[:3, 3] = spin @ versine[:3, 3]
    # sixteen numbers are summed sooner than five matrices
    entries = list(zip(*(term.ravel().tolist() for term in (still, sine, versine, way, rest)), strict=True))

    def displaced(s: float) -> Array:
        turned, versed = math.sin(s), 1.0 - math.cos(s)
        left = s - turned
        return np.array([a + turned * b + versed * c + s * d + left * e for a, b, c, d, e in entries]).reshape(4, 4)

    return displaced


def identities(*shape: int) -> Array:
    """(*shape, 4, 4) displacements that move nothing."""
    out = np.empty((*shape, 4, 4))
    out[:] = UNMOVED
    return out


def exponential_terms(screws: Array) -> tuple[Array, ...]:
    """[ω], [ω]², v, [ω] v and [ω]² v of unit screws (…, 6), of which `exponentials` are made."""
    spin = cross_matrix(screws[..., :3])
    twice = spin @ spin
    v = screws[..., 3:]
    return spin, twice, v, (spin @ v[..., None])[..., 0], (twice @ v[..., None])[..., 0]


def exponentials(screws: Array, q: Array, terms: tuple[Array, ...] | None = None) -> Array:
    """(D, n, 4, 4) exp(S q) of unit screws (n, 6), or (D, n, 6), |ω| 1 or 0, for coordinates q (D, n); a slide has no ω
    and falls out of the same terms (`exponential_terms`, where they are known)."""
    spin, twice, v, once, again = exponential_terms(screws) if terms is None else terms
    s, c = np.sin(q)[..., None], 1.0 - np.cos(q)[..., None]
    out = np.zeros((*q.shape, 4, 4))
    out[..., :3, :3] = UNMOVED[:3, :3] + s[..., None] * spin + c[..., None] * twice
    along = q[..., None]
    out[..., :3, 3] = along * v + c * once + (along - s) * again
    out[..., 3, 3] = 1.0
    return out


def twist_of(X: Array) -> Array:
    """(…, 6) twists (ω; v at the origin) whose displacements are X (…, 4, 4), by less than half a turn."""
    omega = rotation_vectors(X[..., :3, :3])
    square = (omega * omega).sum(axis=-1)[..., None]
    small = square < 0.0025
    safe = np.where(small, 1.0, square)
    angle = np.sqrt(safe)
    share = (1.0 - 0.5 * angle * np.sin(angle) / (1.0 - np.cos(angle))) / safe
    share = np.where(small, (1.0 + square / 60.0 + square * square / 2520.0) / 12.0, share)
    across = cross(omega, X[..., :3, 3])
    return np.concatenate([omega, X[..., :3, 3] - 0.5 * across + share * cross(omega, across)], axis=-1)


def poses(positions: Array, quaternions: Array) -> Array:
    """(…, 4, 4) poses at positions (…, 3), turned by unit quaternions (…, 4) wxyz."""
    out = identities(*positions.shape[:-1])
    out[..., :3, :3] = matrices(quaternions)
    out[..., :3, 3] = positions
    return out


def inverse(X: Array) -> Array:
    """Inverses of displacements (…, 4, 4)."""
    turned = np.swapaxes(X[..., :3, :3], -1, -2)
    out = np.zeros_like(X)
    out[..., :3, :3] = turned
    out[..., :3, 3] = -(turned @ X[..., :3, 3:])[..., 0]
    out[..., 3, 3] = 1.0
    return out


def carry(X: Array, twists: Array) -> Array:
    """Twists (…, n, 6) carried along by displacements (…, n, 4, 4)."""
    omega = (X[..., :3, :3] @ twists[..., :3, None])[..., 0]
    v = (X[..., :3, :3] @ twists[..., 3:, None])[..., 0]
    return np.concatenate([omega, v + cross(X[..., :3, 3], omega)], axis=-1)


def adjoint(X: Array) -> Array:
    """(…, 6, 6) matrices that carry twists along by displacements (…, 4, 4)."""
    R = X[..., :3, :3]
    out = np.zeros((*X.shape[:-2], 6, 6))
    out[..., :3, :3] = out[..., 3:, 3:] = R
    out[..., 3:, :3] = cross_matrix(X[..., :3, 3]) @ R
    return out
