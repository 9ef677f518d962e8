"""Joints that are stated: by assumptions, and by the function for stick bodies."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.joints.pair.joint import stated_joint, twists_of
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Joint
from kinform.model.names import BodyName, PartName

Pair = tuple[BodyName, BodyName]
"""Two bodies, sorted by name."""


def pair_between(assembly: Assembly, of_part: Mapping[PartName, BodyName], between: tuple[str, str]) -> Pair | None:
    """Names of the bodies that two names stand for, sorted; None where they are one."""
    a, b = (of_part[assembly.parts_of(name)[0]] for name in between)
    return None if a == b else ((a, b) if a < b else (b, a))


def joint_form(assembly: Assembly, of_part: Mapping[PartName, BodyName], joint: IntendedJoint, pair: Pair) -> JointForm:
    """The form of an intended joint between the bodies of a pair.

    A universal joint's first axis is fixed in its first body: where the designer's first side is the pair's second
    body, its axes are exchanged.
    """
    axis, axis2 = joint.axis, joint.axis2
    if joint.type == "universal" and of_part[assembly.parts_of(joint.between[0])[0]] != pair[0]:
        axis, axis2 = axis2, axis
    return JointForm(joint.type, axis, joint.point, joint.pitch, axis2)


def joint_twists(joint: IntendedJoint) -> Array | None:
    """(k, 6) motions of an intended joint (ω; v at the world's origin); None where it does not say where they are.

    A slide needs no point, nor does a planar joint: its turn is then about the world's origin.
    """
    axis, axis2, point = joint.axis, joint.axis2, joint.point
    if joint.type in ("prismatic", "planar") and point is None:
        point = np.zeros(3)
    if joint.type == "fixed":
        return twists_of("fixed", None, None)
    if point is None or (axis is None and joint.type != "spherical"):
        return None
    if (joint.type == "screw" and joint.pitch is None) or (joint.type == "universal" and axis2 is None):
        return None
    unit, unit2 = (None if one is None else one / norm(one) for one in (axis, axis2))
    return twists_of(joint.type, unit, point, joint.pitch, unit2)


def intended_joints(
    assembly: Assembly, of_part: Mapping[PartName, BodyName], beside: Collection[BodyName] | None = None
) -> dict[Pair, Joint]:
    """Joints as the function states them; only those of the bodies `beside` where these are given."""
    out: dict[Pair, Joint] = {}
    for joint in assembly.function.joints:
        pair = pair_between(assembly, of_part, joint.between)
        if pair is None or (beside is not None and not set(pair) & set(beside)):
            continue
        form = joint_form(assembly, of_part, joint, pair)
        out[pair] = stated_joint(pair, form, "function", f"intended joint {joint.name}: one side has no geometry")
    return out


def stated_joints(assembly: Assembly, of_part: Mapping[PartName, BodyName]) -> dict[Pair, Joint]:
    """Joints that assumptions state, and joints of stick bodies that the function states."""
    sticks = set(of_part.values()) - {of_part[part.name] for part in assembly.parts if part.mesh is not None}
    out = intended_joints(assembly, of_part, sticks)
    for assumption in assembly.assumptions:
        pair = pair_between(assembly, of_part, assumption.between)
        if pair is not None and assumption.type is not None and not assumption.ignore:
            form = JointForm(assumption.type, assumption.axis, assumption.point, assumption.pitch)
            out[pair] = stated_joint(pair, form, "assumption", f"assumed: {assumption.reason}")
    return out


def stated_roots(assembly: Assembly, merger: Merger) -> set[frozenset[int]]:
    """Pairs of bodies for which an assumption states another joint than fixed: never fused."""
    return {
        frozenset(merger.root(assembly.parts_of(name)[0]) for name in assumption.between)
        for assumption in assembly.assumptions
        if assumption.type not in (None, "fixed")
    }
