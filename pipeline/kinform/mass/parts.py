"""Mass properties of single parts: as the user states them, else from geometry and density, else why not."""

from __future__ import annotations

import math

import numpy as np

from kinform.mass.bound import mass_bound
from kinform.mass.integrals import SolidIntegrals, integrate_solid
from kinform.mass.principal import impossible, principal
from kinform.model.arrays import Array
from kinform.model.assembly import Mesh, MeshHealth, Part
from kinform.model.mass import MassProperties
from kinform.model.surfaces import MeshSurfaces
from kinform.model.tolerances import Tolerances

__all__ = ["SolidShape", "known", "part_properties", "unknown"]


FLAT = 1e-12
"""A solid with less than this share of its diagonal's cube is flat: what is left is rounding."""


class SolidShape:
    """What one mesh gives to every part that uses it: its integrals, or the reason why it has none."""

    def __init__(self, mesh: Mesh, surfaces: MeshSurfaces | None, tolerances: Tolerances):
        self.integrals: SolidIntegrals | None = None
        self.bound = math.nan
        self.reason = _not_a_solid(mesh.health)
        if self.reason:
            return
        integrals = integrate_solid(mesh.vertices, mesh.faces)
        flat = FLAT * mesh.diagonal**3
        if abs(integrals.volume) <= flat:
            self.reason = "the mesh encloses no volume"
        elif integrals.volume < 0.0:
            self.reason = "the mesh is inside out: its facets enclose a negative volume"
        else:
            self.integrals = integrals
            self.bound = mass_bound(mesh, integrals.volume, surfaces, tolerances)


def _not_a_solid(health: MeshHealth) -> str:
    """Why the mesh bounds no solid; "" when it does."""
    if health.facets == 0:
        return "the mesh has no facets"
    if not health.watertight:
        return f"the mesh is not watertight ({health.open_edges} open and {health.overused_edges} overused edges)"
    if not health.consistent_winding:
        return "the facets of the mesh are wound inconsistently"
    return ""


def part_properties(part: Part, shape: SolidShape | None) -> MassProperties:
    """Mass properties of a part in the world, at the pose of the meshes."""
    volume = shape.integrals.volume if shape is not None and shape.integrals is not None else None
    R_WP, p_WP = part.X_WP[:3, :3], part.X_WP[:3, 3]
    if part.override is not None:
        stated = part.override
        wrong = impossible(stated.mass, stated.inertia)
        if not wrong and not np.all(np.isfinite(stated.centre_of_mass)):
            wrong = "the centre of mass is not a number"
        if wrong:
            return unknown(part.name, "override", f"the stated values are impossible: {wrong}", volume)
        centre = R_WP @ stated.centre_of_mass + p_WP
        return known(part.name, stated.mass, volume, centre, R_WP @ stated.inertia @ R_WP.T, 0.0, "override")
    if shape is None:
        return unknown(part.name, "stick", "it has no mesh and no mass is stated", None)
    if not part.solid:
        return unknown(part.name, "geometry", "it is not solid: its surfaces bound no volume", None)
    if shape.integrals is None:
        return unknown(part.name, "geometry", shape.reason, None)
    if part.density is None:
        return unknown(part.name, "geometry", "no density is stated for it", volume)
    if not (math.isfinite(part.density) and part.density > 0.0):
        return unknown(part.name, "geometry", f"its density is {part.density:.6g} kg/m³", volume)
    solid = shape.integrals
    return known(
        part.name,
        part.density * solid.volume,
        solid.volume,
        R_WP @ solid.centroid + p_WP,
        part.density * (R_WP @ solid.inertia @ R_WP.T),
        shape.bound,
        "geometry",
    )


def known(
    name: str, mass: float, volume: float | None, centre: Array, inertia: Array, bound: float, origin: str
) -> MassProperties:
    """Properties with their principal axes; inertia (3, 3) about the centre, world axes."""
    inertia = 0.5 * (inertia + inertia.T)
    moments, axes = principal(inertia)
    for array in (centre, inertia, moments, axes):
        array.setflags(write=False)
    return MassProperties(name, mass, volume, centre, inertia, moments, axes, bound, origin)


def unknown(name: str, origin: str, reason: str, volume: float | None) -> MassProperties:
    """Properties of something whose mass cannot be known, and why."""
    none3, none33 = np.full(3, np.nan), np.full((3, 3), np.nan)
    none3.setflags(write=False)
    none33.setflags(write=False)
    return MassProperties(name, None, volume, none3, none33, none3, none33, math.nan, origin, reason)
