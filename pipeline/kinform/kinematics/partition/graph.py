"""The graph that bodies are cut from: pieces, which contact makes one whatever the joints, and what is between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.foundation.graphs.graph import UnionFind
from kinform.frozen import dataclass
from kinform.kinematics.joints.bodies.merging import Merger
from kinform.kinematics.joints.bodies.stated_joints import joint_twists
from kinform.kinematics.partition.constants import TOUCH_WORTH
from kinform.kinematics.partition.contact import PartPair
from kinform.kinematics.partition.label_merging import Hold, merge_by_cost, merge_labels
from kinform.kinematics.partition.labelling import Edge, Labels
from kinform.kinematics.partition.loops import Loops
from kinform.kinematics.partition.split_prices import Prices, prices
from kinform.model.assembly import Assembly
from kinform.model.contacts import Contacts, Patch
from kinform.model.function import IntendedJoint
from kinform.model.names import PartName


@dataclass(frozen=True, eq=False)
class Graph:
    """Pieces, and the contacts between them. Labels are bodies: there are as many as `names`."""

    names: tuple[str, ...]
    """Of the labels: the first name that a joint gives it."""
    piece_of: Mapping[PartName, int]
    seeds: Mapping[int, int]
    """Labels of pieces with a part that a joint names."""
    edges: tuple[Edge, ...]
    sides: tuple[Labels, ...]
    """Of the joints."""
    named: tuple[tuple[PartName, PartName], ...]
    """A part on either side of each joint."""
    prices: Prices
    guessed: frozenset[int] = frozenset()
    """Labels of bodies of which joints name several parts that only contact says to be one."""
    open: frozenset[int] = frozenset()
    """Labels of bodies whose names could be joined otherwise at nearly the same cost."""

    @cached_property
    def pairs_of(self) -> dict[PartName, list[PartPair]]:
        """The pairs that touch, by part."""
        out: dict[PartName, list[PartPair]] = {}
        for pair in self.prices.by_joint:
            for name in pair:
                out.setdefault(name, []).append(pair)
        return out

    @property
    def nodes(self) -> int:
        """How many pieces there are."""
        return max(self.piece_of.values(), default=-1) + 1


def stated_merger(assembly: Assembly, joints: Sequence[IntendedJoint]) -> Merger:
    """Parts that are one body whatever contact says: groups, assumptions, fixed joints, and the parts of one name."""
    merger = Merger(assembly)
    for joint in joints:
        for name in filter(None, joint.between):
            members = assembly.parts_of(name)
            for other in members[1:]:
                merger.fuse(members[0], other, f"named as {name}")
        if joint.type == "fixed":
            first, second = (assembly.parts_of(name)[0] for name in joint.between)
            merger.fuse(first, second, f"intended joint {joint.name}")
    return merger


def graph_of(
    assembly: Assembly,
    contacts: Contacts,
    joints: Sequence[IntendedJoint],
    merger: Merger,
    costs: Prices | None = None,
) -> Graph:
    """The graph for these joints, none of them fixed; parts that are one in `merger` are one piece. `costs`: what the
    joints part at which price, where it is known."""
    if costs is None:
        costs = prices(joints, [joint_twists(joint) for joint in joints], contacts.patches, contacts.suggestions)
    parts = sorted(part.name for part in assembly.parts)
    number = {name: k for k, name in enumerate(parts)}
    named = [tuple(assembly.parts_of(name)[0] for name in joint.between) for joint in joints]
    first_name: dict[int, str] = {}
    for joint, ends in zip(joints, named, strict=True):
        for name, part in zip(joint.between, ends, strict=True):
            root = merger.root(part)
            first_name[root] = min(name, first_name.get(root, name))
    roots = sorted(first_name, key=lambda root: first_name[root])
    label_of = {root: k for k, root in enumerate(roots)}
    sides = [(label_of[merger.root(a)], label_of[merger.root(b)]) for a, b in named]
    sets = UnionFind(len(parts))
    by_root: dict[int, PartName] = {}
    for name in parts:
        sets.union(number[by_root.setdefault(merger.root(name), name)], number[name])
    at = {number[by_root[root]]: label for root, label in label_of.items()}
    loops = _loops(assembly, joints, sides)
    least = merge_labels(sets, at, _holds(number, costs, contacts.patches), sides, loops)
    pieces = _pieces(sets, number, costs, at)  # of one label at most
    seeds = {pieces[parts[node]]: label for node, label in at.items()}
    final, close = merge_by_cost(seeds, _edges(pieces, sides, costs, contacts.patches), sides, least, loops)
    kept = {label: k for k, label in enumerate(sorted(set(final)))}
    new = [kept[label] for label in final]
    sides = [(new[a], new[b]) for a, b in sides]
    pieces = _pieces(sets, number, costs, {node: new[label] for node, label in at.items()})
    return Graph(
        tuple(first_name[roots[new.index(k)]] for k in range(len(kept))),
        pieces,
        {pieces[parts[node]]: new[label] for node, label in at.items()},
        tuple(_edges(pieces, sides, costs, contacts.patches)),
        tuple(sides),
        tuple((a, b) for a, b in named),
        costs,
        guessed=frozenset(label for label in new if new.count(label) > 1),
        open=frozenset(new[label] for label in close),
    )


def _loops(assembly: Assembly, joints: Sequence[IntendedJoint], sides: Sequence[Labels]) -> Loops:
    """What tells which loops may be closed."""
    hanging = UnionFind(1 + max((max(pair) for pair in sides), default=-1))
    for pair in sides:
        hanging.union(*pair)
    connected = len({hanging.find(label) for pair in sides for label in pair}) <= 1
    boxes = np.array([part.mesh.placed_box(part.X_WP) for part in assembly.parts if part.mesh is not None])
    size = norm(boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)) if len(boxes) else 0.0
    return Loops([joint_twists(joint) for joint in joints], sides, size, connected)


def _pieces(
    sets: UnionFind, number: Mapping[PartName, int], costs: Prices, seeds: Mapping[int, int]
) -> dict[PartName, int]:
    """The piece of every part: what is one anyway, and what no joint may part; seeds of two labels are never one."""
    joined = UnionFind(len(number))
    for node in number.values():
        joined.union(node, sets.find(node))
    _contract(joined, number, costs, seeds)
    order: dict[int, int] = {}
    for name in sorted(number):
        order.setdefault(joined.find(number[name]), len(order))
    return {name: order[joined.find(number[name])] for name in sorted(number)}


def _areas(patches: Sequence[Patch]) -> dict[PartPair, float]:
    """Area of contact of each pair, m²."""
    out: dict[PartPair, float] = {}
    for patch in patches:
        out[patch.parts] = out.get(patch.parts, 0.0) + patch.area
    return out


def _holds(number: Mapping[PartName, int], costs: Prices, patches: Sequence[Patch]) -> list[Hold]:
    """What parting each pair costs at least, the dearest first; of those that cost the same, the largest."""
    areas = _areas(patches)
    least = {pair: min(parted.values(), default=costs.held[pair]) for pair, parted in costs.by_joint.items()}
    ranked = sorted(least, key=lambda pair: (-least[pair], -areas[pair], pair))
    return [(least[pair], (number[pair[0]], number[pair[1]])) for pair in ranked]


def _edges(
    piece_of: Mapping[PartName, int], sides: Sequence[Labels], costs: Prices, patches: Sequence[Patch]
) -> list[Edge]:
    """The contacts between pieces; of two that cost the same, the larger is a little dearer."""
    area = _areas(patches)
    largest = max(area.values(), default=1.0)
    joined = frozenset(labels for a, b in sides if a != b for labels in ((a, b), (b, a)))
    ways = [((a, b), (b, a)) for a, b in sides]
    edges = []
    for pair, parted in costs.by_joint.items():
        ends = (piece_of[pair[0]], piece_of[pair[1]])
        if ends[0] == ends[1]:
            continue
        touch = TOUCH_WORTH * area[pair] / largest
        table: dict[Labels, float] = {}
        for joint, price in parted.items():
            cost = price + touch
            for labels in ways[joint]:
                if table.get(labels, np.inf) > cost:
                    table[labels] = cost
        edges.append(Edge(ends, table, costs.held[pair] + touch, costs.hints.get(pair, 0.0), joined))
    return edges


def _contract(sets: UnionFind, number: Mapping[PartName, int], costs: Prices, seeds: Mapping[int, int]) -> None:
    """Make one what no joint may part, unless that would make two bodies one."""
    held = UnionFind(len(number))
    for node in number.values():
        held.union(node, sets.find(node))
    firm = costs.firm()
    for first, second in firm:
        held.union(number[first], number[second])
    inside: dict[int, set[int]] = {}
    for seed, label in seeds.items():
        inside.setdefault(held.find(seed), set()).add(label)
    for first, second in firm:
        if len(inside.get(held.find(number[first]), ())) <= 1:
            sets.union(number[first], number[second])
