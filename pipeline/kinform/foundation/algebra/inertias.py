"""Mass, centre and inertia of several bodies together, by the parallel axis theorem."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinform.model.arrays import Array

__all__ = ["add_inertias"]


def add_inertias(masses: Sequence[float], centres: Array, inertias: Sequence[Array]) -> tuple[float, Array, Array]:
    """Mass (kg), centre (3,) m and inertia (3, 3) kg·m² about it, of bodies with masses, centres (n, 3) and inertias
    (3, 3) about these."""
    shares = np.array(masses, dtype=np.float64)
    mass = math.fsum(shares)
    # Offsets from one of the centres: far from the origin the mean would lose digits.
    offsets = centres - centres[0]
    mean = shares @ offsets / mass
    inertia = np.zeros((3, 3))
    for share, offset, of_its_own in zip(shares, offsets - mean, inertias, strict=True):
        inertia += of_its_own + share * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    return mass, centres[0] + mean, inertia
