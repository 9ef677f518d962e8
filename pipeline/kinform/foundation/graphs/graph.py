"""Questions about graphs: components, biconnected blocks, spanning trees. No physics here.

Nodes are 0 … n−1, edges pairs of nodes, in the order given; all answers are in that order.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable, Mapping, Sequence
from typing import TypeVar

from kinform.frozen import dataclass

Edge = tuple[int, int]
Node = TypeVar("Node", bound=Hashable)


class UnionFind:
    """Disjoint sets; the representative is the smallest member."""

    def __init__(self, size: int):
        self.parent = list(range(size))

    def find(self, node: int) -> int:
        """Representative of the node's set."""
        while self.parent[node] != node:
            self.parent[node] = self.parent[self.parent[node]]
            node = self.parent[node]
        return node

    def union(self, a: int, b: int) -> None:
        """Make the sets of a and b one."""
        a, b = sorted((self.find(a), self.find(b)))
        self.parent[b] = a


@dataclass(frozen=True)
class Forest:
    """Spanning forest: parent node, edge to the parent (−1 at roots), nodes in breadth-first order."""

    parent: tuple[int, ...]
    edge: tuple[int, ...]
    order: tuple[int, ...]
    root: tuple[int, ...]

    def depths(self) -> list[int]:
        """Number of edges from each node to its root."""
        depth = [0] * len(self.parent)
        for node in self.order:
            if self.parent[node] >= 0:
                depth[node] = depth[self.parent[node]] + 1
        return depth


def neighbours(nodes: int, edges: Sequence[Edge]) -> list[list[tuple[int, int]]]:
    """For each node its (neighbour, edge) pairs."""
    out: list[list[tuple[int, int]]] = [[] for _ in range(nodes)]
    for k, (a, b) in enumerate(edges):
        out[a].append((b, k))
        out[b].append((a, k))
    return out


def forest(nodes: int, edges: Sequence[Edge], first: int) -> Forest:
    """Breadth-first spanning forest whose first tree grows from node `first`."""
    near = neighbours(nodes, edges)
    parent, edge, root = [-1] * nodes, [-1] * nodes, [-1] * nodes
    order: list[int] = []
    for start in (first, *range(nodes)):
        if root[start] >= 0:
            continue
        root[start] = start
        queue = [start]
        for node in queue:
            order.append(node)
            for other, k in near[node]:
                if root[other] < 0:
                    parent[other], edge[other], root[other] = node, k, start
                    queue.append(other)
    return Forest(tuple(parent), tuple(edge), tuple(order), tuple(root))


def blocks(nodes: int, edges: Sequence[Edge]) -> list[list[int]]:
    """Biconnected components as lists of edge indices (Hopcroft and Tarjan 1973, without recursion).

    A component of one edge is a bridge. Parallel edges belong to one component. `low` is the least depth that a node's
    subtree reaches by an edge beside the tree: where that is no less than the depth of the node above, the edges on the
    stack since then are a component.
    """
    near = neighbours(nodes, edges)
    depth, low = [-1] * nodes, [0] * nodes
    used = [False] * len(edges)
    stack: list[int] = []
    components: list[list[int]] = []
    for start in range(nodes):
        if depth[start] >= 0:
            continue
        depth[start] = low[start] = 0
        path: list[list[int]] = [[start, 0, -1]]
        while path:
            node, position, via = path[-1]
            if position < len(near[node]):
                path[-1][1] += 1
                other, k = near[node][position]
                if used[k]:
                    continue
                used[k] = True
                stack.append(k)
                if depth[other] < 0:
                    depth[other] = low[other] = depth[node] + 1
                    path.append([other, 0, k])
                else:
                    low[node] = min(low[node], depth[other])
                continue
            path.pop()
            if path:
                above = path[-1][0]
                low[above] = min(low[above], low[node])
                if low[node] >= depth[above]:
                    block = [stack.pop()]
                    while block[-1] != via:
                        block.append(stack.pop())
                    components.append(sorted(block))
    return sorted(components)


def shortest_path(near: Mapping[Node, Sequence[Node]], start: Node, end: Node) -> list[Node]:
    """Nodes of a shortest path, both ends included; empty where there is none. Neighbours are tried in their order."""
    came: dict[Node, Node] = {start: start}
    waiting = deque([start])
    while waiting and end not in came:
        node = waiting.popleft()
        for other in near.get(node, ()):
            if other not in came:
                came[other] = node
                waiting.append(other)
    if end not in came:
        return []
    path = [end]
    while path[-1] != start:
        path.append(came[path[-1]])
    return path[::-1]
