"""Closure of the loops of one biconnected block: independent joint rates, each driven by one joint.

A block of few rates is decided by the singular values of all its closure equations at once (Davies 1981). A large one
is reduced loop by loop: six equations, recentred and rescaled on the loop, eliminate up to six rates, chosen by
pivoting, from all that depend on them; what is left are the freedoms. Equations and solutions stay sparse.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.screws import Frame, scaled
from kinform.foundation.graphs.cycles import Cycle, short_cycles
from kinform.foundation.rounding import ARITHMETIC, SOLVED, TINY
from kinform.frozen import dataclass
from kinform.mechanism.constants import FREE, SIGMAS
from kinform.mechanism.frame import axes_frame
from kinform.model.arrays import Array, Ints

LOOSEST_CLOSED = 1e-4
"""Loops whose axes are in no relation that snapping knows (Bennett's) close to `SIGMAS` times the uncertainty of the
axes, but to no more than this relative singular value. Chosen, not measured."""
FEW_RATES = 160
"""Blocks of at most so many joint rates are decided at once. Chosen, not measured."""
MOST_RATES = 4000
"""Largest number of joint rates for which singular values are affordable. Chosen, not measured."""
SURE_KEPT = 1e-5
"""In the elimination, what is dropped is below `SOLVED` and what is kept above this, or else the decision is left to
singular values. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Joint rates that close all loops, driven by one coordinate whose rate is 1."""

    driver: int
    """Column of the driving rate."""
    columns: Ints
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
    few: int = FEW_RATES, doubts: Array | None = None,
) -> Block:  # fmt: skip
    """Closure of the joints `block` (indices into `edges` and `spaces`).

    `prefer` (rates of the block,): a rate with a smaller number is rather chosen as driver. `size` of the assembly
    (m). Blocks of more than `few` rates are reduced loop by loop. `doubts` (joints, 2): uncertainty of the
    directions (rad) and places (m) of the axes of all joints.
    """
    members = [spaces[k] for k in block]
    count = sum(map(len, members))
    if len(block) == 1:  # nothing closes, and nothing is compared in a frame
        free = tuple(Solution(c, np.array([c]), np.ones(1)) for c in range(count))
        return Block(tuple(block), (), Frame(np.zeros(3), size), free)
    frame = axes_frame(members, size)
    local = {n: i for i, n in enumerate(sorted({n for k in block for n in edges[k]}))}
    cycles = short_cycles(len(local), [(local[edges[k][0]], local[edges[k][1]]) for k in block])
    if count == 0:
        return Block(tuple(block), tuple(cycles), frame, ())
    norms = np.concatenate([np.linalg.norm(scaled(s.T, frame), axis=0) for s in members])
    solutions, sure = None, True
    if count > few:
        solutions, sure = _eliminate(members, cycles, norms, prefer, size)
    if solutions is None or (not sure and count <= MOST_RATES):
        closed = max(FREE, frame.rounding)
        if doubts is not None:
            blur = doubts[list(block)]
            closed = max(
                closed,
                min(LOOSEST_CLOSED, SIGMAS * float((blur[:, 0] + blur[:, 1] / frame.length).max())),
            )
        nothing = max(SOLVED, frame.rounding)
        solutions, sure = _decompose(loop_matrix(members, cycles, frame, norms), prefer, closed, nothing), True
    return Block(tuple(block), tuple(cycles), frame, _in_joint_units(solutions, norms), sure)


def loop_matrix(spaces: Sequence[Array], cycles: Sequence[Cycle], frame: Frame, norms: Array) -> Array:
    """(6 loops, rates) closure equations in scaled twists, each column divided by its norm."""
    start = np.cumsum([0, *map(len, spaces)])
    columns = np.hstack([scaled(s.T, frame) for s in spaces]) / norms
    matrix = np.zeros((6 * len(cycles), columns.shape[1]))
    for row, cycle in enumerate(cycles):
        for k, sign in cycle:
            here = slice(start[k], start[k + 1])
            matrix[6 * row : 6 * row + 6, here] = sign * columns[:, here]
    return matrix


def _decompose(matrix: Array, prefer: Array, closed: float, nothing: float) -> list[Solution]:
    """Solutions from the singular values of all equations at once; shares of the largest singular value and of the
    largest rate of a solution that are zero."""
    _, values, right = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(values > closed * max(values[0], TINY))) if len(values) else 0
    null: Array = right[rank:]
    drivers, _ = _pivots(null, -prefer)
    # the preferred column that is well conditioned drives; all others follow from these
    reduced = np.linalg.solve(null[:, drivers], null)
    reduced[:, drivers] = np.eye(len(drivers))
    out = []
    for driver, row in sorted(zip(drivers, reduced, strict=True), key=lambda pair: pair[0]):
        columns = np.flatnonzero(np.abs(row) > nothing * np.abs(row).max())
        out.append(Solution(driver, columns, row[columns]))
    return out


def _eliminate(
    spaces: Sequence[Array], cycles: Sequence[Cycle], norms: Array, prefer: Array, size: float
) -> tuple[list[Solution], bool]:
    """Solutions by eliminating rates loop by loop, and whether every decision on the way was clear.

    `depends[c]`: of each rate c, by which rates it is expressed so far, and with which factors; at first by itself. A
    loop's six equations are written in the rates that are free by then, and determine up to six of them.
    `users[c]`: the rates that are expressed by c.
    """
    start = np.cumsum([0, *map(len, spaces)])
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
    return _solutions(depends), sure


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
    """Independent columns of the matrix (m, n), at most m, and whether their number is clear.

    Of the columns that are hardly shorter than the longest, each time the one with the greatest `prefer` (n,) is taken,
    and taken out of the others (twice, for what rounding leaves).
    """
    rest = matrix.copy()
    pivots: list[int] = []
    clear = True
    while len(pivots) < min(rest.shape):
        norms = np.linalg.norm(rest, axis=0)
        norms[pivots] = 0.0
        largest = float(norms.max())
        clear &= largest < SOLVED or largest > SURE_KEPT
        if largest < FREE:
            break
        # Any column of at least this share of the largest may be chosen: preference decides among these.
        good = np.flatnonzero(norms >= 0.3 * largest)
        best = int(good[np.argmax(prefer[good])])
        pivots.append(best)
        unit = rest[:, best] / norms[best]
        rest -= np.outer(unit, unit @ rest)
        rest -= np.outer(unit, unit @ rest)
    return pivots, clear


def _substitute(
    depends: list[dict[int, float]], users: list[set[int]], columns: Ints, matrix: Array, pivots: list[int]
) -> None:
    """Express the pivots by the other columns of the equations, wherever they are used."""
    others = [n for n in range(len(columns)) if n not in set(pivots)]
    factors = -np.linalg.lstsq(matrix[:, pivots], matrix[:, others], rcond=None)[0]
    for pivot, row in zip((int(columns[p]) for p in pivots), factors, strict=True):
        keep = np.flatnonzero(np.abs(row) > ARITHMETIC)
        by = [(int(columns[others[n]]), float(row[n])) for n in keep]
        for user in users[pivot]:
            factors_of = depends[user]
            share = factors_of.pop(pivot)
            for free, factor in by:
                total = factors_of.get(free, 0.0) + share * factor
                if abs(total) > ARITHMETIC:
                    factors_of[free] = total
                    users[free].add(user)
                else:
                    factors_of.pop(free, None)
                    users[free].discard(user)
        users[pivot] = set()


def _solutions(depends: list[dict[int, float]]) -> list[Solution]:
    """One for each rate that is left free, with all rates that are expressed by it."""
    rows: dict[int, list[tuple[int, float]]] = {}
    for column, by in enumerate(depends):
        for free, factor in by.items():
            rows.setdefault(free, []).append((column, factor))
    out = []
    for driver in sorted(rows):
        largest = max(abs(f) for _, f in rows[driver])
        kept = [(c, f) for c, f in rows[driver] if abs(f) > SOLVED * largest]
        out.append(Solution(driver, np.array([c for c, _ in kept]), np.array([f for _, f in kept])))
    return out


def _in_joint_units(solutions: Sequence[Solution], norms: Array) -> tuple[Solution, ...]:
    """In rad/s and m/s of the joints' own twists, the driver at 1."""
    return tuple(Solution(s.driver, s.columns, s.rates * norms[s.driver] / norms[s.columns]) for s in solutions)
