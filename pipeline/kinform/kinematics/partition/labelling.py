"""The cheapest body for every part: a multiway cut of the graph of contacts, as an integer program.

Nodes are what is one body anyway; some are seeds, whose body is known. Every edge says what it costs to put its two
ends into two bodies: less where a joint of these two bodies may part it. A node that no seed's contacts reach has no
label. What seeds separate is solved on its own, so that programs stay small; most are so clear that nodes are
eliminated instead (`elimination`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.graphs.graph import UnionFind
from kinform.frozen import dataclass
from kinform.kinematics.partition.elimination import clear_labels
from kinform.model.arrays import Array

JAMMED = 25.0
"""Price, beside `BROKEN`, of contact that no joint may part between two bodies that stated joints connect: it is in the
way of the joint, and that of others is not. Less than any face, so that it only decides between a face and a journal;
what it decides is listed."""
MOST_SECONDS = 60.0
"""s: what the integer program may take before the best answer so far is taken and said to be unproven. Chosen, not
measured."""


Labels = tuple[int, int]


@dataclass(frozen=True)
class Edge:
    """A contact between two nodes."""

    ends: tuple[int, int]
    parted: Mapping[Labels, float]
    """Price for the labels of the first and the second end, where a joint of the two bodies parts it."""
    broken: float
    """Price for any other two labels."""
    hint: float = 0.0
    """What of these prices is there because something suggests that its ends are fastened."""
    jointed: frozenset[Labels] = frozenset()
    """Labels of bodies with joints: where none of these may part it, it would be in the way of them."""

    def price(self, first: int, second: int) -> float:
        """What it costs that its ends have these labels."""
        if first == second:
            return 0.0
        parted = self.parted.get((first, second))
        return self.broken + self.jam(first, second) if parted is None else min(parted, self.broken)

    def jam(self, first: int, second: int) -> float:
        """What of that is there because it is in the way of joints."""
        jams = first != second and (first, second) in self.jointed and (first, second) not in self.parted
        return JAMMED if jams else 0.0

    def plain(self, first: int, second: int) -> float:
        """The same by contact alone, whatever suggests that its ends are fastened."""
        return 0.0 if first == second else self.price(first, second) - self.hint


@dataclass(frozen=True, eq=False)
class Labelling:
    """The label of every node, and how it came about."""

    labels: tuple[int | None, ...]
    proven: bool
    """Whether the integer programs were solved to the end."""


def label_all(nodes: int, seeds: Mapping[int, int], edges: Sequence[Edge]) -> Labelling:
    """Labels of all nodes that make the sum of the prices least; `seeds` have theirs."""
    labels: list[int | None] = [seeds.get(node) for node in range(nodes)]
    proven = True
    for members, near in regions(nodes, seeds, edges):
        touched = {seeds[n] for edge in near for n in edge.ends if n in seeds}
        # a body that touches nothing here may be on the other side of a joint that does
        candidates = sorted(touched | {b for edge in near for a, b in edge.parted if a in touched})
        if candidates:
            found, sure = labels_of(members, candidates, near, seeds)
            proven &= sure
            for node, label in found.items():
                labels[node] = label
    return Labelling(tuple(labels), proven)


def regions(nodes: int, seeds: Mapping[int, int], edges: Sequence[Edge]) -> list[tuple[list[int], list[Edge]]]:
    """Nodes without a seed, those together that contacts without seeds connect, with all contacts around them."""
    sets = UnionFind(nodes)
    for edge in edges:
        if seeds.keys().isdisjoint(edge.ends):
            sets.union(*edge.ends)
    out: dict[int, tuple[list[int], list[Edge]]] = {}
    for node in range(nodes):
        if node not in seeds:
            out.setdefault(sets.find(node), ([], []))[0].append(node)
    for edge in edges:
        free = next((node for node in edge.ends if node not in seeds), None)
        if free is not None:
            out[sets.find(free)][1].append(edge)
    return [out[root] for root in sorted(out)]


def labels_of(
    members: Sequence[int], candidates: Sequence[int], edges: Sequence[Edge], seeds: Mapping[int, int]
) -> tuple[dict[int, int], bool]:
    """The labels of a region's nodes among some, sorted, and whether they are proven; `edges` are those around it."""
    if len(candidates) == 1:
        return dict.fromkeys(members, candidates[0]), True
    clear = clear_labels(*_costs(members, candidates, edges, seeds))
    if clear is not None:
        return {node: candidates[k] for node, k in zip(members, clear, strict=True)}, True
    return _solve(members, candidates, edges, seeds)


