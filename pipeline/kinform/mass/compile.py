"""Collects the mass properties of all parts and adds them up to those of bodies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from kinform.mass.parts import SolidShape, known, part_properties, unknown
from kinform.mass.principal import impossible
from kinform.model.assembly import Assembly, Mesh
from kinform.model.kinematics import Body, Kinematics
from kinform.model.mass import MassProperties, MassReport
from kinform.model.surfaces import MeshSurfaces

__all__ = ["compile_mass"]


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
    shapes: dict[str, SolidShape] = {}
    parts = []
    for part in assembly.parts:
        if known is not None and part.name in known:
            parts.append(known[part.name])
            continue
        shape = None
        if part.mesh is not None:
            shape = _shape(part.mesh, shapes, surfaces, assembly)
        parts.append(part_properties(part, shape))
    by_name = {properties.name: properties for properties in parts}
    bodies = tuple(
        _body_properties(body, [by_name[name] for name in body.parts])
        for body in sorted(kinematics.bodies, key=lambda body: body.name)
    )
    problems = [(p.name, p.reason) for p in parts if p.mass is None]
    valid = all(body.mass is not None for body in bodies)
    return MassReport(tuple(sorted(parts, key=lambda p: p.name)), bodies, valid, tuple(sorted(problems)))


def _shape(
    mesh: Mesh,
    shapes: dict[str, SolidShape],
    surfaces: dict[str, MeshSurfaces] | None,
    assembly: Assembly,
) -> SolidShape:
    """The shape of the mesh, from `shapes` when a part with the same mesh was seen before."""
    if mesh.digest not in shapes:
        recovered = None if surfaces is None else surfaces.get(mesh.digest)
        shapes[mesh.digest] = SolidShape(mesh, recovered, assembly.tolerances)
    return shapes[mesh.digest]


def _body_properties(body: Body, parts: list[MassProperties]) -> MassProperties:
    """Sum over the parts by the parallel axis theorem."""
    origin = "+".join(sorted({part.origin for part in parts}))
    volumes = [part.volume for part in parts]
    volume = None if None in volumes else math.fsum(v for v in volumes if v is not None)
    missing = [part.name for part in parts if part.mass is None]
    if missing or not parts:
        return unknown(body.name, origin, "no mass of " + ", ".join(missing), volume)
    if len(parts) == 1 and parts[0].mass is not None:
        wrong = impossible(parts[0].mass, parts[0].inertia)
        return unknown(body.name, origin, wrong, volume) if wrong else replace(parts[0], name=body.name)
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
        return unknown(body.name, origin, wrong, volume)
    bound = float(masses @ [part.mass_bound for part in parts]) / mass
    return known(body.name, mass, volume, centres[0] + mean, inertia, bound, origin)
