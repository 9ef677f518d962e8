"""Finite motions: the displacement of a twist and the twist of a displacement, by Rodrigues' formula."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross_matrix
from kinform.model.arrays import Array

__all__ = ["displacement", "twist_of"]


def displacement(twist: Array) -> Array:
    """(4, 4) exponential of a twist (ω; v at the origin) over unit time."""
    spin = cross_matrix(twist[:3])
    twice = spin @ spin
    sine, versine, rest = _shares(float(np.linalg.norm(twist[:3])))
    out = np.eye(4)
    out[:3, :3] += sine * spin + versine * twice
    out[:3, 3] = twist[3:] + versine * (spin @ twist[3:]) + rest * (twice @ twist[3:])
    return out


def twist_of(X: Array) -> Array:
    """(6,) twist (ω; v at the origin) whose displacement is X (4, 4), by less than half a turn."""
    from scipy.spatial.transform import Rotation

    omega = Rotation.from_matrix(X[:3, :3]).as_rotvec()
    spin = cross_matrix(omega)
    _, versine, rest = _shares(float(np.linalg.norm(omega)))
    return np.concatenate([omega, np.linalg.solve(np.eye(3) + versine * spin + rest * spin @ spin, X[:3, 3])])


def _shares(angle: float) -> tuple[float, float, float]:
    """sin a / a, (1 − cos a) / a² and (a − sin a) / a³, by their series near zero."""
    if angle < 1e-4:
        square = angle * angle
        return 1.0 - square / 6.0, 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0
    return np.sin(angle) / angle, (1.0 - np.cos(angle)) / angle**2, (angle - np.sin(angle)) / angle**3
