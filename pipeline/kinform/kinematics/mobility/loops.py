"""Closure of the loops of one biconnected block: independent joint rates, each driven by one joint.

A block of few rates is decided by the singular values of all its closure equations at once (Davies 1981). A large one
is reduced loop by loop: six equations, recentred and rescaled on the loop, eliminate up to six rates, chosen by
pivoting, from all that depend on them; what is left are the freedoms. Equations and solutions stay sparse.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.screws import Frame, scaled
from kinform.foundation.algebra.vectors import cross
from kinform.foundation.graphs.cycles import Cycle, short_cycles
from kinform.model.arrays import Array

__all__ = ["Block", "Solution", "axes_frame", "close_block", "loop_matrix"]


CLOSED = 1e-7
"""Relative singular value below which a combination of joint rates closes its loops; the axes have
been made exactly parallel and coaxial before, so true zeros are rounding."""
SLIDE = 1e-9
"""A twist whose axis is farther away than the size of the assembly over this is a slide."""
SIGMAS = 3.0
"""Loops whose axes are in no such relation (Bennett's) close to this many times the uncertainty of the axes, ..."""
LOOSEST = 1e-4
"""... but to no more than this."""
SURE = (1e-10, 1e-5)
"""In the elimination, what is dropped is below the first and what is kept above the second, or else the decision is
left to singular values."""
FEW = 160
"""Blocks of at most so many joint rates are decided at once."""
MOST = 4000
"""Largest number of joint rates for which singular values are affordable."""
PIVOT = 0.3
"""Any column of at least this share of the largest may be chosen: preference decides among these."""
ROUNDING = 1e-10
"""Rates below this share of the largest of a solution are zero."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Joint rates that close all loops, driven by one coordinate whose rate is 1."""

    driver: int
    """Column of the driving rate."""
    columns: NDArray[np.int64]
    """Ascending."""
    rates: Array


@dataclass(frozen=True, eq=False)
class Block:
    """A biconnected block with its loops and what they leave free. Columns count the rates of its joints in order."""

    edges: tuple[int, ...]
    """Joints, ascending."""
    cycles: tuple[Cycle, ...]
    """A basis of its loops, the shortest first, over positions in `edges`."""
    frame: Frame
    solutions: tuple[Solution, ...]
    sure: bool = True
    """False: what is free was decided close to rounding."""


def close_block(
    edges: Sequence[tuple[int, int]], spaces: Sequence[Array], block: Sequence[int], prefer: Array, size: float,
    few: int = FEW, doubts: Array | None = None,
) -> Block:  # fmt: skip
    """Closure of the joints `block` (indices into `edges` and `spaces`).

    `prefer` (rates of the block,): a rate with a smaller number is rather chosen as driver. `size` of the assembly
    (m). Blocks of more than `few` rates are reduced loop by loop. `doubts` (joints, 2): uncertainty of the
    directions (rad) and places (m) of the axes of all joints.
    """
    own = [spaces[k] for k in block]
    count = sum(len(s) for s in own)
    if len(block) == 1:  # nothing closes, and nothing is compared in a frame
        free = tuple(Solution(c, np.array([c]), np.ones(1)) for c in range(count))
        return Block(tuple(block), (), Frame(np.zeros(3), size), free)
    frame = axes_frame(own, size)
    local = {n: i for i, n in enumerate(sorted({n for k in block for n in edges[k]}))}
    cycles = short_cycles(len(local), [(local[edges[k][0]], local[edges[k][1]]) for k in block])
    if count == 0:
        return Block(tuple(block), tuple(cycles), frame, ())
    norms = np.concatenate([np.linalg.norm(scaled(s.T, frame), axis=0) for s in own])
    solutions, sure = None, True
    if count > few:
        solutions, sure = _eliminated(own, cycles, norms, prefer, size)
    if solutions is None or (not sure and count <= MOST):
        closed = CLOSED
        if doubts is not None:
            blur = doubts[list(block)]
            closed = max(CLOSED, min(LOOSEST, SIGMAS * float((blur[:, 0] + blur[:, 1] / frame.length).max())))
        solutions, sure = _decomposed(loop_matrix(own, cycles, frame, norms), prefer, closed), True
    return Block(tuple(block), tuple(cycles), frame, _unscaled(solutions, norms), sure)


def loop_matrix(spaces: Sequence[Array], cycles: Sequence[Cycle], frame: Frame, norms: Array) -> Array:
    """(6 loops, rates) closure equations in scaled twists, each column divided by its norm."""
    start = np.concatenate([[0], np.cumsum([len(s) for s in spaces])]).astype(int)
    columns = np.hstack([scaled(s.T, frame) for s in spaces]) / norms
    matrix = np.zeros((6 * len(cycles), columns.shape[1]))
    for row, cycle in enumerate(cycles):
        for k, sign in cycle:
            here = slice(start[k], start[k + 1])
            matrix[6 * row : 6 * row + 6, here] = sign * columns[:, here]
    return matrix


def axes_frame(spaces: Sequence[Array], size: float) -> Frame:
    """Centre and size of the axes of some joints, so that turns and slides compare. Axes that meet have
    no size of their own: then a share of the assembly's counts."""
    turns = np.array([t for space in spaces for t in space if _turns(t, size)]).reshape(-1, 6)
    if not len(turns):
        return Frame(np.zeros(3), size)
    # the point of an axis nearest to the origin may be far away: take those nearest to the middle of all axes
    feet = _feet(turns, np.zeros(3))
    axes = turns[:, :3] / np.linalg.norm(turns[:, :3], axis=1)[:, None]
    across = np.eye(3) - axes[:, :, None] * axes[:, None, :]
    start = feet.mean(axis=0)
    missing = np.einsum("nij,nj->i", across, feet - start)
    centre = start + np.linalg.lstsq(across.sum(axis=0), missing, rcond=1e-6)[0]
    frame = Frame.of(np.vstack([_feet(turns, centre), centre]))
    return Frame(frame.centre, max(frame.length, 0.05 * size))


def _turns(twist: Array, size: float) -> bool:
    """Whether a twist turns, beyond the rounding of a slide."""
    return float(np.linalg.norm(twist[:3])) * size > SLIDE * float(np.linalg.norm(twist[3:]))


def _feet(turns: Array, centre: Array) -> Array:
    """(n, 3) points of the axes of the twists (n, 6) nearest to `centre`."""
    omega = turns[:, :3]
    velocity = turns[:, 3:] + cross(omega, centre)
    feet: Array = centre + cross(omega, velocity) / (omega**2).sum(axis=1)[:, None]
    return feet


def _decomposed(matrix: Array, prefer: Array, closed: float) -> list[Solution]:
    """Solutions from the singular values of all equations at once."""
    _, values, right = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(values > closed * max(values[0], 1e-300))) if len(values) else 0
    null: Array = right[rank:]
    drivers = _chosen(null, prefer, len(null))
    # the preferred column that is well conditioned drives; all others follow from these
    reduced = np.linalg.solve(null[:, drivers], null)
    reduced[:, drivers] = np.eye(len(drivers))
    out = []
    for driver, row in sorted(zip(drivers, reduced, strict=True), key=lambda pair: pair[0]):
        columns = np.flatnonzero(np.abs(row) > ROUNDING * np.abs(row).max())
        out.append(Solution(driver, columns, row[columns]))
    return out


