"""What names in findings and functions stand for: parts, and joints as kinform names them."""

from __future__ import annotations

from collections.abc import Iterable

from kinform.design import Design
from kinform.model.names import PartName


def subjects_of(design: Design, names: Iterable[str]) -> tuple[list[str], list[str]]:
    """The parts and the derived joints that names stand for: parts, groups, bodies, joints, intended joints."""
    parts: dict[str, None] = {}
    joints: dict[str, None] = {}
    assembly, kinematics = design.assembly, design.kinematics
    names_of_parts = {part.name for part in assembly.parts}
    groups = {group.name: group.parts for group in assembly.groups}
    bodies: dict[str, tuple[PartName, ...]] = {}
    if kinematics is not None:
        bodies.update((body.name, body.parts) for body in kinematics.bodies)
    derived = {} if kinematics is None else {joint.name: joint for joint in kinematics.joints}
    wanted = {joint.name: joint for joint in assembly.function.joints}
    for name in names:
        if name in names_of_parts:
            parts.setdefault(name)
        elif name in groups or name in bodies:
            parts.update(dict.fromkeys(groups.get(name) or bodies[name]))
        elif name in derived:
            joints.setdefault(name)
        elif name in wanted and kinematics is not None:
            ends = {kinematics.body_of(assembly.parts_of(side)[0]).name for side in wanted[name].between}
            direct = [joint.name for joint in derived.values() if set(joint.bodies) == ends]
            joints.update(dict.fromkeys(direct))
            if not direct:
                parts.update(dict.fromkeys(p for side in wanted[name].between for p in assembly.parts_of(side)))
    return list(parts), list(joints)


def wanted_names(design: Design) -> dict[str, list[str]]:
    """Names that the designer gave to derived joints, by kinform's; those of sub-assemblies last."""
    names: dict[str, list[str]] = {}
    for joint in sorted(design.assembly.function.joints, key=lambda j: (j.name.count("/"), j.name)):
        for found in subjects_of(design, [joint.name])[1]:
            names.setdefault(found, []).append(joint.name)
    return names
