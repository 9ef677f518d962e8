"""Joints that a function which states all of them leaves out: contact that alone would separate a body.

Where the function states all joints, contact that none of them moves is rigid, and so is what it states as fixed. That
also locks a joint that was forgotten, or stated as fixed by mistake. So the contact inside each body is searched for
joints as if there were no function (`proposals`). Parts of one group or assumption stay one. Contact on the axis of a
stated joint is another question, which side it belongs to, and is reported elsewhere (`Placed.unclear`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.kinematics.joints.bodies.extents import Extents
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.partition.constants import SAME_AXIS
from kinform.kinematics.partition.proposals import Proposal, propose
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Body, UndeclaredJoint
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces


def undeclared_joints(
    assembly: Assembly, surfaces: Mapping[str, MeshSurfaces], contacts: Contacts, bodies: Sequence[Body]
) -> tuple[UndeclaredJoint, ...]:
    """The joints that contact proposes inside the bodies, which follow from the function; the largest smaller side
    first."""
    body_of = {part: body for body in bodies for part in body.parts}
    inside = tuple(patch for patch in contacts.patches if body_of[patch.parts[0]] is body_of[patch.parts[1]])
    moving = tuple(joint for joint in assembly.function.joints if joint.type != "fixed")
    merger = Merger(replace(assembly, function=replace(assembly.function, joints=moving)))
    together: dict[int, list[PartName]] = {}
    for part in assembly.parts:
        together.setdefault(merger.root(part.name), []).append(part.name)
    found = propose(assembly, surfaces, replace(contacts, patches=inside), tuple(together.values()))
    extents = Extents(assembly)
    out = []
    for one in found:
        body = body_of[one.sides[0][0]]
        near = assembly.tolerances.offset_limit(extents.diagonal(body.parts))
        stated = (j for j in moving if body in {body_of[assembly.parts_of(name)[0]] for name in j.between})
        if not any(_same(one, joint, near) for joint in stated):
            sides = tuple(tuple(sorted(side)) for side in one.sides)
            out.append(UndeclaredJoint(body.name, one.type, one.axis, one.point, sides[0], sides[1], one.words))
    return tuple(out)


def _same(one: Proposal, joint: IntendedJoint, near: float) -> bool:
    """Whether a proposal lies on the axis, or at the centre, of a joint that is stated, to `near` (m); of a slide,
    which has no place, along it."""
    if one.axis is None or joint.axis is None:
        return joint.point is None or _off(one, joint) <= near
    if abs(float(one.axis @ joint.axis)) < np.cos(SAME_AXIS) * norm(joint.axis):
        return False
    return joint.point is None or _off(one, joint) <= near


def _off(one: Proposal, joint: IntendedJoint) -> float:
    """m from the joint's place to the proposal's axis, or to its centre."""
    assert joint.point is not None
    apart = joint.point - one.point
    axis = joint.axis if one.axis is None else one.axis
    return norm(apart) if axis is None else norm(apart - (apart @ axis) / float(axis @ axis) * axis)
