"""Joints whose motions finite steps prove to be blocked, and where that says nothing of the joint.

In robot descriptions the output of an actuator is often one mesh with its housing, and what is fastened to the output
is then in contact with the parent link: screws in a bolt circle, a spline, a horn in its pocket. What blocks a joint
within the radius of such a hub is how it is attached, and no stop of the joint.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from functools import cached_property

import numpy as np

from kinform.consistency.questions.finite_step import FiniteSteps, Step, StepWitness, closing_speeds
from kinform.foundation.algebra.vectors import cross, norm, perpendicular
from kinform.foundation.graphs.graph import UnionFind
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Source
from kinform.model.contacts import Contacts
from kinform.model.function import IntendedJoint
from kinform.model.surfaces import MeshSurfaces

HUB_KINDS = ("cylinder", "cone", "torus", "revolution")
"""Round surfaces about the axis of a joint that a hub may have."""
HUB_GAP = math.radians(190.0)
"""Greatest angle about the axis without a contact that blocks, of contacts that go round it: two screws opposite each
other leave 180°, and their samples somewhat more or less."""
HUB_SHARE = 0.25
"""Greatest radius of such a bolt circle, in diagonals of the smaller body: those of 60 mm arms with four screws in a
circle of 20 mm are at 0.17. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Blocked:
    """Motions of one joint, of which the first that is blocked in both senses is a witness."""

    witness: StepWitness | None
    """None: none is proven to be blocked."""
    at_hub: bool = False
    """Whether one is blocked by what is at the hub of a described actuator."""
    nearest: StepWitness | None = None
    """Where none is blocked: a motion that is so in one sense, if any, else the first that was tried."""