def _costs(
    members: Sequence[int], candidates: Sequence[int], edges: Sequence[Edge], seeds: Mapping[int, int]
) -> tuple[Array, dict[Labels, Array]]:
    """What labels cost each node (nodes, labels), by its contacts with seeds, and each two nodes (labels, labels)."""
    place = {node: k for k, node in enumerate(members)}
    own = np.zeros((len(members), len(candidates)))
    pairs: dict[Labels, Array] = {}
    for edge in edges:
        first, second = edge.ends
        if first in seeds:
            own[place[second]] += [edge.price(seeds[first], label) for label in candidates]
        elif second in seeds:
            own[place[first]] += [edge.price(label, seeds[second]) for label in candidates]
        else:
            cost = np.array([[edge.price(a, b) for b in candidates] for a in candidates])
            ends = place[first], place[second]
            if ends[0] > ends[1]:
                ends, cost = ends[::-1], cost.T
            pairs[ends] = pairs[ends] + cost if ends in pairs else cost
    return own, pairs


def _solve(
    members: Sequence[int], candidates: Sequence[int], edges: Sequence[Edge], seeds: Mapping[int, int]
) -> tuple[dict[int, int], bool]:
    """The labels of some nodes, by an integer program.

    x[i, l]: node i has label l. Of an edge between two nodes, y[a, b] says that its ends have the labels a and b, for
    equal labels and for those that a joint parts; what is left of 1 is broken, and if that jams a joint, one more of
    its own says so. With y below x on both sides the relaxation is that of the local polytope, and mostly whole.
    """
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import coo_matrix

    place = {node: k for k, node in enumerate(members)}
    number = {label: k for k, label in enumerate(candidates)}
    wide = len(candidates)
    cost = [0.0] * (len(members) * wide)
    rows: list[int] = []
    columns: list[int] = []
    values: list[float] = []
    lowest: list[float] = []
    highest: list[float] = []

    def constrain(terms: Sequence[tuple[int, float]], low: float, high: float) -> None:
        for column, value in terms:
            rows.append(len(lowest))
            columns.append(column)
            values.append(value)
        lowest.append(low)
        highest.append(high)

    for k in range(len(members)):
        constrain([(k * wide + c, 1.0) for c in range(wide)], 1.0, 1.0)
    for edge in edges:
        first, second = edge.ends
        if first in seeds or second in seeds:
            free, fixed = (second, first) if first in seeds else (first, second)
            for label, c in number.items():
                ends = (seeds[fixed], label) if fixed == first else (label, seeds[fixed])
                cost[place[free] * wide + c] += edge.price(*ends)
            continue
        allowed = [(a, a) for a in candidates]
        pairs = [(a, b) for a in candidates for b in candidates if a != b]
        allowed += [ends for ends in pairs if ends in edge.parted and edge.price(*ends) < edge.broken]
        at = len(cost)
        cost += [edge.price(*ends) - edge.broken for ends in allowed]
        for side, node in enumerate((first, second)):
            for label, c in number.items():
                terms = [(at + k, 1.0) for k, ends in enumerate(allowed) if ends[side] == label]
                constrain([*terms, (place[node] * wide + c, -1.0)], -np.inf, 0.0)
        for one, other in (ends for ends in pairs if edge.jam(*ends)):
            both = (place[first] * wide + number[one], place[second] * wide + number[other])
            constrain([(both[0], 1.0), (both[1], 1.0), (len(cost), -1.0)], -np.inf, 1.0)
            cost.append(JAMMED)
    whole = np.zeros(len(cost))
    whole[: len(members) * wide] = 1
    answer = milp(
        np.array(cost),
        constraints=LinearConstraint(
            coo_matrix((values, (rows, columns)), shape=(len(lowest), len(cost))), lowest, highest
        ),
        integrality=whole,
        bounds=Bounds(0.0, 1.0),
        options={"time_limit": MOST_SECONDS, "mip_rel_gap": 0.0},
    )
    if answer.x is None:
        return dict.fromkeys(members, candidates[0]), False
    chosen: Array = np.asarray(answer.x)[: len(members) * wide].reshape(-1, wide)
    return {node: candidates[int(np.argmax(chosen[place[node]]))] for node in members}, bool(answer.status == 0)


