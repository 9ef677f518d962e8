"""Where a finding is: in space and in the manifest, as far as its rule left that open and its subject tells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.consistency.context import Context
from kinform.consistency.rule import Declared
from kinform.function import resolve_joint
from kinform.model.assembly import Part
from kinform.model.findings import Finding
from kinform.model.kinematics import Joint
from kinform.requirements.answer import triple


def with_place(context: Context, finding: Finding) -> Finding:
    """The finding with a place, where its subject is a part, body or joint, and with file and line of the manifest."""
    joint = _joint(context, finding.subject)
    place = finding.place
    if place is None:
        place = context.place_of(joint) if joint is not None else _middle(_parts(context, finding.subject))
    if finding.file is not None:
        return replace(finding, place=place)
    declared = _declared(context, finding.subject, joint)
    return replace(finding, place=place, file=declared.file, line=finding.line or declared.line)


def _joint(context: Context, subject: Sequence[str]) -> Joint | None:
    """The first joint of the subject, by the name that kinform or the designer gave it."""
    if context.lacks("kinematics"):
        return None
    stated = {joint.name for joint in context.function.joints}
    for name in subject:
        joint = context.joint(name)
        if joint is None and name in stated:
            joint = resolve_joint(context.assembly, context.kinematics, name).joint
        if joint is not None:
            return joint
    return None


def _parts(context: Context, subject: Sequence[str]) -> list[Part]:
    """The parts that the subject names, and the first of each body or group that it names."""
    parts = (_part(context, name) for name in subject)
    return [part for part in parts if part is not None]


def _part(context: Context, name: str) -> Part | None:
    """The part of that name, else the first of the body or group of that name."""
    part = context.assembly.named_parts.get(name)
    if part is not None:
        return part
    kinematics, group = context.design.kinematics, context.assembly.named_groups.get(name)
    whole = None if kinematics is None else kinematics.named_bodies.get(name)
    parts = whole.parts if whole is not None else () if group is None else group.parts
    return context.assembly.part(min(parts)) if parts else None


def _middle(parts: Sequence[Part]) -> tuple[float, float, float] | None:
    """The middle of the first part's mesh, else its position (m, world)."""
    if not parts:
        return None
    part = parts[0]
    at = np.zeros(3)
    if part.mesh is not None and len(part.mesh.vertices):
        low, high = part.mesh.bare.box
        at = 0.5 * (low + high)
    return triple(part.X_WP[:3, :3] @ at + part.X_WP[:3, 3])


def _declared(context: Context, subject: Sequence[str], joint: Joint | None) -> Declared:
    """Where the manifest speaks of the subject: the intended joint, a part of the joint, a part; else the assembly."""
    if joint is not None:
        for intended in context.function.joints:
            if resolve_joint(context.assembly, context.kinematics, intended.name).joint is joint:
                return intended
        second = context.kinematics.named_bodies[joint.bodies[1]]
        return context.assembly.part(second.parts[0]).source
    parts = _parts(context, subject)
    return parts[0].source if parts else context.assembly.source
