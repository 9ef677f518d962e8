"""Which rows of the loops are independent and which rates dependent, at a known rank.

Never compiled: it is called a few times a run.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kinform.foundation.rounding import TINY
from kinform.model.arrays import Array, Flags, Ints
from kinform.simulation.kernel.loops import gather

from kinform.simulation.kernel.layout import (  # isort: skip
    COUNTS, LINKS, COLUMNS, CLOSURES, MODE, SCALE, GEARS, ROWS, VECTORS,
    RANK, LED, RATES, PARENT, LINK, BEFORE, SIGNAL, METER, WEIGHT, TENSOR, CHOSEN, ORDER, PLACE, STANDING, WAY,
    MOVED, LED_RATE, MASSLESS_RATE, MASSLESS_COLUMN, ARMATURE,
    REFERENCE,
    Nums, Work,
)  # fmt: skip


def choose_pivots(ints: Ints, nums: Nums, work: Work) -> None:
    """Picks rows and dependent rates by complete pivoting, those of closing joints first; writes the
    mode and its pivots."""
    n, rank = ints[COUNTS][0][RATES], ints[COUNTS][0][RANK]
    count = 6 * len(ints[CLOSURES]) + len(nums[GEARS])
    mode, scale = ints[MODE], np.array(nums[SCALE])
    led, closing = np.array(ints[COLUMNS])[:, SIGNAL] >= 0, scale[:, MASSLESS_COLUMN] > 0.0
    mode[CHOSEN][:count] = range(count)
    mode[ORDER][:n] = range(n)
    mode[PLACE][:n] = range(n)
    gather(ints, nums, work, count)
    rows = np.array(work[ROWS])[:count] * scale[:, 0]
    left = np.ones(count, dtype=bool)
    chosen: list[int] = []
    dependent: list[int] = []
    # of each row the largest rates that may be dependent, any and of closing joints: only rows that change are searched
    most = _Largest(rows, ~led), _Largest(rows, closing & ~led)
    for _ in range(rank):
        # Pivots of the joints that close loops are taken first while they are larger than this: a choice. Entries are
        # scaled to about 1; small pivots lose digits.
        best = most[1] if most[1].size.max() > 0.3 else most[0]
        row = int(np.argmax(best.size))
        column = int(best.place[row])
        work[VECTORS][REFERENCE][len(chosen)] = max(float(best.size[row]), TINY)
        left[row] = False
        chosen.append(row)
        dependent.append(column)
        others = np.flatnonzero(left & (rows[:, column] != 0.0))
        rows[others] -= np.outer(rows[others, column] / rows[row, column], rows[row])
        for one in most:
            one.without(row, column, rows, others)
    free = [k for k in range(n) if not led[k] and k not in dependent]
    order = dependent + free + np.flatnonzero(led).tolist()
    mode[CHOSEN][:rank] = chosen
    mode[ORDER][:n] = order
    for place, column in enumerate(order):
        mode[PLACE][column] = place


class _Largest:
    """Of each row the largest entry in columns that are allowed, and the first place that has it; −1 without any."""

    def __init__(self, rows: Array, allowed: Flags):
        self._allowed = allowed.copy()
        self.size, self.place = self._search(rows)

    def without(self, row: int, column: int, rows: Array, changed: Ints) -> None:
        """From now on without this row and column, where other rows have changed; those that have not are nought in
        the column."""
        self._allowed[column] = False
        self.size[row] = -1.0
        self.size[changed], self.place[changed] = self._search(rows[changed])

    def _search(self, rows: Array) -> tuple[Array, Ints]:
        size = np.where(self._allowed, np.abs(rows), -1.0)
        place = np.argmax(size, axis=1)
        return size[np.arange(len(rows)), place], place


def choose_method(ints: Ints, nums: Nums) -> None:
    """Decides whether articulated bodies are the way to solve with the rows and rates chosen, by what both ways cost,
    and writes what they make of each rate: all that is not led has mass to move, or follows from a row."""
    n, rank, led = ints[COUNTS][0][RATES], ints[COUNTS][0][RANK], ints[COUNTS][0][LED]
    links, columns = (np.array(ints[table], dtype=np.int64) for table in (LINKS, COLUMNS))
    columns, mode = columns.reshape(n, METER + 1), ints[MODE]
    heavy: Any = (np.array(nums[LINKS])[:, [WEIGHT, *range(TENSOR, TENSOR + 12, 4)]] > 0.0).any(axis=1)
    for link in range(len(links) - 1, 0, -1):
        heavy[links[link, PARENT]] |= heavy[link]
    depth = np.zeros(n)
    for k in range(n):
        depth[k] = 1 + (depth[columns[k, BEFORE]] if columns[k, BEFORE] >= 0 else 0)
    moves = heavy[columns[:, LINK]] | (np.array(nums[SCALE]).reshape(n, ARMATURE + 1)[:, ARMATURE] > 0.0)
    standing = np.where(columns[:, SIGNAL] >= 0, LED_RATE, np.where(moves, MOVED, MASSLESS_RATE))
    loose, rest = np.flatnonzero(standing == MASSLESS_RATE), n - rank
    rows = rank - len(loose)
    # Multiplications, of either: reduced mass matrices, or passes along the tree and a matrix of the rows.
    through_rows = 2 * depth.sum() * rest + rank * rest**2 / 2 + rest**3 / 6
    reduced = through_rows if rank or led else (depth**2).sum() / 2
    # Multiplications a rate of one pass of articulated bodies along the tree (`choose_method`). Counted; with it the
    # two ways take as long as each other where they are said to.
    passes = 200 * n * (rows + 2) + rows * n * rows / 2 + rows**3 / 6
    wanted = passes < reduced and set(loose.tolist()) <= set(np.array(mode[ORDER])[:rank].tolist())
    mode[STANDING][:n] = standing.tolist()
    mode[WAY][0] = int(wanted)
