"""Short loops of a graph: a basis of its cycles that people recognise. No physics here.

Few edges: a minimum cycle basis (Horton 1987). Many: the shortest cycle through each edge, as far as these are
independent, and cycles of a spanning tree for the rest.
"""

from __future__ import annotations

from collections.abc import Sequence

from kinform.foundation.graphs.graph import Edge, forest, neighbours

Cycle = tuple[tuple[int, int], ...]
"""(edge, +1 or −1) in the order of walking; +1 from the edge's first node to its second."""

FEW = 60
"""Edges up to which every cycle of Horton's set is tried: the set grows with the product of nodes and edges. Chosen,
not measured."""


def short_cycles(nodes: int, edges: Sequence[Edge]) -> list[Cycle]:
    """A basis of short cycles of a connected graph without loops of one edge, the shortest first."""
    wanted = len(edges) - nodes + 1
    if wanted <= 0:
        return []
    near = neighbours(nodes, edges)
    found = _horton(edges, near) if len(edges) <= FEW else _through_edges(edges, near)
    found.sort(key=lambda cycle: (len(cycle), sorted(cycle)))
    kept = _independent(found, wanted, {})
    if len(kept) < wanted:
        kept += _fundamental(nodes, edges, kept, wanted)
    return [_walk(edges, cycle) for cycle in kept]


def _horton(edges: Sequence[Edge], near: list[list[tuple[int, int]]]) -> list[tuple[int, ...]]:
    """Cycles through each node and each edge along shortest paths, as sorted edges."""
    found = set()
    for start in range(len(near)):
        path = _paths(near, start)
        for k, (a, b) in enumerate(edges):
            if k in path[a] or k in path[b] or set(path[a]) & set(path[b]):
                continue
            found.add(tuple(sorted({*path[a], *path[b], k})))
    return sorted(found)


def _paths(near: list[list[tuple[int, int]]], start: int) -> list[tuple[int, ...]]:
    """Edges of a shortest path from `start` to every node."""
    path: list[tuple[int, ...] | None] = [None] * len(near)
    path[start] = ()
    queue = [start]
    for node in queue:
        own = path[node]
        assert own is not None
        for other, k in near[node]:
            if path[other] is None:
                path[other] = (*own, k)
                queue.append(other)
    return [p or () for p in path]


def _through_edges(edges: Sequence[Edge], near: list[list[tuple[int, int]]]) -> list[tuple[int, ...]]:
    """A shortest cycle through each edge, as sorted edges."""
    found = set()
    for k, (a, b) in enumerate(edges):
        back: dict[int, tuple[int, int]] = {a: (-1, -1)}
        queue = [a]
        for node in queue:
            if b in back:
                break
            for other, via in near[node]:
                if via != k and other not in back:
                    back[other] = (node, via)
                    queue.append(other)
        if b not in back:
            continue
        cycle, node = [k], b
        while node != a:
            node, via = back[node]
            cycle.append(via)
        found.add(tuple(sorted(cycle)))
    return sorted(found)


def _independent(cycles: list[tuple[int, ...]], wanted: int, pivots: dict[int, int]) -> list[tuple[int, ...]]:
    """The first `wanted` cycles that no sum of others (modulo 2) is; `pivots` keeps what they span."""
    kept: list[tuple[int, ...]] = []
    for cycle in cycles:
        if len(kept) == wanted:
            break
        mask = 0
        for k in cycle:
            mask |= 1 << k
        while mask:
            top = mask.bit_length()
            if top not in pivots:
                pivots[top] = mask
                kept.append(cycle)
                break
            mask ^= pivots[top]
    return kept


def _fundamental(nodes: int, edges: Sequence[Edge], kept: list[tuple[int, ...]], wanted: int) -> list[tuple[int, ...]]:
    """Cycles of a spanning tree that complete the basis."""
    pivots: dict[int, int] = {}
    _independent(kept, wanted, pivots)
    tree = forest(nodes, edges, 0)
    inside = set(tree.edge)
    found = []
    for k, (a, b) in enumerate(edges):
        if k in inside:
            continue
        own = {k}
        for node in (a, b):
            while tree.parent[node] >= 0:
                own ^= {tree.edge[node]}
                node = tree.parent[node]
        found.append(tuple(sorted(own)))
    found.sort(key=lambda cycle: (len(cycle), cycle))
    return _independent(found, wanted - len(kept), pivots)


def _walk(edges: Sequence[Edge], cycle: Sequence[int]) -> Cycle:
    """The cycle in the order of walking, from its smallest node along its smallest edge there."""
    around: dict[int, list[int]] = {}
    for k in cycle:
        for node in edges[k]:
            around.setdefault(node, []).append(k)
    node = start = min(around)
    edge = min(around[start])
    steps: list[tuple[int, int]] = []
    while not steps or node != start:
        forward = edges[edge][0] == node
        steps.append((edge, 1 if forward else -1))
        node = edges[edge][1 if forward else 0]
        edge = next(k for k in around[node] if k != edge)
    return tuple(steps)
