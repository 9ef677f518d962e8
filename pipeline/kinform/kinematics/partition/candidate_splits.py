"""Candidate splits: how a joint that does not name its two sides may separate the assembly.

A split is named by two parts that touch about the joint's axis. They are given to the cut as the sides of the joint,
with the joints whose sides are known; the cost of all contact that is then separated says how likely the split is.
Splits that differ only by rings, horns or screws count as one, the cheapest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.vectors import norm, perpendicular
from kinform.foundation.graphs.graph import UnionFind
from kinform.frozen import dataclass
from kinform.kinematics.joints.bodies.extents import Extents, part_volumes
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.joints.bodies.stated_joints import joint_twists
from kinform.kinematics.partition.constants import COAXIAL_OFF, PARTED
from kinform.kinematics.partition.contact import PartPair, contact_of_pairs
from kinform.kinematics.partition.graph import graph_of, stated_merger
from kinform.kinematics.partition.labelling import Labels, label_all
from kinform.kinematics.partition.sides import substantial
from kinform.kinematics.partition.split_prices import Prices, hints_of, prices
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.function import IntendedJoint
from kinform.model.names import PartName

ALIKE = 0.3
"""Share of the smallest side by which two splits may differ and count as one: a ring, a horn, screws. Chosen, not
measured."""
ONLY_SPLIT = 1000.0
"""Price by which every other split must cost more than the one that is accepted: that of a pocket. Beyond it something
would be separated that is fastened. Holes round a journal (400) are no such, as the horns of servos have them: at 340
and 400 wrong splits were cheaper on a public robot, where batteries lie on the axis."""


Names = tuple[PartName, PartName]
SideParts = tuple[frozenset[PartName], frozenset[PartName]]


@dataclass(frozen=True, eq=False)
class Split:
    """One candidate split of the assembly by a joint."""

    names: Names
    """A part of each side."""
    bodies: SideParts
    """All parts of each side."""
    cost: float
    """Of everything that is parted."""
    beyond: float
    """m along the joint's axis from its point to where they touch, or 0."""


@dataclass(frozen=True, eq=False)
class BodiesFound:
    """The bodies of all parts."""

    body: Mapping[PartName, int | None]
    sides: Mapping[int, Labels]
    """Of joints, by number."""
    cost: float
    count: int
    """How many bodies there are."""


