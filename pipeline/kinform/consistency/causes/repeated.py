"""The same shapes again and again: findings of one rule about parts that are copies."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from kinform.consistency.context import Context
from kinform.model.findings import SEVERITIES, Finding

RULES = frozenset("KF201 KF202 KF204 KF206 KF209 KF210 KF406 KF407 KF901".split())
"""Rules about contact, whose findings follow from the shapes of two parts and how they lie. What is stated of joints is
stated of each."""
LEAST = 2
"""Pairs of parts that are one cause."""


class Shapes:
    """Which parts of a design are copies of each other, whether a file or a pose says so."""

    def __init__(self, context: Context):
        self._context = context

    @cached_property
    def _of_part(self) -> dict[str, str]:
        """By name the digest of the first mesh of the shape."""
        from kinform.surfaces import rigid_copies

        meshes = {part.mesh.digest: part.mesh for part in self._context.assembly.parts if part.mesh is not None}
        copies = rigid_copies(meshes)
        first = {digest: copies[digest].of if digest in copies else digest for digest in meshes}
        parts = self._context.assembly.parts
        return {part.name: first[part.mesh.digest] for part in parts if part.mesh is not None}

    @cached_property
    def _of_body(self) -> dict[str, str]:
        """By name the shapes of the parts of a body."""
        kinematics = self._context.design.kinematics
        bodies = () if kinematics is None else kinematics.bodies
        return {
            body.name: " ".join(sorted(self._of_part.get(part, str(part)) for part in body.parts)) for body in bodies
        }

    def of(self, finding: Finding) -> tuple[str, ...]:
        """The shapes that a finding is about; empty where it is about anything else."""
        found: list[str] = []
        kinematics = self._context.design.kinematics
        for name in finding.subject:
            joint = None if kinematics is None else kinematics.named_joints.get(name)
            if name in self._of_part:
                found.append(self._of_part[name])
            elif joint is not None:
                found += [self._of_body[body] for body in joint.bodies]
            elif name in self._of_body:
                found.append(self._of_body[name])
            else:
                return ()
        return tuple(sorted(found))

    def bodies(self, findings: Sequence[Finding]) -> frozenset[frozenset[str]]:
        """The bodies that each of some findings is about, or its parts where they are one body."""
        kinematics = self._context.design.kinematics
        of_part = {} if kinematics is None else {str(p): str(b.name) for b in kinematics.bodies for p in b.parts}
        out = set()
        for finding in findings:
            joints = [] if kinematics is None else [kinematics.named_joints.get(name) for name in finding.subject]
            names = [name for joint in joints if joint is not None for name in joint.bodies]
            about = frozenset(map(str, names)) or frozenset(of_part.get(name, name) for name in finding.subject)
            out.add(about if len(about) > 1 else frozenset(finding.subject))
        return frozenset(out)


def repeated(context: Context, findings: Sequence[Finding]) -> list[tuple[Finding, ...]]:
    """Findings of one rule and severity about the same shapes, where there are several, in their order; with those of
    other rules about the same bodies."""
    candidates = [finding for finding in findings if finding.code in RULES]
    if len(candidates) < LEAST:
        return []
    shapes = Shapes(context)
    groups: dict[tuple[object, ...], list[Finding]] = {}
    for finding in candidates:
        of = shapes.of(finding)
        if of:
            groups.setdefault((finding.code, finding.severity, of), []).append(finding)
    several = [group for group in groups.values() if len({finding.subject for finding in group}) >= LEAST]
    # the worst first: what else is found of the same bodies is found with it
    several.sort(key=lambda group: -SEVERITIES.index(group[0].severity))
    out: list[tuple[frozenset[frozenset[str]], list[Finding]]] = []
    for group in several:
        about = shapes.bodies(group)
        alike = next((members for known, members in out if known <= about or about <= known), None)
        if alike is None:
            out.append((about, group))
        else:
            alike += group
    return [tuple(members) for _, members in out]
