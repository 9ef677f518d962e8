"""What names in findings and functions stand for: parts, and joints as kinform names them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from weakref import WeakKeyDictionary

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.function import joint_as_stated, resolve_joint
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint
from kinform.model.names import PartName


def subjects_of(design: Design, names: Iterable[str]) -> tuple[list[str], list[str]]:
    """The parts and the derived joints that names stand for: parts, groups, bodies, joints, intended joints."""
    parts: dict[str, None] = {}
    joints: dict[str, None] = {}
    assembly, kinematics, known = design.assembly, design.kinematics, _names(design)
    for name in names:
        if name in known.parts:
            parts.setdefault(name)
        elif name in known.groups or name in known.bodies:
            parts.update(dict.fromkeys(known.groups.get(name) or known.bodies[name]))
        elif name in known.derived:
            joints.setdefault(name)
        elif name in known.wanted and kinematics is not None:
            wanted = known.wanted
            first, second = (kinematics.body_of(assembly.parts_of(side)[0]).name for side in wanted[name].between)
            direct = [joint.name for joint in kinematics.joints_between(first, second)]
            joints.update(dict.fromkeys(direct))
            if not direct:
                parts.update(dict.fromkeys(p for side in wanted[name].between for p in assembly.parts_of(side)))
    return list(parts), list(joints)


@dataclass(frozen=True)
class _Names:
    """What there is in a design, by name."""

    parts: frozenset[str]
    groups: dict[str, tuple[PartName, ...]]
    bodies: dict[str, tuple[PartName, ...]]
    derived: dict[str, Joint]
    wanted: dict[str, IntendedJoint]


_KNOWN: WeakKeyDictionary[Design, _Names] = WeakKeyDictionary()
"""Of the designs that are looked at: one that is read as it is looked at keeps its file open as long as it is there."""


def _names(design: Design) -> _Names:
    """Looked up once for all that findings name."""
    known = _KNOWN.get(design)
    if known is None:
        known = _KNOWN[design] = _collected(design)
    return known


def _collected(design: Design) -> _Names:
    assembly, kinematics = design.assembly, design.kinematics
    bodies = () if kinematics is None else kinematics.bodies
    joints = () if kinematics is None else kinematics.joints
    return _Names(
        frozenset(part.name for part in assembly.parts),
        {group.name: group.parts for group in assembly.groups},
        {body.name: body.parts for body in bodies},
        {joint.name: joint for joint in joints},
        {joint.name: joint for joint in assembly.function.joints},
    )


def as_stated(design: Design, joint: Joint, names: Sequence[str]) -> Joint:
    """The joint in the order and sense of the first of the names that the designer gave to it."""
    if not names or design.kinematics is None:
        return joint
    return joint_as_stated(resolve_joint(design.assembly, design.kinematics, names[0])) or joint


def wanted_names(design: Design) -> dict[str, list[str]]:
    """Names that the designer gave to derived joints, by kinform's; those of sub-assemblies last."""
    names: dict[str, list[str]] = {}
    for joint in sorted(design.assembly.function.joints, key=lambda j: (j.name.count("/"), j.name)):
        for found in subjects_of(design, [joint.name])[1]:
            names.setdefault(found, []).append(joint.name)
    return names
