"""Mass properties of parts and bodies, SI."""

from __future__ import annotations

from dataclasses import dataclass

from kinform.model.arrays import Array

__all__ = ["MassProperties", "MassReport"]


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Of one part or body, world frame at the pose of the meshes. `reason` says why mass is None."""

    name: str
    mass: float | None
    """kg; None when it cannot be known."""
    volume: float | None
    """m³."""
    centre_of_mass: Array
    """(3,) m in W; nan when unknown."""
    inertia: Array
    """(3, 3) kg·m² about the centre of mass, world axes; nan when unknown."""
    principal_moments: Array
    """(3,) ascending."""
    principal_axes: Array
    """(3, 3), columns, right-handed, canonical sign."""
    mass_bound: float
    """Relative bound of the error of the mass that the tessellation leaves (0 for polyhedra)."""
    origin: str
    """geometry, override, stick, or for bodies the distinct origins of their parts joined by +."""
    reason: str = ""


@dataclass(frozen=True, eq=False)
class MassReport:
    """Parts and bodies, each sorted by name."""

    parts: tuple[MassProperties, ...]
    bodies: tuple[MassProperties, ...]
    valid: bool
    """Every body has a mass and a physically valid inertia."""
    problems: tuple[tuple[str, str], ...]
    """(part, what is wrong) in sentences."""
