"""Bodies from the function: every part's body, what holds it there, and what is not clear."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import fcl
import numpy as np

from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_model, fcl_pose
from kinform.kinematics.bodies.merging import Merger
from kinform.kinematics.partition import constants
from kinform.kinematics.partition.labelling import Edge, Labelling, Margin, label_all, margins
from kinform.kinematics.partition.parting import Prices, joint_twists, prices
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts
from kinform.model.function import IntendedJoint
from kinform.model.names import PartName


@dataclass(frozen=True)
class Placed:
    """A part in its body."""

    part: PartName
    body: int
    how: str
    """named, grouped, held, cut, nearest."""
    margin: float
    """By how much another body would be dearer; infinite where no other comes into question."""
    other: int | None
    """The body that is next best."""
    along: tuple[PartName, ...] = ()
    """Parts that would go there with it."""
    either: bool = False
    """Whether the joints would let it be in that body as well."""

    @property
    def unclear(self) -> bool:
        """Whether it could go either way."""
        return self.either or self.margin < constants.EITHER


@dataclass(frozen=True, eq=False)
class Partition:
    """Which parts move as one."""

    names: tuple[str, ...]
    """Of the bodies: the first name that a joint gives it."""
    parts: tuple[tuple[PartName, ...], ...]
    placed: Mapping[PartName, Placed]
    unparted: Mapping[str, tuple[tuple[PartName, PartName], ...]] = field(default_factory=dict)
    """Joints whose two sides contact holds together, with the pairs of parts that hold."""
    proven: bool = True

    @property
    def unclear(self) -> tuple[Placed, ...]:
        """Parts that could go either way, sorted by name."""
        return tuple(p for _, p in sorted(self.placed.items()) if p.unclear)


def partition(assembly: Assembly, contacts: Contacts, joints: Sequence[IntendedJoint]) -> Partition:
    """The bodies that the intended joints ask for; every part of the assembly is in one.

    Groups and assumptions stand. The result does not depend on the order of parts or joints.
    """
    joints = sorted(joints, key=lambda joint: joint.name)
    merger = Merger(assembly)
    for joint in joints:
        for name in joint.between:
            members = assembly.parts_of(name)
            for other in members[1:]:
                merger.fuse(members[0], other, f"named as {name}")
        if joint.type == "fixed":
            first, second = (assembly.parts_of(name)[0] for name in joint.between)
            merger.fuse(first, second, f"intended joint {joint.name}")
    moving = [joint for joint in joints if joint.type != "fixed"]
    graph = _Graph.of(assembly, contacts, moving, merger)
    labelling = label_all(graph.nodes, graph.seeds, graph.edges)
    return graph.partition(labelling)


@dataclass(frozen=True, eq=False)
class _Graph:
    """Pieces, which parts alone or contact makes one, and the contacts between them."""

    joints: tuple[IntendedJoint, ...]
    names: tuple[str, ...]
    piece_of: Mapping[PartName, int]
    seeds: Mapping[int, int]
    edges: tuple[Edge, ...]
    pairs: tuple[tuple[PartName, PartName], ...]
    """Of parts, as many as edges."""
    assembly: Assembly
    merger: Merger
    prices: Prices

    @property
    def nodes(self) -> int:
        return max(self.piece_of.values(), default=-1) + 1

    @staticmethod
    def of(assembly: Assembly, contacts: Contacts, joints: Sequence[IntendedJoint], merger: Merger) -> _Graph:
        twists = [joint_twists(joint) for joint in joints]
        costs = prices(joints, twists, contacts.patches, contacts.suggestions)
        part_names = sorted(part.name for part in assembly.parts)
        number = {name: k for k, name in enumerate(part_names)}
        sides = [tuple(merger.root(assembly.parts_of(name)[0]) for name in joint.between) for joint in joints]
        first_name: dict[int, str] = {}
        for joint in joints:
            for name in joint.between:
                root = merger.root(assembly.parts_of(name)[0])
                first_name[root] = min(name, first_name.get(root, name))
        roots = sorted(first_name, key=lambda root: first_name[root])
        label_of_root = {root: k for k, root in enumerate(roots)}
        sets = UnionFind(len(part_names))
        by_root: dict[int, PartName] = {}
        for name in part_names:
            sets.union(number[by_root.setdefault(merger.root(name), name)], number[name])
        _contract(sets, number, costs, {number[by_root[root]]: label for root, label in label_of_root.items()})
        order: dict[int, int] = {}
        for name in part_names:
            order.setdefault(sets.find(number[name]), len(order))
        piece_of = {name: order[sets.find(number[name])] for name in part_names}
        seeds = {piece_of[by_root[root]]: label for root, label in label_of_root.items()}
        of_labels = [tuple(label_of_root[root] for root in side) for side in sides]
        area: dict[tuple[PartName, PartName], float] = {}
        for patch in contacts.patches:
            area[patch.parts] = area.get(patch.parts, 0.0) + patch.area
        largest = max(area.values(), default=1.0)
        edges, pairs = [], []
        for pair, parted in costs.by_joint.items():
            ends = (piece_of[pair[0]], piece_of[pair[1]])
            if ends[0] == ends[1]:
                continue
            touch = constants.TOUCH_WORTH * area[pair] / largest
            table: dict[tuple[int, int], float] = {}
            for k, price in parted.items():
                a, b = of_labels[k]
                for labels in ((a, b), (b, a)):
                    table[labels] = min(price + touch, table.get(labels, np.inf))
            edges.append(Edge(ends, table, costs.held[pair] + touch))
            pairs.append(pair)
        names = tuple(first_name[root] for root in roots)
        return _Graph(tuple(joints), names, piece_of, seeds, tuple(edges), tuple(pairs), assembly, merger, costs)

    def partition(self, labelling: Labelling) -> Partition:
        """The bodies, with what touches nothing in the body of the nearest part."""
        margin = margins(labelling.labels, self.seeds, self.edges)
        labels = list(labelling.labels)
        placed: dict[PartName, Placed] = {}
        members: dict[int, list[PartName]] = {}
        for name, piece in self.piece_of.items():
            members.setdefault(piece, []).append(name)
        shaped = {part.name for part in self.assembly.parts if part.mesh is not None}
        lost = [name for name in sorted(self.piece_of) if labels[self.piece_of[name]] is None and name in shaped]
        known = [name for name in sorted(self.piece_of) if labels[self.piece_of[name]] is not None]
        for name in known:
            piece = self.piece_of[name]
            label = labels[piece]
            assert label is not None
            if piece in self.seeds:
                placed[name] = Placed(name, label, "held", float("inf"), None)
                continue
            m = margin.get(piece, Margin(float("inf"), None, (), moves=False))
            along = tuple(sorted(part for n in m.along for part in members[n] if part != name))
            placed[name] = Placed(name, label, "cut", m.cost, m.label, along, m.moves)
        models: dict[PartName, fcl.BVHModel] = {}
        for name in lost:
            near = _nearest(self.assembly, name, known, models)
            label = placed[near].body if near is not None else 0
            placed[name] = Placed(name, label, "nearest", 0.0, None, (), either=True)
        parts = tuple(
            tuple(sorted(name for name, p in placed.items() if p.body == label)) for label in range(len(self.names))
        )
        return Partition(self.names, parts, placed, self._unparted(placed), labelling.proven)

    def _unparted(self, placed: Mapping[PartName, Placed]) -> dict[str, tuple[tuple[PartName, PartName], ...]]:
        """Joints between whose bodies contact is broken that the joint may not part."""
        out = {}
        for number, joint in enumerate(self.joints):
            bodies = {placed[self.assembly.parts_of(name)[0]].body for name in joint.between}
            held = tuple(
                pair
                for pair, parted in sorted(self.prices.by_joint.items())
                if number not in parted and {placed[part].body for part in pair} == bodies and len(bodies) == 2
            )
            if held:
                out[joint.name] = held
        return out


def _contract(sets: UnionFind, number: Mapping[PartName, int], costs: Prices, seeds: Mapping[int, int]) -> None:
    """Make one what no joint may part, unless that would make two bodies one."""
    held = UnionFind(len(number))
    for name in number:
        held.union(number[name], sets.find(number[name]))
    firm = [pair for pair, parted in costs.by_joint.items() if not parted]
    for first, second in firm:
        held.union(number[first], number[second])
    inside: dict[int, set[int]] = {}
    for seed, label in seeds.items():
        inside.setdefault(held.find(seed), set()).add(label)
    for first, second in firm:
        if len(inside.get(held.find(number[first]), ())) <= 1:
            sets.union(number[first], number[second])


def _nearest(
    assembly: Assembly, name: PartName, among: Sequence[PartName], models: dict[PartName, fcl.BVHModel]
) -> PartName | None:
    """The part whose surface is nearest, of the few whose boxes are; the first by name of several."""
    low, high = _box(assembly, name)
    apart = []
    for other in among:
        if assembly.part(other).mesh is not None:
            low_o, high_o = _box(assembly, other)
            gap = float(np.linalg.norm(np.maximum(np.maximum(low - high_o, low_o - high), 0.0)))
            middle = float(np.linalg.norm(low + high - low_o - high_o))
            apart.append((gap, middle, other))
    own = _object(assembly, name, models)
    best: tuple[float, PartName] | None = None
    for gap, _, other in sorted(apart)[: constants.NEAREST_TRIED]:
        if best is None or gap <= best[0]:
            best = min(best or (np.inf, other), (fcl_distance(own, _object(assembly, other, models)), other))
    return None if best is None else best[1]


def _box(assembly: Assembly, name: PartName) -> tuple[Array, Array]:
    part = assembly.part(name)
    assert part.mesh is not None
    return part.mesh.placed_box(part.X_WP)


def _object(assembly: Assembly, name: PartName, models: dict[PartName, fcl.BVHModel]) -> fcl.CollisionObject:
    part = assembly.part(name)
    assert part.mesh is not None
    if name not in models:
        models[name] = fcl_model(part.mesh.vertices, part.mesh.faces)
    return fcl.CollisionObject(models[name], fcl_pose(part.X_WP))
