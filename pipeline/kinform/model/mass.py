"""Mass properties of parts and bodies, SI."""

from __future__ import annotations

from typing import Annotated

from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.quantities import MATRIX, Inertia, Place, Ratio, columns


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Of one part or body, world frame at the pose of the meshes. `reason` says why mass is None."""

    name: str
    mass: Annotated[float, "kg"] | None
    """kg; None when it cannot be known."""
    volume: Annotated[float, "m³"] | None
    """m³."""
    centre_of_mass: Place
    """(3,) m in W; nan when unknown."""
    inertia: Inertia
    """(3, 3) kg·m² about the centre of mass, world axes; nan when unknown."""
    principal_moments: Annotated[Array, "kg·m²", columns("*_1", "*_2", "*_3")]
    """(3,) ascending."""
    principal_axes: Annotated[Array, "1", MATRIX]
    """(3, 3), columns, right-handed, canonical sign."""
    mass_bound: Ratio
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
    problems: tuple[Annotated[tuple[str, str], columns("part", "problem")], ...]
    """(part, what is wrong) in sentences."""
