"""What it costs to part two parts that touch along the motion of a joint.

A joint's motions are a few twists. Two parts may be parted by it where next to none of the area between them opposes
any of them. How readily: a journal or a collar that goes round the joint's axis is what joints are made of; an annular
face without a journal may be a flange; a flat beside the axis that a turn leaves free is chance.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import field, replace

import numpy as np

from kinform.foundation.algebra.vectors import cross, norm, perpendicular, widest_gap
from kinform.frozen import dataclass
from kinform.kinematics.partition import constants
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch, Suggestion
from kinform.model.function import IntendedJoint
from kinform.model.names import PartName

PartPair = tuple[PartName, PartName]

ROUND = ("cylinder", "cone", "sphere", "torus", "revolution", "helicoid")
"""Kinds of patches that bear a turn."""


def joint_twists(joint: IntendedJoint) -> Array | None:
    """(k, 6) motions of an intended joint (ω; v at the world's origin); None where it does not say where they are."""
    z = np.zeros(3)
    point = joint.point
    if joint.type == "fixed":
        return np.zeros((0, 6))
    if joint.type == "spherical":
        return None if point is None else np.array([_turn(direction, point) for direction in np.eye(3)])
    if joint.axis is None:
        return None
    axis = joint.axis / norm(joint.axis)
    slide = np.concatenate([z, axis])
    if joint.type == "prismatic":
        return slide[None]
    if joint.type == "planar":
        u, v = perpendicular(axis)
        place = z if point is None else point
        return np.array([_turn(axis, place), np.concatenate([z, u]), np.concatenate([z, v])])
    if point is None:
        return None
    if joint.type == "revolute":
        return _turn(axis, point)[None]
    if joint.type == "cylindrical":
        return np.array([_turn(axis, point), slide])
    if joint.type == "screw" and joint.pitch is not None:
        return (_turn(axis, point) + joint.pitch / (2.0 * np.pi) * slide)[None]
    if joint.type == "universal" and joint.axis2 is not None:
        return np.array([_turn(axis, point), _turn(joint.axis2 / norm(joint.axis2), point)])
    return None


def _turn(axis: Array, point: Array) -> Array:
    return np.concatenate([axis, cross(point, axis)])


@dataclass(frozen=True, eq=False)
class Prices:
    """What parting each pair of parts costs."""

    by_joint: Mapping[PartPair, Mapping[int, float]]
    """For each pair that touches, the joints that may part it, by number, and the price. Without any it is held."""
    held: Mapping[PartPair, float]
    """What it costs to part a pair although no joint may: what holds it is broken."""
    hints: Mapping[PartPair, float] = field(default_factory=dict)
    """What of these prices is there because something suggests that a pair is fastened."""
    slight: frozenset[PartPair] = frozenset()
    """Pairs that touch at points or along lines only."""

    def of(self, numbers: Sequence[int]) -> Prices:
        """The prices of some of the joints, numbered anew."""
        new = {number: k for k, number in enumerate(numbers)}
        some = {
            pair: {new[k]: price for k, price in parted.items() if k in new} for pair, parted in self.by_joint.items()
        }
        return replace(self, by_joint=some)

    def firm(self) -> list[PartPair]:
        """The pairs that no joint may part: they are one body wherever that joins no two.

        What touches at points or along lines is none of them, nor are two parts with journals about axes of different
        joints, as gears in mesh: what each of them goes with says more.
        """
        turning: dict[PartName, set[int]] = {}
        for pair, parted in self.by_joint.items():
            hint = self.hints.get(pair, 0.0)
            about = {k for k, price in parted.items() if constants.LOOSE_JOURNAL <= price - hint <= constants.JOURNAL}
            for name in pair:
                turning.setdefault(name, set()).update(about)
        return [
            (first, second)
            for (first, second), parted in self.by_joint.items()
            if not parted and (first, second) not in self.slight and _same_turns(turning[first], turning[second])
        ]


def _same_turns(first: Set[int], second: Set[int]) -> bool:
    """Whether parts that turn about the axes of these joints may be one body by that."""
    return not first or not second or bool(first & second)


def prices(
    joints: Sequence[IntendedJoint],
    twists: Sequence[Array | None],
    patches: Sequence[Patch],
    suggestions: Sequence[Suggestion],
) -> Prices:
    """The price of parting every pair of parts that touch, by every joint that may."""
    hints = hints_of(suggestions)
    by_joint, held, slight = {}, {}, set()
    asked = [(number, motions) for number, motions in enumerate(twists) if motions is not None and len(motions)]
    for pair, contact in contact_of_pairs(patches).items():
        hint = hints.get(pair, 0.0)
        costs = {}
        for number, motions in contact.in_question(asked):
            cost = contact.price(joints[number], motions)
            if cost is not None:
                costs[number] = cost + hint
        by_joint[pair] = costs
        held[pair] = (constants.GRAZED if contact.slight else constants.BROKEN) + hint
        slight |= {pair} if contact.slight else set()
    return Prices(by_joint, held, hints, frozenset(slight))


def contact_of_pairs(patches: Sequence[Patch]) -> dict[PartPair, Contact]:
    """All contact of each pair of parts, sorted by their names."""
    between: dict[PartPair, list[Patch]] = {}
    for patch in patches:
        if not (patch.narrow or patch.unknown):
            between.setdefault(patch.parts, []).append(patch)
    return {pair: Contact.of(between[pair]) for pair in sorted(between)}


def hints_of(suggestions: Sequence[Suggestion]) -> dict[PartPair, float]:
    """What parting pairs costs beside, as something suggests that they are fastened."""
    out: dict[PartPair, float] = {}
    for suggestion in suggestions:
        worth = constants.FASTENED.get(suggestion.kind)
        if worth is not None:
            out[suggestion.parts] = max(out.get(suggestion.parts, 0.0), worth)
    return out


@dataclass(frozen=True, eq=False)
class Contact:
    """All contact of a pair of parts."""

    patches: tuple[Patch, ...]
    points: Array
    normals: Array
    weights: Array
    start: Ints

    @staticmethod
    def of(patches: Sequence[Patch]) -> Contact:
        return Contact(
            tuple(patches),
            np.concatenate([patch.points for patch in patches]),
            np.concatenate([patch.normals for patch in patches]),
            np.concatenate([patch.weights for patch in patches]),
            np.cumsum([0, *(len(patch.points) for patch in patches)]),
        )

    @property
    def slight(self) -> bool:
        """Whether it is at points or along lines only."""
        return all(patch.kind in ("point", "line") for patch in self.patches)

    def near(self, joint: IntendedJoint) -> bool:
        """Whether the joint's axis, or centre, passes through the ball round the contact."""
        assert joint.point is not None
        arm = 0.5 * (self.points.min(axis=0) + self.points.max(axis=0)) - joint.point
        if joint.axis is not None:
            arm = arm - (arm @ joint.axis) * joint.axis
        return norm(arm) <= 0.5 * norm(np.ptp(self.points, axis=0))

    def in_question(self, asked: Sequence[tuple[int, Array]]) -> list[tuple[int, Array]]:
        """The joints, by number and motions, whose first motion next to none of it opposes; all where it has facets of
        no known surface, as serrations do not count."""
        if not asked or any(patch.kind in ("freeform", "other") for patch in self.patches):
            return list(asked)
        first = np.array([motions[0] for _, motions in asked])
        share = self._opposed(first) @ self.weights
        limit = constants.OPPOSED_AREA * float(self.weights.sum())
        return [one for one, area in zip(asked, share, strict=True) if area <= limit * (1.0 + 1e-9)]

    def _opposed(self, motions: Array) -> Flags:
        """(k, n) whether each of k motions (k, 6) presses on each point or leaves it."""
        speeds = motions[:, None, 3:] + cross(motions[:, None, :3], self.points[None])
        pace = np.linalg.norm(speeds, axis=2)
        slow = constants.SLOW * pace.max(axis=1, initial=0.0, keepdims=True)
        return np.asarray(np.abs(np.einsum("kij,ij->ki", speeds, self.normals)) > constants.OPPOSED * pace + slow)

    def price(self, joint: IntendedJoint, motions: Array) -> float | None:
        """What it costs to part them by this joint, whose motions these are; None where it may not."""
        opposed = np.asarray(self._opposed(motions).any(axis=0))
        total = float(self.weights.sum())
        if total <= 0.0:
            return None
        turns = bool((np.linalg.norm(motions[:, :3], axis=1) > 0.0).any())
        serrated = self._serrated(joint) if turns else np.zeros(len(self.points), dtype=bool)
        if float(self.weights[opposed & ~serrated].sum()) > constants.OPPOSED_AREA * total:
            return None
        if self.slight:
            return constants.ROLLING
        if not turns:
            return self._guided(joint, opposed)
        if joint.type == "planar":
            return constants.JOURNAL  # a flat across its normal, wherever it lies
        price = self._round(joint, opposed)
        return max(price, constants.SERRATED) if (opposed & serrated).any() else price

    def _serrated(self, joint: IntendedJoint) -> Flags:
        """(n,) points on facets of no known surface that go round the joint's axis: serrations of a servo's output,
        which is one mesh with the servo, in what it turns."""
        out = np.zeros(len(self.points), dtype=bool)
        if joint.type == "planar":
            return out
        for k, patch in enumerate(self.patches):
            rows = slice(int(self.start[k]), int(self.start[k + 1]))
            if patch.kind in ("freeform", "other"):
                out[rows] = self._off(joint, k) < constants.FACE_OFF
        return out

    def _off(self, joint: IntendedJoint, k: int) -> float:
        """How far the middle of patch k lies beside the joint's axis, or centre, as a share of its reach from there."""
        assert joint.point is not None
        arms = self.points[int(self.start[k]) : int(self.start[k + 1])] - joint.point
        if joint.type != "spherical" and joint.axis is not None:
            axis = joint.axis / norm(joint.axis)
            arms = arms - np.outer(arms @ axis, axis)
        weights = self.patches[k].weights
        reach = float(np.linalg.norm(arms, axis=1).max(initial=0.0))
        middle = weights @ arms / max(float(weights.sum()), 1e-300)
        return norm(middle) / max(reach, 1e-300)

    def _round(self, joint: IntendedJoint, opposed: Flags) -> float:
        """The price along a turn: do patches go round its axis, or its centre?"""
        journal, firm, apart, farthest = False, False, True, 0.0
        total = float(self.weights.sum())
        for k, patch in enumerate(self.patches):
            rows = slice(int(self.start[k]), int(self.start[k + 1]))
            if opposed[rows].any() or float(patch.weights.sum()) < constants.OPPOSED_AREA * total:
                continue
            off = self._off(joint, k)
            here = self._journal(joint, k)
            journal |= here
            firm |= here and not _loose(patch)
            farthest = max(farthest, off)
            apart &= _apart(self.patches[k])
        round_it = farthest < constants.FACE_OFF
        if journal and round_it:
            return constants.JOURNAL if firm else constants.LOOSE_JOURNAL
        if journal or round_it:
            return constants.FACE_ROUND
        return constants.FLAT_APART if apart else constants.FLAT_BESIDE

    def journal(self, joint: IntendedJoint) -> bool:
        """Whether any of it goes round the joint's axis, or its centre."""
        return any(self._journal(joint, k) for k in range(len(self.patches)))

    def _journal(self, joint: IntendedJoint, k: int) -> bool:
        """Whether patch k does."""
        round_ = self.patches[k].kind in ROUND
        return round_ and (self._off(joint, k) < constants.JOURNAL_OFF or self._coaxial(joint, k))

    def _coaxial(self, joint: IntendedJoint, k: int) -> bool:
        """Whether patch k lies on a surface of revolution about the joint's axis, or on a sphere about its centre."""
        assert joint.point is not None
        patch = self.patches[k]
        arm = patch.point - joint.point
        size = max(patch.radii, default=0.0)
        if joint.type == "spherical" or joint.axis is None:
            return patch.kind == "sphere" and norm(arm) < constants.COAXIAL_OFF * size
        axis = joint.axis / norm(joint.axis)
        off = norm(arm - (arm @ axis) * axis)
        return abs(float(patch.axis @ axis)) > np.cos(constants.COAXIAL) and off < constants.COAXIAL_OFF * size

    def _guided(self, joint: IntendedJoint, opposed: Flags) -> float:
        """The price along a slide: do faces that run along it stand round it?"""
        assert joint.axis is not None
        axis = joint.axis / norm(joint.axis)
        gap = widest_gap(self.normals[~opposed], axis)
        return constants.JOURNAL if gap < constants.GUIDED_ROUND else constants.FLAT_BESIDE


def _apart(patch: Patch) -> bool:
    """Whether a flat has a gap that is wide by its own size."""
    return patch.kind == "plane" and patch.gap > patch.chord + constants.APART * patch.area**0.5


def _loose(patch: Patch) -> bool:
    """Whether a journal has play that its facets do not explain."""
    return patch.gap > patch.chord + constants.LOOSE * max(patch.radii, default=0.0)
