"""Joints that are stated: by assumptions, and by the function for stick bodies."""

from __future__ import annotations

from collections.abc import Mapping

from kinform.kinematics.bodies.merging import Merger
from kinform.kinematics.pair.joint import stated_joint
from kinform.model.assembly import Assembly, Assumption
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint
from kinform.model.names import BodyName, PartName

__all__ = ["Pair", "intended_joint", "pair_between", "stated_joints", "stated_roots"]

Pair = tuple[BodyName, BodyName]


def pair_between(assembly: Assembly, of_part: Mapping[PartName, BodyName], between: tuple[str, str]) -> Pair | None:
    """Names of the bodies that two names stand for, sorted; None where they are one."""
    a, b = (of_part[assembly.parts_of(name)[0]] for name in between)
    return None if a == b else ((a, b) if a < b else (b, a))


def stated_joints(assembly: Assembly, of_part: Mapping[PartName, BodyName]) -> dict[Pair, Joint]:
    """Joints that assumptions state, and joints of stick bodies that the function states."""
    out: dict[Pair, Joint] = {}
    formless = set(of_part.values()) - {of_part[part.name] for part in assembly.parts if part.mesh is not None}
    for joint in assembly.function.joints:
        pair = pair_between(assembly, of_part, joint.between)
        if pair is not None and formless.intersection(pair):
            out[pair] = intended_joint(pair, joint, of_part[assembly.parts_of(joint.between[0])[0]])
    for assumption in assembly.assumptions:
        pair = pair_between(assembly, of_part, assumption.between)
        if pair is not None and assumption.type is not None and not assumption.ignore:
            out[pair] = _assumed(pair, assumption)
    return out


def stated_roots(assembly: Assembly, merger: Merger) -> set[frozenset[int]]:
    """Pairs of bodies for which an assumption states another joint than fixed: never fused."""
    out = set()
    for assumption in assembly.assumptions:
        if assumption.type not in (None, "fixed"):
            out.add(frozenset(merger.root(assembly.parts_of(n)[0]) for n in assumption.between))
    return out


def intended_joint(pair: Pair, joint: IntendedJoint, first: BodyName) -> Joint:
    """The joint as stated; `first` is the body on the designer's first side. A universal joint's first
    axis is fixed in its first body, so turning the bodies round exchanges its axes."""
    axis, axis2 = joint.axis, joint.axis2
    if joint.type == "universal" and first != pair[0]:
        axis, axis2 = axis2, axis
    return stated_joint(
        pair, joint.type, axis, joint.point, axis2, joint.pitch,
        evidence="function", reason=f"intended joint {joint.name}: one side has no geometry",
    )  # fmt: skip


def _assumed(pair: Pair, assumption: Assumption) -> Joint:
    assert assumption.type is not None
    return stated_joint(
        pair, assumption.type, assumption.axis, assumption.point, None, assumption.pitch,
        evidence="assumption", reason=f"assumed: {assumption.reason}",
    )  # fmt: skip
