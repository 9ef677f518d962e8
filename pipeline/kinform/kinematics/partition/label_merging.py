"""Names that stand for one body: joints may name different parts of it.

Two joints that share no named part leave open whether they share a body. Contact is followed from what no joint may
separate down to what costs more than a journal, as in Kruskal's spanning tree, and named parts that it joins are one
body. What is left, such as a named bearing ring, goes where the least is separated (`merge_by_cost`). Names that joints
connect already, directly or through others, close a loop if they are one body; they are merged only where every joint
can still move then (`loops`). Where names alone connect all joints, legs that cross may just be drawn touching: there a
joint must also lack contact about its axis unless they are merged.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kinform.foundation.graphs.graph import UnionFind
from kinform.kinematics.partition.constants import PARTED
from kinform.kinematics.partition.labelling import Edge, Labels
from kinform.kinematics.partition.loops import Loops
from kinform.kinematics.partition.merge_search import MergeSearch

Hold = tuple[float, tuple[int, int]]
"""The least price of separating two nodes that touch, by any joint, and the nodes."""


def merge_labels(
    one: UnionFind,
    seeds: Mapping[int, int],
    holds: Sequence[Hold],
    joints: Sequence[Labels],
    loops: Loops | None = None,
) -> list[int]:
    """Of every label, the least of those that are one body with it.

    Nodes that are `one` are one anyway. `seeds` are the labels of nodes, `joints` those of their sides; `holds` comes
    in the order of what parting them costs, the dearest first. `loops` tell which loops may be closed; without them
    none is.
    """
    count = len(seeds)
    same, hanging, sets = UnionFind(count), UnionFind(count), UnionFind(len(one.parent))
    for pair in joints:
        hanging.union(*pair)
    for node in range(len(one.parent)):
        sets.union(one.find(node), node)
    inside = {sets.find(node): [label] for node, label in seeds.items()}
    for price, ends in holds:
        if price <= PARTED:
            break
        a, b = (sets.find(end) for end in ends)
        first, second = inside.get(a, []), inside.get(b, [])
        if a == b:
            continue
        if {hanging.find(label) for label in first} & {hanging.find(label) for label in second}:
            closed = [min(first) if k in second else k for k in _least(same, count)]
            if loops is None or loops.connected or not loops.move(closed):
                continue
        for label in second:
            if first:
                same.union(first[0], label)
                hanging.union(first[0], label)
        sets.union(a, b)
        inside[sets.find(a)] = [*first, *second]
    return _least(same, count)


def merge_by_cost(
    seeds: Mapping[int, int],
    edges: Sequence[Edge],
    joints: Sequence[Labels],
    together: Sequence[int],
    loops: Loops | None = None,
) -> tuple[list[int], set[int]]:
    """The same of labels that only journals lie between: those are joined that leave the least to be parted, all ways
    looked at where these are few, else again and again the best two. Those `together` are one body by contact; what of
    them saves as much as screw holes cost elsewhere is moved there. With the labels that could be joined otherwise at
    less or nearly the same cost.
    """
    return MergeSearch(seeds, edges, joints, loops).settled(together)


def _least(same: UnionFind, count: int) -> list[int]:
    """Of every label, the least of its set."""
    least: dict[int, int] = {}
    for label in range(count):
        least.setdefault(same.find(label), label)
    return [least[same.find(label)] for label in range(count)]
