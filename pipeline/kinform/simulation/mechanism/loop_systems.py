"""Loops that share nothing are systems of their own: what is found for one has nothing to do with the others.

n loops side by side so cost n times what one costs, not n³.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinform.foundation.graphs.graph import UnionFind
from kinform.foundation.rounding import ARITHMETIC
from kinform.model.arrays import Array, Ints
from kinform.simulation.mechanism.mechanism import Mechanism


def systems_of_loops(shares: Array) -> tuple[Ints, Ints]:
    """System of each thing (n,), −1 of one that no loop has, and of each loop (C,), from what loops have of each thing
    (n, C), not nought. Systems are numbered as their first loops are."""
    things, loops = shares.shape
    sets = UnionFind(loops)
    first: dict[int, int] = {}
    rows, columns = np.nonzero(shares)
    for thing, loop in zip(rows.tolist(), columns.tolist(), strict=True):
        sets.union(first.setdefault(thing, loop), loop)
    _, of_loop = np.unique([sets.find(loop) for loop in range(loops)], return_inverse=True)
    of_thing = np.full(things, -1)
    of_thing[rows] = of_loop[columns]
    return of_thing, np.asarray(of_loop)


def alike(*of: Ints) -> Iterator[tuple[Ints, ...]]:
    """Systems of one size together: of each kind of things, whose systems are given (n,), the numbers (systems, m)."""
    count = max((int(one.max(initial=-1)) for one in of), default=-1) + 1
    lists = list(zip(*(_members(one, count) for one in of), strict=True))
    sizes = [tuple(len(numbers) for numbers in system) for system in lists]
    for size in sorted(set(sizes)):
        same = [system for system, other in zip(lists, sizes, strict=True) if other == size]
        yield tuple(np.stack(numbers) for numbers in zip(*same, strict=True))


def _members(of: Ints, count: int) -> list[Ints]:
    order = np.argsort(of, kind="stable")
    bounds = np.searchsorted(of[order], np.arange(count + 1)).tolist()
    return [order[first:last] for first, last in zip(bounds, bounds[1:], strict=False)]


def loop_values(mechanism: Mechanism, screws: Array) -> Array:
    """(T, k) singular values, descending, of what the rates of a mechanism with loops or gears do to them, over their
    scale, at screws (T, n, 6) of the rates. Gears make one system of all."""
    if len(mechanism.gear_v):
        found = np.linalg.svd(mechanism.closure(screws) * mechanism.scale, compute_uv=False)
        return np.asarray(found, dtype=np.float64)
    moves = mechanism.moves[mechanism.closures[:, 1]] - mechanism.moves[mechanism.closures[:, 0]]
    scaled = mechanism.loop_screws(screws) * mechanism.scale[:, None]
    parts = []
    for rates, loops in alike(*systems_of_loops(moves.T)):
        share = moves[loops[:, :, None], rates[:, None, :]]
        rows = _short(share[:, :, None, :] * scaled[:, rates].swapaxes(-1, -2)[:, :, None], share)
        values = np.linalg.svd(rows.reshape(len(screws), len(loops), -1, rates.shape[1]), compute_uv=False)
        parts.append(values.reshape(len(screws), -1))
    out = np.zeros((len(screws), min(6 * len(moves), mechanism.rates)))
    every = np.concatenate(parts, axis=1)
    out[:, : every.shape[1]] = -np.sort(-every, axis=1)
    return out


def _short(rows: Array, share: Array) -> Array:
    """(T, G, c, r, m) as few rows of each loop as its rates can move, with the singular values of the six (T, G, c, 6,
    m) but for rounding; `share` (G, c, m), nought where a rate is none of the loop's."""
    count = int(np.count_nonzero(share, axis=2).max())
    if share.shape[1] == 1 or count >= share.shape[2]:
        return rows
    own = np.argsort(share == 0.0, axis=2, kind="stable")[None, :, :, None, :count]
    _, values, right = np.linalg.svd(np.take_along_axis(rows, own, axis=4), full_matrices=False)
    least = ARITHMETIC * values.max(axis=(1, 2, 3), initial=0.0, keepdims=True)
    many = max(1, int(np.count_nonzero(values > least, axis=3).max()))
    out = np.zeros((*rows.shape[:3], many, rows.shape[4]))
    np.put_along_axis(out, own, values[..., :many, None] * right[..., :many, :], axis=4)
    return out
