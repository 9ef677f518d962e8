"""Stated masses, and the words for those that cannot be used."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.formats.description.robot import At, Inertial
from kinform.model.arrays import Array


def symmetric(ixx: float, iyy: float, izz: float, ixy: float, ixz: float, iyz: float) -> Array:
    """The inertia matrix (3, 3) of its six numbers."""
    return np.array([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])


def placed(mass: float, X_FC: Array, inertia: Array, at: At) -> Inertial:
    """The inertial whose frame C, about the axes of which `inertia` (3, 3) is, has the pose X_FC (4, 4)."""
    R = X_FC[:3, :3]
    turned = R @ inertia @ R.T
    return Inertial(mass, X_FC[:3, 3].copy(), 0.5 * (turned + turned.T), at)


def total(inertials: Sequence[Inertial]) -> Inertial:
    """Several bodies as one, by the parallel axis theorem."""
    mass = sum(item.mass for item in inertials)
    centre = sum((item.mass * item.centre for item in inertials), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for item in inertials:
        offset = item.centre - centre
        inertia += item.inertia + item.mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    return Inertial(mass, centre, inertia, inertials[0].at)
