"""Which boxes of one kind meet which of another, pair by pair."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.concatenation import concatenated
from kinform.foundation.meshes.boxes import BOXES_MATRIX, FlatBoxes, meeting_box
from kinform.foundation.rounding import SOLVED, TINY
from kinform.model.arrays import Array, Ints

BOXES_COMPARED = 1_500_000
"""Boxes times boxes up to which all are compared where neither kind is very many: 1 ms, and a grid takes 0.5 to 4
ms."""
BOXES_EXACT = 20_000
"""Boxes times boxes up to which they are compared as they are: to convert them to steps of a scale takes 0.04 ms."""
BOXES_MOST = 50_000
"""Boxes of either kind up to which a grid is made of them. Beyond, trees of FCL are faster."""
BESIDE_MOST = 100_000
"""Pairs in common cells up to which they are compared: a few milliseconds, in which FCL makes a tree of 1000 facets."""


Boxes = tuple[Array, Array]
"""Lower and upper corners (n, 3)."""


def meeting_boxes(first: Boxes, second: Boxes, most: float = math.inf) -> tuple[Ints, Ints] | None:
    """Indices (k,) of boxes (n, 3) and (m, 3) that meet, by the first, then by the second; None of so many that a tree
    is quicker, and of more than `most`.

    Few are all compared. Of more, the second are listed by the cells of a grid across the two coordinates along which
    boxes are smallest beside the whole, grown by what the largest of the first reach from their middles.
    """
    count, others = len(first[0]), len(second[0])
    if count * others <= BOXES_MATRIX:
        return _compared(first, second, most)
    if max(count, others) > BOXES_MOST:
        return None
    if count * others <= BOXES_COMPARED:
        return _compared(first, second, most)
    (low, high), (low_other, high_other) = first, second
    whole = np.maximum(high.max(axis=0), high_other.max(axis=0)) - np.minimum(low.min(axis=0), low_other.min(axis=0))
    share = whole / np.maximum((high - low).mean(axis=0) + (high_other - low_other).mean(axis=0), TINY)
    axes = np.sort(np.argsort(share, kind="stable")[1:])
    reach = 0.5 * (high - low).max(axis=0)[axes] * (1.0 + SOLVED)
    middles = 0.5 * (low + high)
    listed = FlatBoxes(low_other[:, axes] - reach, high_other[:, axes] + reach)
    if listed.listed_at(middles[:, axes]) > BESIDE_MOST:
        return None
    return _unless_more(most, _that_meet(first, second, *listed.around(middles[:, axes])))


def meeting_in_slabs(first: Boxes, second: Boxes) -> tuple[Ints, Ints] | None:
    """The same pairs (k,) of boxes (n, 3) and (m, 3), ordered by the first, then by the second, where either are too
    many to be compared at once: what can meet at all is looked at in slabs across the direction along which the first
    spread most. None where a slab has too many yet, or there would be many of them: each looks at all boxes."""
    (low, high), (low_other, high_other) = first, second
    if not len(low) or not len(low_other):
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    near = np.flatnonzero(meeting_box(low_other, high_other, low.min(axis=0), high.max(axis=0)))
    if not len(near):
        return near, near
    low_other, high_other = low_other[near], high_other[near]
    asked = np.flatnonzero(meeting_box(low, high, low_other.min(axis=0), high_other.max(axis=0)))
    if not len(asked):
        return asked, asked
    low, high = low[asked], high[asked]
    slabs = min(-(-len(asked) * len(near) // BOXES_MATRIX), len(asked))
    # more slabs than this take longer than trees; the horns of the motors of so101 need 30
    if slabs > 100:
        return None
    order = np.argsort(low[:, int(np.argmax(np.ptp(low, axis=0)))], kind="stable") if slabs > 1 else np.arange(len(low))
    found = []
    for own in np.array_split(order, slabs):
        own_low, own_high = low[own], high[own]
        beside = np.flatnonzero(meeting_box(low_other, high_other, own_low.min(axis=0), own_high.max(axis=0)))
        met = meeting_boxes((own_low, own_high), (low_other[beside], high_other[beside]))
        if met is None:
            return None
        found.append(asked[own[met[0]]] * np.int64(len(second[0])) + near[beside[met[1]]])
    return _split(np.sort(concatenated(found)), len(second[0]))


def _unless_more(most: float, met: tuple[Ints, Ints]) -> tuple[Ints, Ints] | None:
    return None if len(met[0]) > most else met


def _that_meet(first: Boxes, second: Boxes, one: Ints, two: Ints) -> tuple[Ints, Ints]:
    """Those pairs of boxes `one` (k,) of the first and `two` (k,) of the second that meet."""
    (low, high), (low_other, high_other) = first, second
    for axis in range(3):
        meets = low[:, axis].take(one) <= high_other[:, axis].take(two)
        meets &= low_other[:, axis].take(two) <= high[:, axis].take(one)
        one, two = one[meets], two[meets]
    return one, two


def _compared(first: Boxes, second: Boxes, most: float) -> tuple[Ints, Ints] | None:
    """The same as `meeting_boxes`, of few: numpy compares bytes eight times as fast as floating numbers, and boxes that
    meet do so in steps of a scale, too."""
    columns, width = [np.ascontiguousarray(side.T) for side in (*first, *second)], len(second[0])
    if len(first[0]) * width <= BOXES_EXACT:
        return _unless_more(most, _split(_all_compared(columns), width))
    least = np.minimum(columns[0].min(axis=1), columns[2].min(axis=1))
    greatest = np.maximum(columns[1].max(axis=1), columns[3].max(axis=1))
    step = ((2**8 - 1) / np.maximum(greatest - least, 1e-290))[:, None]
    flat = _all_compared([((column - least[:, None]) * step).astype(np.uint8) for column in columns])
    # of very many the first tell that they are too many
    if len(flat) > 2.0 * most and len(_that_meet(first, second, *_split(flat[: int(2.0 * most)], width))[0]) > most:
        return None
    return _unless_more(most, _that_meet(first, second, *_split(flat, width)))


def _all_compared(columns: list[NDArray[Any]]) -> Ints:
    """Pairs that meet, of boxes by lower and upper corners, (3, n) each, of the first and (3, m) of the second: m times
    the first and the second."""
    low, high, low_other, high_other = columns
    meets = np.less_equal(low[0][:, None], high_other[0])
    along = np.empty_like(meets)
    meets &= np.less_equal(low_other[0], high[0][:, None], out=along)
    for axis in (1, 2):
        meets &= np.less_equal(low[axis][:, None], high_other[axis], out=along)
        meets &= np.less_equal(low_other[axis], high[axis][:, None], out=along)
    return np.asarray(meets.ravel().nonzero()[0])


def _split(flat: Ints, width: int) -> tuple[Ints, Ints]:
    """The first and the second of pairs; numpy divides twice as fast where it is not asked what is left."""
    one = flat // max(width, 1)
    return one, flat - one * width