@dataclass(frozen=True)
class Margin:
    """By how much the next best label of a node is dearer, and which that is; with the nodes that go along."""

    cost: float
    label: int | None
    along: tuple[int, ...]
    moves: bool
    """Whether joints may part all that would be parted then: nothing but likelihood speaks against it."""
    plain: float = np.inf
    """By how much such a label is dearer at least by contact alone: screw holes line up across true joints, too."""


def margins(labels: Sequence[int | None], seeds: Mapping[int, int], edges: Sequence[Edge]) -> dict[int, Margin]:
    """The margin of every labelled node that is no seed.

    Nodes of one label are joined in the order of what holds them, the dearest first; each cluster so made is offered
    the labels that it touches. A node's margin is that of the cheapest cluster around it.
    """
    nodes = len(labels)
    around: dict[int, list[Edge]] = {}
    for edge in edges:
        for end in edge.ends:
            around.setdefault(end, []).append(edge)
    best: dict[int, Margin] = {}
    clusters = {n: {n} for n in range(nodes) if labels[n] is not None and n not in seeds}
    sets = UnionFind(nodes)

    def offer(members: set[int]) -> None:
        label = labels[next(iter(members))]
        outward = [e for n in sorted(members) for e in around.get(n, ()) if len(members & set(e.ends)) == 1]
        assert label is not None
        touched = {labels[n] for e in outward for n in e.ends if n not in members}
        across = {b for e in outward for a, b in e.parted if a == label}
        for other in sorted({one for one in touched | across if one is not None} - {label}):
            change, plain, moves = 0.0, 0.0, True
            for edge in outward:
                inner = edge.ends[0] in members
                beyond = labels[edge.ends[1] if inner else edge.ends[0]]
                if beyond is None:
                    continue
                then, now = (((one, beyond) if inner else (beyond, one)) for one in (other, label))
                change += edge.price(*then) - edge.price(*now)
                plain += edge.plain(*then) - edge.plain(*now)
                broken = label != beyond and now not in edge.parted
                moves &= other == beyond or then in edge.parted or broken
            for node in members:
                known = best.get(node)
                least = min(np.inf if known is None else known.plain, plain if moves else np.inf)
                if known is None or (not moves, change) < (not known.moves, known.cost):
                    known = Margin(change, other, tuple(sorted(members)), moves)
                best[node] = replace(known, plain=least)

    for members in clusters.values():
        offer(members)
    joined = [e for e in edges if labels[e.ends[0]] == labels[e.ends[1]] and not set(e.ends) & set(seeds)]
    for edge in sorted(joined, key=lambda e: (-_hold(e), e.ends)):
        one, two = (sets.find(end) for end in edge.ends)
        if one == two or labels[edge.ends[0]] is None:
            continue
        together = clusters.pop(one) | clusters.pop(two)
        sets.union(one, two)
        clusters[sets.find(one)] = together
        offer(together)
    return best


def _hold(edge: Edge) -> float:
    """How firmly an edge holds, whatever the labels."""
    return min([edge.broken, *edge.parted.values()])
