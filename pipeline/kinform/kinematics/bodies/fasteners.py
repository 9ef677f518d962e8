"""`[fasteners] infer`: suggestions applied, and every joint that follows from one labelled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.kinematics.bodies.merging import Merger
from kinform.kinematics.pair.joint import stated_joint
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Suggestion
from kinform.model.kinematics import Body, Joint
from kinform.model.names import BodyName, PartName

__all__ = ["INFERRED", "about_axes", "fasten", "labelled"]

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
    suggested = [hint for hint in contacts.suggestions if hint.fastens]
    wanted = [hint for hint in suggested if merger.root(hint.parts[0]) != merger.root(hint.parts[1])]
    for hint in wanted:
        ends = {merger.root(part) for part in hint.parts}
        if any({merger.root(first), merger.root(second)} == ends for first, second in stated):
            continue
        names = "~".join(hint.parts)
        merger.fuse(hint.parts[0], hint.parts[1], f"{INFERRED}{names}: {hint.evidence}")
        changed = True
    return changed


def _stated_apart(assembly: Assembly) -> list[tuple[PartName, PartName]]:
    """Parts between whose bodies somebody states a joint that moves."""
    stated = [(a.between, a.type) for a in assembly.assumptions if a.type is not None]
    stated += [(joint.between, joint.type) for joint in assembly.function.joints]
    sides = [[assembly.parts_of(name)[0] for name in between] for between, type_ in stated if type_ != "fixed"]
    return [(first, second) for first, second in sides]


def about_axes(assembly: Assembly, contacts: Contacts, joints: list[Joint], bodies: tuple[Body, ...]) -> list[Joint]:
    """Planar joints turned into revolute ones about the axis that rims or bolt circles suggest."""
    if not assembly.infer_fasteners:
        return joints
    of_part: dict[PartName, BodyName] = {part: body.name for body in bodies for part in body.parts}
    hints: dict[tuple[BodyName, BodyName], list[Suggestion]] = {}
    for hint in contacts.suggestions:
        first, second = sorted(of_part[part] for part in hint.parts)
        if not hint.fastens and first != second:
            hints.setdefault((first, second), []).append(hint)
    return [_about(joint, hints.get(joint.bodies, [])) for joint in joints]


def _about(joint: Joint, hints: list[Suggestion]) -> Joint:
    if joint.type != "planar" or joint.status != "determined" or joint.axis is None or len(hints) != 1:
        return joint
    hint = hints[0]
    if abs(float(hint.axis @ joint.axis)) < np.cos(1e-3):
        return joint
    turned = stated_joint(
        joint.bodies, "revolute", joint.axis, hint.point, None, None,
        evidence=hint.kind, reason=f"planar by contact; {hint.evidence} suggest the axis, with {hint.confidence} confidence",
    )  # fmt: skip
    return replace(
        turned,
        name=joint.name,
        evidence=(*joint.evidence, hint.kind),
        patches=joint.patches,
        singular_values=joint.singular_values,
    )


def labelled(joints: list[Joint], bodies: tuple[Body, ...]) -> list[Joint]:
    """Joints of bodies that a suggestion put together, as inferred, with the suggestion as evidence."""
    guessed = {
        body.name: found
        for body in bodies
        if (found := [r.removeprefix(INFERRED) for r in body.merged if r.startswith(INFERRED)])
    }
    return [_label(joint, [hint for name in joint.bodies for hint in guessed.get(name, [])]) for joint in joints]


def _label(joint: Joint, hints: list[str]) -> Joint:
    if not hints:
        return joint
    status = "inferred" if joint.status == "determined" else joint.status
    reason = f"{joint.reason}; if, as suggested, these are one body: {'; '.join(hints)}"
    return replace(joint, status=status, evidence=(*joint.evidence, "fasteners"), reason=reason)
