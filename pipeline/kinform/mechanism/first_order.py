"""Closure of the whole assembly in joint rates, block by block: which rates are left, and how many.

Blocks of the graph of bodies and joints close independently; a bridge adds all its freedoms (Davies 1981 for the
closure equations). The docstring of the package has an example.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from kinform.foundation.graphs.graph import Forest, blocks, forest
from kinform.frozen import dataclass
from kinform.mechanism.block_rates import FEW_RATES, Block, Solution, close_block
from kinform.model.arrays import Array

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False)
class Closure:
    """Solutions of the closure equations. Rates: freedoms of all joints, in order, then 6 a loose tree."""

    solutions: tuple[Solution, ...]
    """Independent joint rates, sparse: block by block, then those of loose trees."""
    blocks: tuple[Block, ...]
    block_of: tuple[int, ...]
    """Block of each solution; −1 for those of loose trees."""
    tree: Forest
    offset: tuple[int, ...]
    """First rate of each joint, and their number."""
    loose: tuple[int, ...]
    """Roots of the trees that are not connected to ground."""

    @property
    def mobility(self) -> int:
        """Dimension of the null space of the bilateral constraints, relative to ground."""
        return len(self.solutions)

    @property
    def sparse_rates(self) -> csr_array:
        """(k, n) the solutions as a sparse matrix."""
        from scipy.sparse import csr_array

        counts = [len(s.columns) for s in self.solutions]
        rows = np.repeat(np.arange(len(counts)), counts)
        columns = np.concatenate([np.zeros(0, np.int64), *(s.columns for s in self.solutions)])
        values = np.concatenate([np.zeros(0), *(s.rates for s in self.solutions)])
        shape = (len(counts), self.offset[-1] + 6 * len(self.loose))
        return csr_array((values, (rows, columns)), shape=shape)

    @property
    def rates(self) -> Array:
        """(k, n) the solutions as a dense matrix: for small assemblies."""
        out = np.zeros((len(self.solutions), self.offset[-1] + 6 * len(self.loose)))
        for row, solution in zip(out, self.solutions, strict=True):
            row[solution.columns] = solution.rates
        return out


def close(
    nodes: int, edges: Sequence[tuple[int, int]], spaces: Sequence[Array], ground: int, size: float = 1.0,
    doubts: Array | None = None, few: int = FEW_RATES,
) -> Closure:  # fmt: skip
    """Closure of joints between bodies 0 … nodes−1; `spaces[k]` is the (f, 6) twist basis of joint k,
    of its second body relative to its first, at the world's origin; `size` of the assembly (m);
    `doubts` (joints, 2): uncertainty of the directions (rad) and places (m) of the joints.
    Blocks of more than `few` joint rates are reduced loop by loop."""
    offset = np.cumsum([0, *map(len, spaces)])
    tree = forest(nodes, edges, ground)
    loose = sorted({r for r in tree.root if r != tree.root[ground]})
    prefer = _preference(edges, spaces, tree)
    solutions: list[Solution] = []
    closed: list[Block] = []
    block_of: list[int] = []
    for n, block in enumerate(blocks(nodes, edges)):
        columns = np.concatenate([np.arange(offset[k], offset[k + 1]) for k in block])
        closed.append(close_block(edges, spaces, block, prefer[columns], size, few, doubts))
        solutions += [Solution(int(columns[s.driver]), columns[s.columns], s.rates) for s in closed[-1].solutions]
        block_of += [n] * len(closed[-1].solutions)
    driven = range(int(offset[-1]), int(offset[-1]) + 6 * len(loose))
    solutions += [Solution(k, np.array([k]), np.ones(1)) for k in driven]
    block_of += [-1] * len(driven)
    return Closure(tuple(solutions), tuple(closed), tuple(block_of), tree, tuple(offset.tolist()), tuple(loose))


def _preference(edges: Sequence[tuple[int, int]], spaces: Sequence[Array], tree: Forest) -> Array:
    """(rates,) which rates rather drive: of joints with one freedom, near to ground, in their order."""
    depth = tree.depths()
    rank = sorted(range(len(edges)), key=lambda k: (len(spaces[k]) > 1, min(depth[n] for n in edges[k]), k))
    place = np.empty(len(edges), dtype=np.int64)
    place[rank] = np.arange(len(edges))
    wide = max((len(s) for s in spaces), default=0) + 1
    ranks = [wide * place[k] + np.arange(len(space)) for k, space in enumerate(spaces)]
    return np.concatenate([np.zeros(0), *ranks])


def body_twists(closure: Closure, edges: Sequence[tuple[int, int]], spaces: Sequence[Array]) -> Array:
    """(k, nodes, 6) twists (ω; v at the world's origin) of all bodies for each solution."""
    tree, offset, rates = closure.tree, closure.offset, closure.rates
    out = np.zeros((closure.mobility, len(tree.parent), 6))
    for n, root in enumerate(closure.loose):
        at = offset[-1] + 6 * n
        out[:, root] = rates[:, at : at + 6]
    for node in tree.order:
        if tree.parent[node] < 0:
            continue
        k = tree.edge[node]
        relative = rates[:, offset[k] : offset[k + 1]] @ spaces[k]
        forward = 1.0 if edges[k][1] == node else -1.0
        out[:, node] = out[:, tree.parent[node]] + forward * relative
    return out
