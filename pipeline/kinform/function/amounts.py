"""Mass, centre of mass and inertia of a selection of parts, with the bound that tessellation leaves."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.frozen import dataclass
from kinform.mass import weighed_together
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.mass import MassReport


@dataclass(frozen=True, eq=False)
class Amount:
    """Several parts together, world axes, at the pose of the meshes."""

    mass: float
    """kg."""
    centre: Array
    """(3,) m."""
    inertia: Array
    """(3, 3) kg·m² about the centre."""
    bound: float
    """Relative bound of the mass's error."""

    def about(self, axis: Array, point: Array | None) -> float:
        """Moment of inertia (kg·m²) about the unit axis through the point (m), or through the centre."""
        about_centre = float(axis @ self.inertia @ axis)
        if point is None:
            return about_centre
        return about_centre + self.mass * self.distance(axis, point) ** 2

    def distance(self, axis: Array, point: Array) -> float:
        """Distance (m) of the centre of mass from a line."""
        return float(np.linalg.norm(cross(axis, self.centre - point)))


def amount_of(assembly: Assembly, report: MassReport, parts: Sequence[str]) -> Amount | str:
    """The parts together by the parallel axis theorem, groups with a stated mass as that; a sentence where one is not
    known."""
    chosen = weighed_together(assembly, report, sorted(parts))
    for part in chosen:
        if part.mass is None:
            return f"the mass of '{part.name}' is not known: {part.reason}"
    masses = [part.mass or 0.0 for part in chosen]
    whole = math.fsum(masses)
    if not whole > 0.0:
        return "the mass is zero"
    centre = np.sum([m * p.centre_of_mass for m, p in zip(masses, chosen, strict=True)], axis=0) / whole
    inertia = np.zeros((3, 3))
    for m, part in zip(masses, chosen, strict=True):
        d = part.centre_of_mass - centre
        inertia += part.inertia + m * (d @ d * np.eye(3) - np.outer(d, d))
    bound = math.fsum(m * p.mass_bound for m, p in zip(masses, chosen, strict=True)) / whole
    return Amount(whole, centre, inertia, bound)
