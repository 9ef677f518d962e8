"""How finely a text writes its coordinates: the last digit of the largest ones.

A writer that keeps six digits, or three decimals, loses what comes after them, and the more the further a part lies
from the origin. What counts are the numbers of the largest magnitude: their last place, where most of them use it.
Round numbers (a box of whole millimetres) are not rounded ones, and say nothing.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from kinform.form.constants import DIGITS_LEAST, DIGITS_READ, LARGE_COORDINATES, LAST_DIGIT_USED
from kinform.model.arrays import Array, Ints

_NUMBER = re.compile(r"[+-]?(\d*)\.?(\d*)(?:[eEdD]([+-]?\d+))?$")


def written_step(tokens: Sequence[str], values: Array) -> float:
    """Unit of the last digit of the largest of the coordinates `values` (n,), written as `tokens` (n); 0 where the
    digits do not look like rounded ones."""
    size = np.abs(values)
    large = np.flatnonzero(size >= size.max(initial=0.0) * LARGE_COORDINATES)
    if _shortest([tokens[k] for k in large.tolist()]):
        return 0.0
    coarse, every = _digits(tokens, large), _digits(tokens, np.arange(len(tokens)))
    if not coarse or not every:
        return 0.0
    finest, longest = min(place for place, _ in coarse), max(count for _, count in coarse)
    used = sum(place == finest for place, _ in coarse) / len(coarse)
    # others that are written more finely show that neither decimals nor digits were cut
    cut = longest >= DIGITS_LEAST and (
        all(place >= finest for place, _ in every) or all(count <= longest for _, count in every)
    )
    return 10.0**finest if used > LAST_DIGIT_USED and cut else 0.0


def _shortest(tokens: Sequence[str]) -> bool:
    """Whether numbers are written as the shortest text that reads back as the same double, so that nothing is lost.

    Such a writer puts ".0" behind whole numbers, and one of few digits nothing; one of one decimal writes others too.
    """
    whole = [token.endswith(".0") for token in tokens]
    return any(whole) and (all(whole) or any(len(token.partition(".")[2]) > 1 for token in tokens))


def _digits(tokens: Sequence[str], indices: Ints) -> list[tuple[int, int]]:
    """(power of ten of the last digit, number of digits) of distinct numbers among these; none where one is no number.

    A sample of them, evenly chosen; noughts at either end do not count, and nought itself says nothing.
    """
    out = []
    for token in {tokens[k] for k in indices[:: max(1, len(indices) // DIGITS_READ)].tolist()}:
        match = _NUMBER.match(token)
        if match is None:
            return []
        decimals = match[2].rstrip("0")
        whole = match[1].lstrip("0")
        zeros = 0 if decimals else len(whole) - len(whole.rstrip("0"))
        count = len((whole + decimals).lstrip("0")) - zeros
        if count:
            out.append((int(match[3] or 0) - len(decimals) + zeros, count))
    return out
