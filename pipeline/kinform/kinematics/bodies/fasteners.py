"""`[fasteners] infer`: suggestions applied, and every joint that follows from one labelled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.kinematics.bodies.merging import Merger
from kinform.kinematics.constants import SUGGESTED_AXIS
from kinform.kinematics.pair.joint import stated_joint
from kinform.kinematics.pair.lower_pairs import JointForm
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Suggestion
from kinform.model.kinematics import Body, Joint
from kinform.model.names import BodyName, PartName

INFERRED = "inferred: "
"""How the reason begins for which a suggestion made parts one body."""


def fasten(assembly: Assembly, contacts: Contacts, merger: Merger) -> bool:
    """Make one body of the parts that suggestions hold together, where the manifest asks for it; whether that
    changed anything.

    What contact holds already is left as it is. A joint that an assumption or the function states between two
    bodies outweighs a suggestion that would make them one.
    """
    if not assembly.infer_fasteners:
        return False
    stated = _stated_apart(assembly)
    changed = False
    fastening = [hint for hint in contacts.suggestions if hint.fastens]
    for hint in [hint for hint in fastening if merger.root(hint.parts[0]) != merger.root(hint.parts[1])]:
        ends = {merger.root(part) for part in hint.parts}
        if all({merger.root(first), merger.root(second)} != ends for first, second in stated):
            merger.fuse(*hint.parts, f"{INFERRED}{'~'.join(hint.parts)}: {hint.evidence}")
            changed = True
    return changed


def _stated_apart(assembly: Assembly) -> list[tuple[PartName, PartName]]:
    """Parts between whose bodies somebody states a joint that moves."""
    stated = [(a.between, a.type) for a in assembly.assumptions if a.type is not None]
    stated += [(joint.between, joint.type) for joint in assembly.function.joints]
    sides = [[assembly.parts_of(name)[0] for name in between] for between, type_ in stated if type_ != "fixed"]
    return [(first, second) for first, second in sides]


def turn_about_suggested_axes(
    assembly: Assembly, contacts: Contacts, joints: list[Joint], bodies: tuple[Body, ...]
) -> list[Joint]:
    """The joints, planar ones as revolute about the axis that rims or bolt circles suggest, where there is one."""
    if not assembly.infer_fasteners:
        return joints
    of_part: dict[PartName, BodyName] = {part: body.name for body in bodies for part in body.parts}
    hints: dict[tuple[BodyName, BodyName], list[Suggestion]] = {}
    for hint in contacts.suggestions:
        first, second = sorted(of_part[part] for part in hint.parts)
        if not hint.fastens and first != second:
            hints.setdefault((first, second), []).append(hint)
    return [_revolute(joint, hints.get(joint.bodies, [])) for joint in joints]


def _revolute(joint: Joint, hints: list[Suggestion]) -> Joint:
    if joint.type != "planar" or joint.status != "determined" or joint.axis is None or len(hints) != 1:
        return joint
    hint = hints[0]
    if abs(float(hint.axis @ joint.axis)) < np.cos(SUGGESTED_AXIS):
        return joint
    reason = f"planar by contact; {hint.evidence} suggest the axis, with {hint.confidence} confidence"
    revolute = stated_joint(joint.bodies, JointForm("revolute", joint.axis, hint.point), hint.kind, reason)
    evidence = (*joint.evidence, hint.kind)
    return replace(
        revolute, name=joint.name, evidence=evidence, patches=joint.patches, singular_values=joint.singular_values
    )


def label_inferred(joints: list[Joint], bodies: tuple[Body, ...]) -> list[Joint]:
    """Joints of bodies that a suggestion put together, as inferred, with the suggestion as evidence."""
    hints = {body.name: [r.removeprefix(INFERRED) for r in body.merged if r.startswith(INFERRED)] for body in bodies}
    return [_label(joint, [hint for name in joint.bodies for hint in hints.get(name, [])]) for joint in joints]


def _label(joint: Joint, hints: list[str]) -> Joint:
    if not hints:
        return joint
    status = "inferred" if joint.status == "determined" else joint.status
    reason = f"{joint.reason}; if, as suggested, these are one body: {'; '.join(hints)}"
    return replace(joint, status=status, evidence=(*joint.evidence, "fasteners"), reason=reason)
