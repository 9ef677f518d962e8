"""Names that stand for one body: joints may name different parts of it.

Two joints that share no named part leave it open whether they share a body. So contact is followed from what no joint
may part down to what is dearer than a journal, as in Kruskal's spanning tree, and named parts that it joins are one
body; what is left, a bearing's ring that was named, goes where the least is parted (`joined_by_cost`). Names that
joints hang together already, directly or by way of others, close a loop if they are one: only where every joint can
then still move (`loops`). Where names alone connect all joints, legs that cross may just be drawn touching: there a
joint must also lack what goes round its axis unless they are one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

from kinform.foundation.graphs.graph import UnionFind
from kinform.kinematics.partition import constants
from kinform.kinematics.partition.labelling import Edge, Labels, Solved, label_all
from kinform.kinematics.partition.loops import Loops

Hold = tuple[float, tuple[int, int]]
"""What parting two nodes that touch costs at least, by whichever joint."""


def one_body(
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
        if price <= constants.PARTED:
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


def joined_by_cost(
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
    return _Search(seeds, edges, joints, loops).settled(list(together))


class _Search:
    """Which labels to join, by what is left to be parted."""

    def __init__(
        self, seeds: Mapping[int, int], edges: Sequence[Edge], joints: Sequence[Labels], loops: Loops | None
    ) -> None:
        self.seeds, self.edges, self.joints, self.loops = seeds, edges, joints, loops
        self.nodes = 1 + max([*seeds, *(node for edge in edges for node in edge.ends)], default=-1)
        self._solved: Solved = {}
        self._parted: dict[tuple[int, ...], dict[Labels, float]] = {}
        self._least: dict[tuple[int, ...], float] = {}

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
            self._parted[key] = _parted_between(*self.cut(now))
        return self._parted[key]

    def cut(self, now: Sequence[int]) -> tuple[tuple[int | None, ...], list[Edge]]:
        """The labels of all nodes when those that are `now` one are, and the edges with their prices then."""
        current = [edge.relabelled(now) for edge in self.edges]
        seeds = {node: now[label] for node, label in self.seeds.items()}
        return label_all(self.nodes, seeds, current, self._solved).labels, current

    def joined(self, now: list[int]) -> list[int]:
        """Labels with those joined that leave the least to be parted."""
        while True:
            ways = self.ways(now)
            if not ways:
                return now
            deep = len(self.hanging(now)) <= constants.LOOK_AHEAD
            cost, best = min((self.least(way) if deep else self.cost(way), way) for way in ways)
            if cost >= self.cost(now):
                return now
            now = best

    def settled(self, start: list[int]) -> tuple[list[int], set[int]]:
        """The best that is found from there by joining labels and moving them, and what could be elsewhere."""
        now = self.joined(start)
        while True:
            better, close = self.moved(now)
            if better is None:
                return now, close
            now = better

    def moved(self, now: Sequence[int]) -> tuple[list[int] | None, set[int]]:
        """Labels with one taken from those that it is one with and joined to others, where that saves as much as screw
        holes cost; else None, and the labels that this would touch at less or nearly the same cost. If only journals
        part, all stay."""
        if not self.dear(now):
            return None, set()
        cost = self.cost(now)
        close: set[int] = set()
        for label in range(len(now)):
            rest = [k for k, other in enumerate(now) if other == now[label] and k != label]
            if not rest:
                continue
            apart = [label if k == label else rest[0] if k in rest else one for k, one in enumerate(now)]
            if len(self._parted) > constants.MOST_CUTS:
                return None, close
            for way in self._likely(apart):
                there = self.cost(way)
                if there <= cost - constants.FASTENED["holes"]:
                    return way, close
                if there < cost + constants.PARTED:
                    close |= _differing(now, way)
        return None, close

    def dear(self, now: Sequence[int]) -> bool:
        """Whether anything is parted that costs more than serrations."""
        labels, current = self.cut(now)
        ends = [(edge, labels[edge.ends[0]], labels[edge.ends[1]]) for edge in current]
        return any(a is not None and b is not None and edge.price(a, b) > constants.PARTED for edge, a, b in ends)

    def _likely(self, now: Sequence[int]) -> list[list[int]]:
        """Labels with two joined that joints do not hang together: the few with most between them, and those that
        contact joins most firmly."""
        sets = self.hanging(now)
        bodies = sorted(set(now))
        ranked = []
        for k, first in enumerate(bodies):
            for second in bodies[k + 1 :]:
                if self.joins(now, sets, first, second):
                    ones, others = ([j for j, body in enumerate(now) if body == label] for label in (first, second))
                    ranked.append((-max(self.firm[a][b] for a in ones for b in others), first, second))
        firm = [(first, second) for _, first, second in sorted(ranked)[: constants.MOVES_TRIED]]
        across = sorted((-price, pair) for pair, price in self.parted(now).items())
        free = [pair for _, pair in across if self.joins(now, sets, *pair)]
        best = dict.fromkeys([*free[: constants.MOVES_TRIED], *firm])
        return [_with(now, first, second) for first, second in best]

    def joins(self, now: Sequence[int], sets: Sequence[set[int]], first: int, second: int) -> bool:
        """Whether two labels may be one body: joints do not hang them together, or the loop can move, and where names
        alone connect all joints a joint finds what goes round its axis only then."""
        if not any({first, second} <= labels for labels in sets):
            return True
        way = _with(now, first, second)
        if self.loops is None or not self.loops.move(way):
            return False
        return not self.loops.connected or self.asked(now, way)

    def asked(self, now: Sequence[int], way: Sequence[int]) -> bool:
        """Whether a joint has something that goes round its axis only if two labels are one: what none may part else,
        or what is inside of one body else."""
        before, after = self.on_axes(now), self.on_axes(way)
        having, others = {joint for joint, _ in before}, {ends for _, ends in before}
        if any(joint not in having and ends not in others for joint, ends in after):
            return True
        labels, current = self.cut(now)
        ends = [(edge, labels[edge.ends[0]], labels[edge.ends[1]]) for edge in current]
        broken = {
            edge.ends for edge, a, b in ends if a is not None and b is not None and edge.price(a, b) >= edge.broken
        }
        return bool(broken & {ends for _, ends in after})

    def on_axes(self, now: Sequence[int]) -> set[tuple[int, tuple[int, int]]]:
        """What joints part that goes round their axis: the joint, and the nodes."""
        labels, current = self.cut(now)
        found = set()
        for edge in current:
            a, b = (labels[end] for end in edge.ends)
            if a is None or b is None or a == b or (a, b) not in edge.parted:
                continue
            if edge.plain(a, b) <= constants.PARTED + constants.TOUCH_WORTH:
                found |= {
                    (k, edge.ends) for k, sides in enumerate(self.joints) if {now[one] for one in sides} == {a, b}
                }
        return found

    @cached_property
    def firm(self) -> list[list[float]]:
        """By how firm a chain of contacts each two labels are joined: the weakest of it, whatever is parted."""
        count = len(self.joints) and 1 + max(max(pair) for pair in self.joints)
        out = [[0.0] * count for _ in range(count)]
        sets = UnionFind(self.nodes)
        inside = {node: [label] for node, label in self.seeds.items()}
        for edge in sorted(self.edges, key=lambda edge: (-min([edge.broken, *edge.parted.values()]), edge.ends)):
            a, b = (sets.find(end) for end in edge.ends)
            if a == b:
                continue
            hold = min([edge.broken, *edge.parted.values()])
            for first in inside.get(a, ()):
                for second in inside.get(b, ()):
                    out[first][second] = out[second][first] = hold
            sets.union(a, b)
            inside[sets.find(a)] = [*inside.pop(a, ()), *inside.pop(b, ())]
        return out

    def cost(self, now: Sequence[int]) -> float:
        """All that is parted."""
        return sum(self.parted(now).values())

    def ways(self, now: Sequence[int]) -> list[list[int]]:
        """Labels with two joined that touch, and that may be one."""
        sets = self.hanging(now)
        return [_with(now, *pair) for pair in sorted(self.parted(now)) if self.joins(now, sets, *pair)]

    def least(self, now: Sequence[int]) -> float:
        """The cost of the best that may follow."""
        key = tuple(now)
        if key not in self._least:
            self._least[key] = min([self.cost(now), *(self.least(way) for way in self.ways(now))])
        return self._least[key]


def _with(now: Sequence[int], first: int, second: int) -> list[int]:
    """Labels with the second body joined to the first."""
    return [first if label == second else label for label in now]


def _differing(one: Sequence[int], other: Sequence[int]) -> set[int]:
    """Labels that are one with others here than there."""
    sets = [[frozenset(k for k, body in enumerate(way) if body == label) for label in way] for way in (one, other)]
    return {k for k, (here, there) in enumerate(zip(*sets, strict=True)) if here != there}


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
