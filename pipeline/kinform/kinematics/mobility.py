"""Mobility of the whole: loop closure in joint rates, block by block.

Blocks of the graph of bodies and joints close independently; a bridge adds all its freedoms
(design section 4; Davies 1981 for the closure equations). Definitions: see the results contract.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.graph import Forest, blocks, forest
from kinform.kinematics.screws import Frame, cross_product, scaled

__all__ = ["Closure", "body_twists", "close"]

Array = NDArray[np.float64]

CLOSED = 1e-7
"""Relative singular value below which a combination of joint rates closes its loops; the axes have
been made exactly parallel and coaxial before, so true zeros are rounding."""


@dataclass(frozen=True, eq=False)
class Closure:
    """Solutions of the closure equations."""

    rates: Array
    """(k, n) independent joint rates; n = freedoms of all joints, in order, then 6 a loose tree."""
    tree: Forest
    offset: tuple[int, ...]
    """First rate of each joint."""
    loose: tuple[int, ...]
    """Roots of the trees that are not connected to ground."""

    @property
    def mobility(self) -> int:
        """Dimension of the null space of the bilateral constraints, relative to ground."""
        return len(self.rates)


def close(
    nodes: int, edges: Sequence[tuple[int, int]], spaces: Sequence[Array], ground: int, size: float = 1.0
) -> Closure:
    """Closure of joints between bodies 0 … nodes−1; `spaces[k]` is the (f, 6) twist basis of joint k,
    of its second body relative to its first, at the world's origin; `size` of the assembly (m)."""
    offset = np.concatenate([[0], np.cumsum([len(s) for s in spaces])]).astype(int)
    tree = forest(nodes, edges, ground)
    loose = sorted({r for r in tree.root if r != tree.root[ground]})
    total = int(offset[-1]) + 6 * len(loose)
    rates: list[Array] = []
    for block in blocks(nodes, edges):
        for solution in _close_block(edges, spaces, block, size):
            row, at = np.zeros(total), 0
            for k in block:
                row[offset[k] : offset[k + 1]] = solution[at : at + len(spaces[k])]
                at += len(spaces[k])
            rates.append(row)
    for k in range(6 * len(loose)):
        row = np.zeros(total)
        row[offset[-1] + k] = 1.0
        rates.append(row)
    return Closure(np.array(rates).reshape(len(rates), total), tree, tuple(int(o) for o in offset), tuple(loose))


def _close_block(edges: Sequence[tuple[int, int]], spaces: Sequence[Array], block: Sequence[int], size: float) -> Array:
    """Null space (k, rates of the block) of the closure of all its independent loops."""
    count = sum(len(spaces[k]) for k in block)
    if count == 0:
        return np.zeros((0, 0))
    if len(block) == 1:
        return np.eye(count)
    local = {n: i for i, n in enumerate(sorted({n for k in block for n in edges[k]}))}
    inner = [(local[edges[k][0]], local[edges[k][1]]) for k in block]
    tree = forest(len(local), inner, 0)
    frame = _frame([spaces[k] for k in block], size)
    columns = np.concatenate([[0], np.cumsum([len(spaces[k]) for k in block])])
    twists = [scaled(spaces[k].T, frame) for k in block]
    twists = [t / np.maximum(np.linalg.norm(t, axis=0), 1e-300) for t in twists]
    norms = np.concatenate([np.linalg.norm(scaled(spaces[k].T, frame), axis=0) for k in block])
    loops = [k for k in range(len(block)) if k not in set(tree.edge)]
    matrix = np.zeros((6 * len(loops), count))
    for row, k in enumerate(loops):
        here = slice(6 * row, 6 * row + 6)
        matrix[here, columns[k] : columns[k + 1]] += twists[k]
        for end, sign in ((inner[k][0], 1.0), (inner[k][1], -1.0)):
            node = end
            while tree.parent[node] >= 0:
                e = tree.edge[node]
                forward = 1.0 if inner[e][1] == node else -1.0
                matrix[here, columns[e] : columns[e + 1]] += sign * forward * twists[e]
                node = tree.parent[node]
    _, values, right = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(values > CLOSED * max(values[0], 1e-300))) if len(values) else 0
    null: Array = right[rank:] / norms
    return null


def _frame(spaces: Sequence[Array], size: float) -> Frame:
    """Centre and size of the axes of a block, so that turns and slides compare. Axes that meet have
    no size of their own: then a share of the assembly's counts."""
    turns = np.array([t for space in spaces for t in space if np.any(t[:3])]).reshape(-1, 6)
    if not len(turns):
        return Frame(np.zeros(3), size)
    centre = _feet(turns, np.zeros(3)).mean(axis=0)
    # the point of an axis nearest to the origin may be far away: take that nearest to the centre
    frame = Frame.of(np.vstack([_feet(turns, centre), centre]))
    return Frame(frame.centre, max(frame.length, 0.05 * size))


def _feet(turns: Array, centre: Array) -> Array:
    """(n, 3) points of the axes of the twists (n, 6) nearest to `centre`."""
    omega = turns[:, :3]
    velocity = turns[:, 3:] + cross_product(omega, centre)
    feet: Array = centre + cross_product(omega, velocity) / (omega**2).sum(axis=1)[:, None]
    return feet


def body_twists(closure: Closure, edges: Sequence[tuple[int, int]], spaces: Sequence[Array]) -> Array:
    """(k, nodes, 6) twists (ω; v at the world's origin) of all bodies for each solution."""
    tree, offset = closure.tree, closure.offset
    out = np.zeros((closure.mobility, len(tree.parent), 6))
    for n, root in enumerate(closure.loose):
        at = offset[-1] + 6 * n
        out[:, root] = closure.rates[:, at : at + 6]
    for node in tree.order:
        if tree.parent[node] < 0:
            continue
        k = tree.edge[node]
        relative = closure.rates[:, offset[k] : offset[k + 1]] @ spaces[k]
        forward = 1.0 if edges[k][1] == node else -1.0
        out[:, node] = out[:, tree.parent[node]] + forward * relative
    return out
