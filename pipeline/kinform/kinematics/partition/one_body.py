"""Names that stand for one body: joints may name different parts of it.

Two joints that share no named part leave it open whether they share a body. So contact is followed from what no joint
may part down to what is dearer than a journal, as in Kruskal's spanning tree, and named parts that it joins are one
body, unless joints hang them together already, directly or by way of others; what is left, a bearing's ring that was
named, goes where the least is parted (`joined_by_cost`). Names that hang together stay apart, as legs that cross are
drawn touching, too: that they touch is reported, and a group says that they are one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from kinform.foundation.graphs.graph import UnionFind
from kinform.kinematics.partition import constants
from kinform.kinematics.partition.labelling import Edge, Labels, Solved, label_all

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
    """The same of labels that only journals lie between: those are joined that leave the least to be parted, all ways
    looked at where these are few, else again and again the best two. Those `together` are known to be one body.
    """
    now = list(together)
    search = _Search(seeds, edges, joints)
    while True:
        ways = search.ways(now)
        if not ways:
            return now
        hanging = len(search.hanging(now))
        deep = hanging <= constants.LOOK_AHEAD
        cost, best = min((search.least(way) if deep else search.cost(way), way) for way in ways)
        if cost >= search.cost(now):
            return now
        now = best


class _Search:
    """Which labels to join, by what is left to be parted."""

    def __init__(self, seeds: Mapping[int, int], edges: Sequence[Edge], joints: Sequence[Labels]) -> None:
        self.seeds, self.edges, self.joints = seeds, edges, joints
        self.nodes = 1 + max([*seeds, *(node for edge in edges for node in edge.ends)], default=-1)
        self._solved: Solved = {}
        self._parted: dict[tuple[int, ...], dict[Labels, float]] = {}

    def hanging(self, now: Sequence[int]) -> list[set[int]]:
        """Sets of labels that joints hang together."""
        sets = UnionFind(len(now))
        for label, other in enumerate(now):
            sets.union(label, other)
        for pair in self.joints:
            sets.union(*pair)
        out: dict[int, set[int]] = {}
        for label in range(len(now)):
            out.setdefault(sets.find(label), set()).add(now[label])
        return list(out.values())

    def parted(self, now: Sequence[int]) -> dict[Labels, float]:
        """What is parted between every two labels, sorted, when those that are `now` one are."""
        key = tuple(now)
        if key not in self._parted:
            current = [edge.relabelled(now) for edge in self.edges]
            seeds = {node: now[label] for node, label in self.seeds.items()}
            self._parted[key] = _parted_between(label_all(self.nodes, seeds, current, self._solved).labels, current)
        return self._parted[key]

    def cost(self, now: Sequence[int]) -> float:
        """All that is parted."""
        return sum(self.parted(now).values())

    def ways(self, now: Sequence[int]) -> list[list[int]]:
        """Labels with two joined that touch, and that joints do not hang together."""
        sets = self.hanging(now)
        out = []
        for first, second in sorted(self.parted(now)):
            if not any({first, second} <= labels for labels in sets):
                out.append([first if label == second else label for label in now])
        return out

    def least(self, now: Sequence[int]) -> float:
        """The cost of the best that may follow."""
        return min([self.cost(now), *(self.least(way) for way in self.ways(now))])


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
