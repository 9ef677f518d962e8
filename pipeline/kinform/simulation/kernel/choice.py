"""Which rows of the loops are independent and which rates dependent, at a known rank.

Never compiled: it is called a few times a run.
"""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Ints
from kinform.simulation.constants import CLOSING_PIVOT
from kinform.simulation.kernel.loops import gather

from kinform.simulation.kernel.layout import (  # isort: skip
    COUNTS, COLUMNS, CLOSURES, MODE, SCALE, GEARS, ROWS, VECTORS,
    RANK, RATES, SIGNAL, CHOSEN, ORDER, PLACE,
    REFERENCE,
    Nums, Work,
)  # fmt: skip


def choose(ints: Ints, nums: Nums, work: Work) -> None:
    """Picks rows and dependent rates by complete pivoting, those of closing joints first; writes the
    mode and its pivots."""
    n, rank = ints[COUNTS][0][RATES], ints[COUNTS][0][RANK]
    count = 6 * len(ints[CLOSURES]) + len(nums[GEARS])
    mode, scale = ints[MODE], np.array(nums[SCALE])
    led, closing = np.array(ints[COLUMNS])[:, SIGNAL] >= 0, scale[:, 1] > 0.0
    mode[CHOSEN][:count] = range(count)
    mode[ORDER][:n] = range(n)
    mode[PLACE][:n] = range(n)
    gather(ints, nums, work, count)
    rows = np.array(work[ROWS])[:count] * scale[:, 0]
    left = np.ones(count, dtype=bool)
    chosen: list[int] = []
    dependent: list[int] = []
    for _ in range(rank):
        size = np.abs(rows) * left[:, None]
        size[:, led] = -1.0
        size[:, dependent] = -1.0
        preferred = np.where(closing, size, -1.0)
        best = preferred if preferred.max() > CLOSING_PIVOT else size
        row, column = (int(k) for k in np.unravel_index(int(np.argmax(best)), best.shape))
        work[VECTORS][REFERENCE][len(chosen)] = max(float(best[row, column]), 1e-300)
        left[row] = False
        chosen.append(row)
        dependent.append(column)
        others = left & (rows[:, column] != 0.0)
        rows[others] -= np.outer(rows[others, column] / rows[row, column], rows[row])
    free = [k for k in range(n) if not led[k] and k not in dependent]
    order = dependent + free + np.flatnonzero(led).tolist()
    mode[CHOSEN][:rank] = chosen
    mode[ORDER][:n] = order
    for place, column in enumerate(order):
        mode[PLACE][column] = place
