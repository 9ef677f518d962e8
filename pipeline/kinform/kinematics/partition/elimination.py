"""The labels of nodes that make a sum of costs least, where no other labels come near it: node after node eliminated.

Costs are of single nodes and of pairs. All that has one node is added up and its least over the node's labels kept, a
table over the nodes beside it; so with the next, until none is left (Bertelè and Brioschi, Nonserial Dynamic
Programming, 1972). Beside the least cost every table has the second least, of other labels. Where the two differ
clearly, the labels are those that any solver must give. Regions of contact are nearly trees, so that tables stay small.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from kinform.model.arrays import Array

CLEARLY_LESS = 1e-4
"""Cost by which the best labels are better than all others where no solver can take others for as good: a hundred times
what the integer program may miss. Sums of prices are known to 1e-10."""
MOST_IN_TABLE = 50_000
"""Numbers in a table of costs, of all labels of a few nodes together, up to which nodes are eliminated: beyond, the
integer program is as quick. Chosen, not measured."""


_Table = tuple[tuple[int, ...], Array, Array]
"""Nodes, ascending, with the least and the second least cost by their labels, an axis a node."""


def clear_labels(own: Array, pairs: Mapping[tuple[int, int], Array]) -> list[int] | None:
    """The label of every node, from its own costs (nodes, labels) and those of pairs of nodes (a, b), a < b, by the
    labels of both (labels, labels), two labels at least. None where others cost as little but for rounding, or tables
    would be large."""
    nodes, wide = own.shape
    order = _order(nodes, pairs, wide)
    if order is None:
        return None
    tables: list[_Table] = [((k,), row, np.full(wide, np.inf)) for k, row in enumerate(own)]
    tables += [(ends, cost, np.full((wide, wide), np.inf)) for ends, cost in pairs.items()]
    kept: list[_Table] = []
    for node in order:
        mine = [table for table in tables if node in table[0]]
        tables = [table for table in tables if node not in table[0]]
        around, least, second = _sum(mine, wide)
        axis = around.index(node)
        kept.append((around, least, second))
        two = np.partition(least, 1, axis=axis)
        rest = np.minimum(second.min(axis=axis), two.take(1, axis))
        tables.append((around[:axis] + around[axis + 1 :], np.asarray(two.take(0, axis)), rest))
    _, best, rest = _sum(tables, wide)
    if not float(rest) - float(best) > CLEARLY_LESS:
        return None
    labels: dict[int, int] = {}
    for node, (around, least, _) in zip(reversed(order), reversed(kept), strict=True):
        labels[node] = int(least[tuple(slice(None) if one == node else labels[one] for one in around)].argmin())
    return [labels[k] for k in range(nodes)]


def _order(nodes: int, pairs: Mapping[tuple[int, int], Array], wide: int) -> list[int] | None:
    """The nodes, one with fewest beside it first, where all tables have few numbers."""
    beside: list[set[int]] = [set() for _ in range(nodes)]
    for a, b in pairs:
        beside[a].add(b)
        beside[b].add(a)
    left = set(range(nodes))
    out = []
    while left:
        node = min(left, key=lambda one: (len(beside[one]), one))
        near = beside[node]
        if wide ** (len(near) + 1) > MOST_IN_TABLE:
            return None
        for one in near:
            beside[one] |= near
            beside[one] -= {one, node}
        left.remove(node)
        out.append(node)
    return out


def _sum(tables: Sequence[_Table], wide: int) -> _Table:
    """One table of the sum of all."""
    around = tuple(sorted({node for nodes, _, _ in tables for node in nodes}))
    least, second = np.zeros((wide,) * len(around)), np.full((wide,) * len(around), np.inf)
    for nodes, low, next_ in tables:
        shape = [wide if node in nodes else 1 for node in around]
        low, next_ = low.reshape(shape), next_.reshape(shape)
        second = np.minimum(second + low, least + next_)
        least = least + low
    return around, least, second