def _chosen(matrix: Array, prefer: Array, count: int) -> list[int]:
    """So many columns of the matrix that are independent, by pivoting with preference."""
    rest = matrix.copy()
    chosen: list[int] = []
    for _ in range(count):
        norms = np.linalg.norm(rest, axis=0)
        norms[chosen] = 0.0
        good = np.flatnonzero(norms >= PIVOT * norms.max())
        best = int(good[np.argmin(prefer[good])])
        chosen.append(best)
        unit = rest[:, best] / norms[best]
        rest -= np.outer(unit, unit @ rest)
    return chosen


def _eliminated(
    spaces: Sequence[Array], cycles: Sequence[Cycle], norms: Array, prefer: Array, size: float
) -> tuple[list[Solution], bool]:
    """Solutions by eliminating rates loop by loop, and whether every decision on the way was clear."""
    start = np.concatenate([[0], np.cumsum([len(s) for s in spaces])]).astype(int)
    depends: list[dict[int, float]] = [{c: 1.0} for c in range(int(start[-1]))]
    users: list[set[int]] = [{c} for c in range(int(start[-1]))]
    sure = True
    for cycle in _by_place(cycles):
        frame = axes_frame([spaces[k] for k, _ in cycle], size)
        lever: dict[int, Array] = {}
        scale = 0.0
        for k, sign in cycle:
            columns = sign * scaled(spaces[k].T, frame) / norms[start[k] : start[k + 1]]
            scale = max(scale, float(np.linalg.norm(columns, axis=0).max(initial=0.0)))
            for n, column in enumerate(range(start[k], start[k + 1])):
                for free, factor in depends[column].items():
                    lever[free] = lever.get(free, 0.0) + factor * columns[:, n]
        free_columns = np.array(sorted(lever), dtype=np.int64)
        if not len(free_columns):
            continue
        matrix = np.array([lever[int(c)] for c in free_columns]).T / scale
        pivots, clear = _pivots(matrix, prefer[free_columns])
        sure &= clear
        if pivots:
            _substitute(depends, users, free_columns, matrix, pivots)
    return _collected(depends), sure


