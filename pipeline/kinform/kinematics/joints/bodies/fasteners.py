"""`[fasteners] infer`: suggestions applied, and every joint that follows from one labelled."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.graphs.graph import UnionFind
from kinform.kinematics.constants import SAME_DIRECTION
from kinform.kinematics.joints.bodies.kept_apart import contradicted, kept_apart
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.joints.pair.joint import stated_joint
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Suggestion
from kinform.model.kinematics import Body, Joint, body_of_part
from kinform.model.names import BodyName, PartName

INFERRED = "inferred: "
"""How the reason begins for which a suggestion made parts one body."""


def fastenings(assembly: Assembly, contacts: Contacts, merger: Merger) -> list[Suggestion]:
    """The suggestions that make parts one body, where the manifest asks for it: all but those that would join what it
    keeps apart. `merger` knows what contact has joined without them."""
    if not assembly.infer_fasteners:
        return []
    hints = [hint for hint in contacts.suggestions if hint.fastens]
    refused = contradicted(hints, kept_apart(assembly), merger.root)
    return [hint for index, hint in enumerate(hints) if index not in refused]


def fasten(hints: Sequence[Suggestion], merger: Merger) -> bool:
    """Make one body of the parts that these suggestions hold together; whether that changed anything. What is one body
    already is left as it is."""
    changed = False
    for hint in [hint for hint in hints if merger.root(hint.parts[0]) != merger.root(hint.parts[1])]:
        merger.fuse(*hint.parts, f"{INFERRED}{'~'.join(hint.parts)}: {hint.evidence}")
        changed = True
    return changed


def harmless(hints: Sequence[Suggestion], assembly: Assembly, before: Merger, after: Merger) -> list[Suggestion]:
    """Those of the suggestions, all of which were applied between `before` and `after`, from which nothing followed
    that contact then held together although the manifest keeps it apart."""
    joined = {
        after.root(first)
        for first, second in (apart.parts for apart in kept_apart(assembly))
        if before.root(first) != before.root(second) and after.root(first) == after.root(second)
    }

    def led_there(first: PartName, second: PartName) -> bool:
        return before.root(first) != before.root(second) and after.root(first) in joined

    return [hint for hint in hints if not led_there(*hint.parts)]


def turn_about_suggested_axes(
    assembly: Assembly, contacts: Contacts, joints: list[Joint], bodies: tuple[Body, ...]
) -> list[Joint]:
    """The joints, planar ones as revolute about the axis that rims or bolt circles suggest, where there is one, and
    where nothing else is stated of the two bodies."""
    if not assembly.infer_fasteners:
        return joints
    of_part: dict[PartName, BodyName] = body_of_part(bodies)
    hints: dict[tuple[BodyName, BodyName], list[Suggestion]] = {}
    for hint in contacts.suggestions:
        first, second = sorted(of_part[part] for part in hint.parts)
        if hint.kind in ("rim", "bolt circle") and first != second:
            hints.setdefault((first, second), []).append(hint)
    settled = _stated_otherwise(assembly, of_part)
    return [joint if settled(joint) else _revolute(joint, hints.get(joint.bodies, [])) for joint in joints]


def _stated_otherwise(assembly: Assembly, of_part: Mapping[PartName, BodyName]) -> Callable[[Joint], bool]:
    """Whether something else than a turn is stated between the bodies of a joint: another joint, or that they are one
    body, if need be by way of others."""
    stated: list[tuple[tuple[str, str], str]] = [(joint.between, joint.type) for joint in assembly.function.joints]
    stated += [(assumption.between, assumption.type or "") for assumption in assembly.assumptions]
    names = sorted(set(of_part.values()))
    index = {name: number for number, name in enumerate(names)}
    whole, others = UnionFind(len(names)), set()
    for between, kind in stated:
        first, second = (index[of_part[assembly.parts_of(name)[0]]] for name in between)
        if kind == "fixed":
            whole.union(first, second)
        elif kind not in ("revolute", ""):
            others.add(frozenset((first, second)))

    def settled(joint: Joint) -> bool:
        first, second = (index[name] for name in joint.bodies)
        return whole.find(first) == whole.find(second) or frozenset((first, second)) in others

    return settled


def _revolute(joint: Joint, hints: list[Suggestion]) -> Joint:
    if joint.type != "planar" or joint.status != "determined" or joint.axis is None or len(hints) != 1:
        return joint
    hint = hints[0]
    if abs(float(hint.axis @ joint.axis)) < np.cos(SAME_DIRECTION):
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
