"""Mass properties of parts and bodies: as the user states them, else from geometry and density, else why not."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.meshes.shell_faults import shell_faults
from kinform.foundation.rounding import ARITHMETIC
from kinform.mass.principal import impossible, principal
from kinform.mass.solids import SolidIntegrals, integrate_solid, mass_bound
from kinform.model.arrays import Array, freeze
from kinform.model.assembly import Assembly, Group, Mesh, MeshHealth, Part
from kinform.model.kinematics import Body, Kinematics
from kinform.model.mass import MassProperties, MassReport
from kinform.model.surfaces import MeshSurfaces
from kinform.model.tolerances import Tolerances


def compile_mass(
    assembly: Assembly,
    kinematics: Kinematics,
    surfaces: dict[str, MeshSurfaces] | None = None,
    known: Mapping[str, MassProperties] | None = None,
) -> MassReport:
    """Mass, centre of mass and inertia of every part and body, world frame, SI.

    `surfaces` (by mesh digest) sharpen the bound of the tessellation's error. A mesh that is not
    watertight, is wound inconsistently or has no density has no mass, and neither has a body that
    contains it: the reasons are in `problems`. Parts whose properties are `known` are not measured again.
    """
    parts = masses_of_parts(assembly, surfaces, known)
    by_name = {properties.name: properties for properties in parts}
    stated = {group.name: group for group in assembly.groups if group.override is not None}
    frames = _frames(assembly)
    bodies = tuple(
        _body_properties(body, _weights(body.parts, by_name, stated, frames))
        for body in sorted(kinematics.bodies, key=lambda body: body.name)
    )
    problems = [(p.name, p.reason) for p in parts if p.mass is None and p.name not in assembly.weighed]
    valid = all(body.mass is not None for body in bodies)
    return MassReport(tuple(sorted(parts, key=lambda p: p.name)), bodies, valid, tuple(sorted(problems)))


def masses_of_parts(
    assembly: Assembly,
    surfaces: Mapping[str, MeshSurfaces] | None = None,
    known: Mapping[str, MassProperties] | None = None,
) -> list[MassProperties]:
    """Mass, centre of mass and inertia of every part, in the order of the parts, as `compile_mass` gives them."""
    shapes: dict[str, _SolidShape] = {}
    parts = []
    for part in assembly.parts:
        if known is not None and part.name in known:
            parts.append(known[part.name])
            continue
        shape = None
        if part.mesh is not None:
            shape = _shape(part.mesh, shapes, surfaces, assembly)
        parts.append(_part_properties(part, shape))
    return parts


def _frames(assembly: Assembly) -> frozenset[str]:
    """Stick parts without stated mass in a complete function: frames, which weigh nothing beside other parts."""
    if not assembly.function.complete:
        return frozenset()
    return frozenset(part.name for part in assembly.parts if part.mesh is None and part.override is None)


def weighed_together(assembly: Assembly, report: MassReport, parts: Sequence[str]) -> list[MassProperties]:
    """What these parts weigh together is the sum of: groups of them with a stated mass, and parts that are in none."""
    stated = {group.name: group for group in assembly.groups if group.override is not None}
    return _weights(parts, {part.name: part for part in report.parts}, stated, _frames(assembly))


def _weights(
    names: Sequence[str], parts: Mapping[str, MassProperties], stated: Mapping[str, Group], frames: frozenset[str]
) -> list[MassProperties]:
    """What parts weigh is the sum of: groups with a stated mass, and parts that are in none of them."""
    inside = set(names)
    groups = [group for _, group in sorted(stated.items()) if inside.issuperset(group.parts)]
    taken = {name for group in groups for name in group.parts}
    volumes = {group.name: [parts[name].volume for name in group.parts] for group in groups}
    whole = [_group_properties(group, volumes[group.name]) for group in groups]
    left = [name for name in names if name not in taken]
    heavy = [name for name in left if name not in frames]
    return whole + [parts[name] for name in (heavy if whole or heavy else left)]


def _group_properties(group: Group, volumes: Sequence[float | None]) -> MassProperties:
    """The mass that is stated for a group, in the world."""
    stated = group.override
    assert stated is not None
    volume = None if None in volumes else math.fsum(v for v in volumes if v is not None)
    wrong = impossible(stated.mass, stated.inertia)
    if wrong:
        return _without_mass(group.name, "override", f"the stated values are impossible: {wrong}", volume)
    return _with_mass(group.name, stated.mass, volume, stated.centre_of_mass, stated.inertia, 0.0, "override")


def _shape(
    mesh: Mesh,
    shapes: dict[str, _SolidShape],
    surfaces: Mapping[str, MeshSurfaces] | None,
    assembly: Assembly,
) -> _SolidShape:
    """The shape of the mesh, from `shapes` when a part with the same mesh was seen before."""
    if mesh.digest not in shapes:
        recovered = None if surfaces is None else surfaces.get(mesh.digest)
        shapes[mesh.digest] = _SolidShape(mesh, recovered, assembly.tolerances)
    return shapes[mesh.digest]


def _body_properties(body: Body, parts: list[MassProperties]) -> MassProperties:
    """Sum over the parts by the parallel axis theorem."""
    origin = "+".join(sorted({part.origin for part in parts}))
    volumes = [part.volume for part in parts]
    volume = None if None in volumes else math.fsum(v for v in volumes if v is not None)
    missing = [part.name for part in parts if part.mass is None]
    if missing or not parts:
        return _without_mass(body.name, origin, "no mass of " + ", ".join(missing), volume)
    if len(parts) == 1 and parts[0].mass is not None:
        wrong = impossible(parts[0].mass, parts[0].inertia)
        return _without_mass(body.name, origin, wrong, volume) if wrong else replace(parts[0], name=body.name)
    masses = np.array([part.mass for part in parts], dtype=np.float64)
    mass = math.fsum(masses)
    centres = np.array([part.centre_of_mass for part in parts])
    # Offsets from one of the centres: far from the origin the mean would lose digits.
    offsets = centres - centres[0]
    mean = masses @ offsets / mass
    inertia = np.zeros((3, 3))
    for part, share, offset in zip(parts, masses, offsets - mean, strict=True):
        inertia += part.inertia + share * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    wrong = impossible(mass, inertia)
    if wrong:
        return _without_mass(body.name, origin, wrong, volume)
    bound = float(masses @ [part.mass_bound for part in parts]) / mass
    return _with_mass(body.name, mass, volume, centres[0] + mean, inertia, bound, origin)


class _SolidShape:
    """What one mesh gives to every part that uses it: its integrals, or the reason why it has none."""

    def __init__(self, mesh: Mesh, surfaces: MeshSurfaces | None, tolerances: Tolerances):
        self.integrals: SolidIntegrals | None = None
        self.bound = math.nan
        self.reason = _not_a_solid(mesh.health)
        if self.reason:
            return
        integrals = integrate_solid(mesh.vertices, mesh.faces)
        flat = ARITHMETIC * mesh.diagonal**3
        if abs(integrals.volume) <= flat:
            self.reason = "the mesh encloses no volume"
        elif integrals.volume < 0.0:
            self.reason = "the mesh is inside out: its facets enclose a negative volume"
        else:
            faults = shell_faults(mesh)
            if faults.inverted:
                self.reason = f"{faults.inverted} of the {mesh.health.shells} shells of the mesh are inside out"
                return
            self.integrals = integrals
            self.bound = mass_bound(mesh, integrals.volume, surfaces, tolerances) + faults.doubtful / integrals.volume


def _not_a_solid(health: MeshHealth) -> str:
    """Why the mesh bounds no solid; "" when it does."""
    if health.facets == 0:
        return "the mesh has no facets"
    if not health.watertight:
        return f"the mesh is not watertight ({health.open_edges} open and {health.overused_edges} overused edges)"
    if not health.consistent_winding:
        return "the facets of the mesh are wound inconsistently"
    return ""


def _part_properties(part: Part, shape: _SolidShape | None) -> MassProperties:
    """Mass properties of a part in the world, at the pose of the meshes."""
    volume = shape.integrals.volume if shape is not None and shape.integrals is not None else None
    R_WP, p_WP = part.X_WP[:3, :3], part.X_WP[:3, 3]
    if part.override is not None:
        stated = part.override
        wrong = impossible(stated.mass, stated.inertia)
        if not wrong and not np.all(np.isfinite(stated.centre_of_mass)):
            wrong = "the centre of mass is not a number"
        if wrong:
            return _without_mass(part.name, "override", f"the stated values are impossible: {wrong}", volume)
        centre = R_WP @ stated.centre_of_mass + p_WP
        return _with_mass(part.name, stated.mass, volume, centre, R_WP @ stated.inertia @ R_WP.T, 0.0, "override")
    if shape is None:
        return _without_mass(part.name, "stick", "it has no mesh and no mass is stated", None)
    if not part.solid:
        return _without_mass(part.name, "geometry", "it is not solid: its surfaces bound no volume", None)
    if shape.integrals is None:
        return _without_mass(part.name, "geometry", shape.reason, None)
    if part.density is None:
        return _without_mass(part.name, "geometry", "no density is stated for it", volume)
    if not (math.isfinite(part.density) and part.density > 0.0):
        return _without_mass(part.name, "geometry", f"its density is {part.density:.6g} kg/m³", volume)
    solid = shape.integrals
    return _with_mass(
        part.name,
        part.density * solid.volume,
        solid.volume,
        R_WP @ solid.centroid + p_WP,
        part.density * (R_WP @ solid.inertia @ R_WP.T),
        shape.bound,
        "geometry",
    )


def _with_mass(
    name: str, mass: float, volume: float | None, centre: Array, inertia: Array, bound: float, origin: str
) -> MassProperties:
    """Properties with their principal axes; inertia (3, 3) about the centre, world axes."""
    inertia = 0.5 * (inertia + inertia.T)
    moments, axes = principal(inertia)
    for array in (centre, inertia, moments, axes):
        freeze(array)
    return MassProperties(name, mass, volume, centre, inertia, moments, axes, bound, origin)


def _without_mass(name: str, origin: str, reason: str, volume: float | None) -> MassProperties:
    """Properties of something whose mass cannot be known, and why."""
    none3, none33 = freeze(np.full(3, np.nan)), freeze(np.full((3, 3), np.nan))
    return MassProperties(name, None, volume, none3, none33, none3, none33, math.nan, origin, reason)