def _by_place(cycles: Sequence[Cycle]) -> list[Cycle]:
    """The loops in an order in which each lies beside those before it, so that few rates are open at a time."""
    around: dict[int, list[int]] = {}
    for n, cycle in enumerate(cycles):
        for k, _ in cycle:
            around.setdefault(k, []).append(n)
    order: list[int] = []
    seen = [False] * len(cycles)
    for first in range(len(cycles)):
        if seen[first]:
            continue
        queue, seen[first] = [first], True
        for n in queue:
            order.append(n)
            for other in sorted({m for k, _ in cycles[n] for m in around[k] if not seen[m]}):
                seen[other] = True
                queue.append(other)
    return [cycles[n] for n in order]


def _pivots(matrix: Array, prefer: Array) -> tuple[list[int], bool]:
    """Columns that the equations (6, n) determine, the least preferred first, and whether that is clear."""
    rest = matrix.copy()
    pivots: list[int] = []
    clear = True
    while len(pivots) < min(rest.shape):
        norms = np.linalg.norm(rest, axis=0)
        norms[pivots] = 0.0
        largest = float(norms.max())
        clear &= largest < SURE[0] or largest > SURE[1]
        if largest < CLOSED:
            break
        good = np.flatnonzero(norms >= PIVOT * largest)
        best = int(good[np.argmax(prefer[good])])
        pivots.append(best)
        unit = rest[:, best] / norms[best]
        rest -= np.outer(unit, unit @ rest)
        rest -= np.outer(unit, unit @ rest)
    return pivots, clear


def _substitute(
    depends: list[dict[int, float]], users: list[set[int]], columns: NDArray[np.int64], matrix: Array, pivots: list[int]
) -> None:
    """Express the pivots by the other columns of the equations, wherever they are used."""
    others = [n for n in range(len(columns)) if n not in set(pivots)]
    factors = -np.linalg.lstsq(matrix[:, pivots], matrix[:, others], rcond=None)[0]
    for pivot, row in zip((int(columns[p]) for p in pivots), factors, strict=True):
        keep = np.flatnonzero(np.abs(row) > 1e-13)
        by = [(int(columns[others[n]]), float(row[n])) for n in keep]
        for user in users[pivot]:
            own = depends[user]
            share = own.pop(pivot)
            for free, factor in by:
                total = own.get(free, 0.0) + share * factor
                if abs(total) > 1e-14:
                    own[free] = total
                    users[free].add(user)
                else:
                    own.pop(free, None)
                    users[free].discard(user)
        users[pivot] = set()


def _collected(depends: list[dict[int, float]]) -> list[Solution]:
    rows: dict[int, list[tuple[int, float]]] = {}
    for column, by in enumerate(depends):
        for free, factor in by.items():
            rows.setdefault(free, []).append((column, factor))
    out = []
    for driver in sorted(rows):
        largest = max(abs(f) for _, f in rows[driver])
        kept = [(c, f) for c, f in rows[driver] if abs(f) > ROUNDING * largest]
        out.append(Solution(driver, np.array([c for c, _ in kept]), np.array([f for _, f in kept])))
    return out


def _unscaled(solutions: Sequence[Solution], norms: Array) -> tuple[Solution, ...]:
    """In rad/s and m/s of the joints' own twists, the driver at 1."""
    return tuple(Solution(s.driver, s.columns, s.rates * norms[s.driver] / norms[s.columns]) for s in solutions)