class Splits:
    """The moving joints of an assembly, and what each may part. Numbers of joints are those of `joints`."""

    def __init__(self, assembly: Assembly, contacts: Contacts, joints: Sequence[IntendedJoint]):
        self.assembly, self.contacts, self.joints = assembly, contacts, joints
        self.volume = part_volumes(assembly)
        self.contact = contact_of_pairs(contacts.patches)
        self.hints = hints_of(contacts.suggestions)
        motions = [joint_twists(joint) for joint in joints]
        self.prices: Prices = prices(joints, motions, contacts.patches, contacts.suggestions)
        self._parted: dict[tuple[tuple[int, Names], ...], BodiesFound] = {}
        self._drawn: dict[tuple[int, bool], list[Split]] = {}

    @cached_property
    def merger(self) -> Merger:
        """What is one body whatever contact says."""
        return stated_merger(self.assembly, sorted(self.assembly.function.joints, key=lambda joint: joint.name))

    @cached_property
    def size(self) -> float:
        """m: the diagonal of the assembly's box."""
        return Extents(self.assembly).assembly

    @cached_property
    def piece(self) -> dict[PartName, PartName]:
        """The largest of the parts that no joint may part from a part, by part."""
        number = {name: k for k, name in enumerate(sorted(self.volume))}
        sets = UnionFind(len(number))
        first: dict[int, int] = {}
        for name, k in number.items():
            sets.union(first.setdefault(self.merger.root(name), k), k)
        for pair, parted in self.prices.by_joint.items():
            if not parted:
                sets.union(number[pair[0]], number[pair[1]])
        largest: dict[int, PartName] = {}
        for name, k in number.items():
            root = sets.find(k)
            largest[root] = max(largest.get(root, name), name, key=lambda one: (self.volume[one], one))
        return {name: largest[sets.find(k)] for name, k in number.items()}

    def bodies_for(self, known: Mapping[int, Names]) -> BodiesFound:
        """The bodies that the joints with known sides ask for."""
        key = tuple(sorted(known.items()))
        if key not in self._parted:
            numbers = [number for number, _ in key]
            joints = [replace(self.joints[number], between=names) for number, names in key]
            costs = self.prices.of(numbers)
            graph = graph_of(self.assembly, self.contacts, joints, self.merger.copy(), costs)
            labels = label_all(graph.nodes, graph.seeds, graph.edges).labels
            cost = 0.0
            for edge in graph.edges:
                first, second = (labels[end] for end in edge.ends)
                if first is not None and second is not None:
                    cost += edge.price(first, second)
            body = {name: labels[piece] for name, piece in graph.piece_of.items()}
            self._parted[key] = BodiesFound(body, dict(zip(numbers, graph.sides, strict=True)), cost, len(graph.names))
        return self._parted[key]

    def candidates(self, number: int, known: Mapping[int, Names]) -> list[Split]:
        """Splits of parting by a joint beside those whose sides are known, the cheapest first; none that parts the same
        two bodies as another joint. Flats beside the axis count where nothing goes round it."""
        for flats in (False, True):
            out: list[Split] = []
            for drawn in self._alone(number, flats):
                parted = self.bodies_for(dict(known) | {number: drawn.names})
                sides = parted.sides[number]
                if not any(set(parted.sides[other]) == set(sides) for other in known if other != number):
                    out.append(self._split(drawn.names, parted, sides, drawn.beyond))
            found = self._different(number, out)
            if found:
                return found
        return []

    def elsewhere(self, number: int, known: Mapping[int, Names], split: Split) -> list[Split]:
        """Splits that separate the contact of `split` at about the same price, but assign it to other bodies: those
        that the other joints name, and that touch one of its sides or have a joint with it."""
        parted = self.bodies_for(dict(known) | {number: split.names})
        names: dict[int | None, PartName] = {}
        for name in sorted(name for both in known.values() for name in both):
            names.setdefault(parted.body[name], name)
        sides = set(parted.sides[number])
        touching = {frozenset(parted.body[name] for name in pair) for pair in self.contact}
        touching |= {frozenset(labels) for labels in parted.sides.values()}
        out = []
        for k, own in enumerate(split.names):
            near = {body for pair in touching if parted.body[own] in pair for body in pair}
            for body in sorted((near & names.keys()) - sides - {None}, key=str):
                other = (names[body], split.names[1]) if k == 0 else (split.names[0], names[body])
                found = self.bodies_for(dict(known) | {number: other})
                ends = {found.body[name] for name in split.names}
                if ends == set(found.sides[number]) and found.cost - parted.cost < ONLY_SPLIT:
                    out.append(self._split(other, found, found.sides[number], split.beyond))
        return [one for one in out if not self.alike(one, split)]

    def _alone(self, number: int, flats: bool) -> list[Split]:
        """Splits of parting by a joint without any other, those that are alike once."""
        if (number, flats) not in self._drawn:
            found = []
            for names, beyond in sorted(self._touching(number, flats).items()):
                parted = self.bodies_for({number: names})
                found.append(self._split(names, parted, parted.sides[number], beyond))
            self._drawn[number, flats] = self._different(number, found)
        return self._drawn[number, flats]

    def _touching(self, number: int, flats: bool) -> dict[Names, float]:
        """Parts that touch about the joint's axis and that it may part, with how far from its point: of each two pieces
        those that touch over the largest area."""
        joint = self.joints[number]
        best: dict[frozenset[PartName], tuple[float, Names]] = {}
        for pair in self.about(number, flats):
            pieces = frozenset(self.piece[name] for name in pair)
            if len(pieces) == 2:
                best[pieces] = max(best.get(pieces, (0.0, pair)), (float(self.contact[pair].weights.sum()), pair))
        out: dict[Names, float] = {}
        for _, pair in best.values():
            out[pair] = 0.0
            if joint.axis is not None and joint.point is not None:
                along = (self.contact[pair].points - joint.point) @ joint.axis
                out[pair] = max(float(along.min()), -float(along.max()), 0.0)
        return out

    def about(self, number: int, flats: bool = True) -> list[PartPair]:
        """The pairs that touch about the joint's axis and that it may part, of the parts below its own manifest. A
        slide has no place: of it, guides count only."""
        joint = self.joints[number]
        prefix = joint.name[: joint.name.rfind("/") + 1]
        turns = joint.type not in ("prismatic", "planar")
        return [
            pair
            for pair, parted in self.prices.by_joint.items()
            if number in parted
            and all(name.startswith(prefix) for name in pair)
            and (not turns or self.contact[pair].near(joint))
            and ((turns and flats) or self._own(number, pair) <= PARTED)
        ]

    def _own(self, number: int, pair: PartPair) -> float:
        return self.prices.by_joint[pair][number] - self.hints.get(pair, 0.0)

    def _split(self, names: Names, parted: BodiesFound, sides: Labels, beyond: float) -> Split:
        first, second = (frozenset(n for n, body in parted.body.items() if body == side) for side in sides)
        return Split(names, (first, second), parted.cost, beyond)

    def _different(self, number: int, splits: Sequence[Split]) -> list[Split]:
        """The cheapest of splits that are alike, if its sides are more than rings, balls and screws, and one of them
        has the named part."""
        joint = self.joints[number]
        named = self.assembly.parts_of(joint.between[0])[0] if joint.between[0] else None
        # Share of the assembly's volume that either side of a joint has at least where it does not name its sides.
        # Twice that of proposals (`sides.PROPOSED_SHARE`). Chosen, not measured.
        least = substantial(np.array(list(self.volume.values())), 0.002)
        out: list[Split] = []
        for split in sorted(splits, key=lambda one: (one.cost, one.names)):
            if named is not None and not any(named in side for side in split.bodies):
                continue
            free = [side for side in split.bodies if named not in side]
            if min(self._size(side) for side in free) >= least and not any(self.alike(split, other) for other in out):
                out.append(split)
        return out

    def alike(self, one: Split, other: Split) -> bool:
        """Whether two splits differ by little, relative to the smallest of their sides."""
        smallest = min(self._size(side) for side in (*one.bodies, *other.bodies))
        (a, b), (c, d) = one.bodies, other.bodies
        odd = min(self._size((a ^ c) | (b ^ d)), self._size((a ^ d) | (b ^ c)))
        return odd < ALIKE * smallest

    def divides(self, before: BodiesFound, after: BodiesFound) -> bool:
        """Whether each body with a joint is next to all of one body without it, and there is one more at most: else it
        was not found of which body the parts are that it names."""
        if after.count > max(before.count, 1) + 1:
            return False
        shares: dict[int, dict[int | None, float]] = {}
        for name, body in sorted(after.body.items()):
            if body is not None:
                of = shares.setdefault(body, {})
                of[before.body[name]] = of.get(before.body[name], 0.0) + self.volume.get(name, 0.0)
        return all(max(of.values()) >= (1.0 - ALIKE) * sum(of.values()) for of in shares.values())

    def held_about(self, number: int, split: Split) -> bool:
        """Whether other contact about the axis stays whole: the joint might be there."""
        first, second = split.bodies
        return any((set(pair) & first == set()) or (set(pair) & second == set()) for pair in self.about(number, False))

    def round(self, number: int, name: PartName) -> bool:
        """Whether a part goes round a joint's axis, as rings and wheels do: the middle of its surface lies on it, and
        its spread across it is the same on all sides."""
        joint, part = self.joints[number], self.assembly.part(name)
        if joint.axis is None or joint.point is None or part.mesh is None:
            return False
        corners = (part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3])[part.mesh.faces] - joint.point
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        across = corners.mean(axis=1) @ np.column_stack(perpendicular(joint.axis))
        middle = areas @ across / areas.sum()
        spread = np.linalg.eigvalsh((across - middle).T @ ((across - middle) * areas[:, None]) / areas.sum())
        off = norm(middle)
        even = float(spread[0]) > (1.0 - COAXIAL_OFF) * float(spread[1])
        return even and off < COAXIAL_OFF * float(spread[1]) ** 0.5

    def _size(self, names: frozenset[PartName]) -> float:
        return sum(self.volume.get(name, 0.0) for name in sorted(names))