class BlockedJoints:
    """Of one assembly; worked out where it is asked for."""

    def __init__(self, assembly: Assembly, surfaces: dict[str, MeshSurfaces], contacts: Contacts):
        self.assembly, self.surfaces, self.contacts = assembly, surfaces, contacts

    @cached_property
    def steps(self) -> FiniteSteps:
        """Steps of motions."""
        return FiniteSteps(self.assembly, self.surfaces, self.contacts)

    def of(
        self,
        first: Collection[str],
        second: Collection[str],
        motions: Array,
        between: Collection[str] = (),
        intended: IntendedJoint | None = None,
    ) -> Blocked:
        """Whether one of some motions (k, 6) of the second body relative to the first is blocked in both senses, by
        their parts and those `between`; `intended` is the joint that states them."""
        tried = []
        for motion in motions:
            witness, hub = self.steps.witness(first, second, _unit(motion), between), frozenset[tuple[str, str]]()
            while witness.blocked and intended is not None:
                more = self._at_hub(intended, witness, (first, second)) - hub
                if not more:
                    break
                hub |= more
                witness = self.steps.witness(first, second, witness.twist, between, hub)
            if witness.blocked or hub:
                return Blocked(witness if witness.blocked else None, at_hub=bool(hub), nearest=witness)
            tried.append(witness)
        one_way = [witness for witness in tried if witness.ahead is not None or witness.back is not None]
        return Blocked(None, nearest=next(iter([*one_way, *tried]), None))

    def rigid_by_text(self, first: Collection[str], second: Collection[str]) -> Source | None:
        """Where groups and assumptions of the manifest alone make two bodies one: the first of them; None where they do
        not."""
        number = {str(part.name): k for k, part in enumerate(self.assembly.parts)}
        sets, said = UnionFind(len(number)), []
        for group in self.assembly.groups:
            said.append((list(group.parts), group.source))
        for assumption in self.assembly.assumptions:
            if assumption.type == "fixed" and not assumption.ignore:
                parts = [part for name in assumption.between for part in self.assembly.parts_of(name)]
                said.append((parts, assumption.source))
        for parts, _ in said:
            for part in parts[1:]:
                sets.union(number[str(parts[0])], number[str(part)])
        one, other = (number[min(side)] for side in (first, second))
        if sets.find(one) != sets.find(other):
            return None
        where = next(source for parts, source in said if sets.find(number[str(parts[0])]) == sets.find(one))
        return Source(where.file, where.line)

    def _at_hub(
        self, intended: IntendedJoint, witness: StepWitness, sides: tuple[Collection[str], Collection[str]]
    ) -> frozenset[tuple[str, str]]:
        """Pairs of parts that block a described joint within the radius of a hub about its axis."""
        described = {joint.name for one in self.assembly.descriptions for joint in one.joints}
        if intended.name not in described or intended.axis is None or intended.point is None or not witness.turns:
            return frozenset()
        axis, point = intended.axis / norm(intended.axis), intended.point
        parent = set(map(str, self.assembly.parts_of(intended.between[0])))
        first = sides[0] if parent & set(sides[0]) else sides[1]
        small = min(self.steps.diagonal(side) for side in sides)
        out = set()
        for step in (witness.ahead, witness.back):
            assert step is not None
            points = self._closed(step, witness.twist)
            if not len(points):
                points = step.place[None]
            along = (points - point) @ axis
            reach = float(np.linalg.norm(points - point - along[:, None] * axis, axis=1).max())
            span = float(along.min()), float(along.max())
            round_ = reach <= HUB_SHARE * small and _goes_round(points - point, axis)
            if round_ or reach <= self._hub_radius(first, axis, point, span, step.parts):
                out.add(step.parts)
        return frozenset(out)

    def _closed(self, step: Step, twist: Array) -> Array:
        """(n, 3) m samples of the contact of a pair that a step closes by more than their tolerance."""
        sense = 1.0 if step.pair == step.parts else -1.0
        points = [np.zeros((0, 3))]
        for patch in self.steps.patches.get(step.parts, ()):
            closed = step.size * sense * closing_speeds(patch, twist) >= self.steps.tolerance(step.parts)
            points.append(patch.points[closed])
        return np.concatenate(points)

    def _hub_radius(
        self, names: Collection[str], axis: Array, point: Array, span: tuple[float, float], pair: tuple[str, str]
    ) -> float:
        """m: of the greatest round surface of some parts about an axis that is beside contacts in a `span` (m) along
        it; 0 without. Beside: within the contact tolerance of the pair."""
        near = self.steps.tolerance(pair)
        most = 0.0
        for name in sorted(names):
            part = self.assembly.part(name)
            if part.mesh is None or part.mesh.digest not in self.surfaces:
                continue
            R, p = part.X_WP[:3, :3], part.X_WP[:3, 3]
            for surface in self.surfaces[part.mesh.digest].surfaces:
                if surface.kind not in HUB_KINDS or surface.sweep < math.pi:
                    continue
                direction, centre = R @ surface.axis, R @ surface.point + p
                if norm(cross(direction, axis)) > math.sin(self.assembly.tolerances.alignment) * 5.0:
                    continue
                if norm(cross(axis, centre - point)) > near:
                    continue
                corners = part.mesh.vertices[np.unique(part.mesh.faces[surface.faces])] @ R.T + p - point
                along = corners @ axis
                if along.max() < span[0] - near or along.min() > span[1] + near:
                    continue
                away = np.linalg.norm(corners - along[:, None] * axis, axis=1)
                most = max(most, float(away.max()))
        return most


def _unit(motion: Array) -> Array:
    """A twist (6,) of unit turn, or of unit slide."""
    turn = float(norm(motion[:3]))
    return np.asarray(motion / (turn if turn > 0.0 else norm(motion[3:])))


def _goes_round(points: Array, axis: Array) -> bool:
    """Whether points (n, 3) go round an axis through the origin."""
    u, v = perpendicular(axis)
    angles = np.sort(np.arctan2(points @ v, points @ u))
    gaps = np.diff(angles, append=angles[0] + 2.0 * math.pi)
    return len(angles) > 1 and float(gaps.max()) <= HUB_GAP
