"""Names that stand for one body: joints may name different parts of it.

Two joints that share no named part leave it open whether they share a body. So contact is followed from what no joint
may part down to what is dearer than a journal, as in Kruskal's spanning tree, and named parts that it joins are one
body, unless joints hang them together already, directly or by way of others; what is left, a bearing's ring that was
named, goes where the least is parted (`joined_by_cost`). Names that hang together stay apart, as legs that cross are drawn touching, too:
that they touch is reported, and a group says that they are one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kinform.foundation.graphs.graph import UnionFind
from kinform.kinematics.partition import constants
from kinform.kinematics.partition.labelling import Edge, Labels, label_all

Hold = tuple[float, tuple[int, int]]
"""What parting two nodes that touch costs at least, by whichever joint."""


def one_body(one: UnionFind, seeds: Mapping[int, int], holds: Sequence[Hold], joints: Sequence[Labels]) -> list[int]:
    """Of every label, the least of those that are one body with it.

    Nodes that are `one` are one anyway. `seeds` are the labels of nodes, `joints` those of their sides; `holds` comes
    in the order of what parting them costs, the dearest first.
    """
    count = len(seeds)
    same, hanging, sets = UnionFind(count), UnionFind(count), UnionFind(len(one.parent))
    for pair in joints:
        hanging.union(*pair)
    for node in range(len(one.parent)):
        sets.union(one.find(node), node)
    inside = {sets.find(node): [label] for node, label in seeds.items()}
    for price, ends in holds:
        if price <= constants.PARTED:
            break
        a, b = (sets.find(end) for end in ends)
        first, second = inside.get(a, []), inside.get(b, [])
        if a == b or {hanging.find(label) for label in first} & {hanging.find(label) for label in second}:
            continue
        for label in second:
            if first:
                same.union(first[0], label)
                hanging.union(first[0], label)
        sets.union(a, b)
        inside[sets.find(a)] = [*first, *second]
    return _least(same, count)


def joined_by_cost(
    seeds: Mapping[int, int], edges: Sequence[Edge], joints: Sequence[Labels], together: Sequence[int]
) -> list[int]:
    """The same of labels that only journals lie between: again and again the two that leave the least to be parted.
    Those `together` are known to be one body.
    """
    count = len(together)
    same, hanging = UnionFind(count), UnionFind(count)
    nodes = max((node for edge in edges for node in edge.ends), default=-1) + 1
    nodes = max(nodes, max(seeds, default=-1) + 1)
    for label, other in enumerate(together):
        same.union(label, other)
        hanging.union(label, other)
    for pair in joints:
        hanging.union(*pair)

    def cost(new: Sequence[int]) -> dict[Labels, float]:
        current = [edge.relabelled(new) for edge in edges]
        labels = label_all(nodes, {node: new[label] for node, label in seeds.items()}, current).labels
        return _parted_between(labels, current)

    while len({hanging.find(label) for label in range(count)}) > 1:
        now = _least(same, count)
        costs = cost(now)
        tried = [
            (sum(cost([first if label == second else label for label in now]).values()), first, second)
            for first, second in sorted(costs)
            if hanging.find(first) != hanging.find(second)
        ]
        if not tried or min(tried)[0] >= sum(costs.values()):
            break
        _, first, second = min(tried)
        same.union(first, second)
        hanging.union(first, second)
    return _least(same, count)


def _parted_between(labels: Sequence[int | None], edges: Sequence[Edge]) -> dict[Labels, float]:
    """What is parted between every two labels, sorted."""
    out: dict[Labels, float] = {}
    for edge in edges:
        first, second = (labels[end] for end in edge.ends)
        if first is not None and second is not None and first != second:
            pair = (min(first, second), max(first, second))
            out[pair] = out.get(pair, 0.0) + edge.price(first, second)
    return out


def _least(same: UnionFind, count: int) -> list[int]:
    """Of every label, the least of its set."""
    least: dict[int, int] = {}
    for label in range(count):
        least.setdefault(same.find(label), label)
    return [least[same.find(label)] for label in range(count)]
