"""How finely a text writes its coordinates: the last digit of the largest ones.

A writer that keeps six digits, or three decimals, loses what comes after them, and the more the further a part lies
from the origin. What counts are the numbers of the largest magnitude: their last place, where most of them use it.
Round numbers (a box of whole millimetres) are not rounded ones, and say nothing.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Sequence

import numpy as np

from kinform.model.arrays import Array, Ints

_NUMBER = re.compile(r"[+-]?(\d*)\.?(\d*)(?:[eEdD]([+-]?\d+))?$")


def written_step(blocks: Iterable[Sequence[bytes]], values: Array) -> float:
    """Unit of the last digit of the largest of the coordinates `values` (n,), which are written as the tokens of these
    blocks, in order; 0 where the digits do not look like rounded ones, or where there are not n of them."""
    size = np.abs(values)
    # Share of the largest coordinate from which on a coordinate is as coarse as it: one decimal digit.
    is_large = size >= size.max(initial=0.0) * 0.1
    chosen = _sample(np.flatnonzero(is_large)), _sample(np.arange(len(values)))
    wanted, first = np.union1d(*chosen), 0
    picked: dict[int, str] = {}
    shortest = _Shortest()
    for tokens in blocks:
        here = is_large[first : first + len(tokens)]
        if len(here) < len(tokens):
            return 0.0
        shortest.look([tokens[k] for k in np.flatnonzero(here).tolist()])
        for k in wanted[slice(*np.searchsorted(wanted, [first, first + len(tokens)]))].tolist():
            picked[k] = tokens[k - first].decode("utf-8", errors="replace")
        first += len(tokens)
    if first != len(values) or shortest.certain:
        return 0.0
    coarse, every = (_digits({picked[k] for k in indices.tolist()}) for indices in chosen)
    if not coarse or not every:
        return 0.0
    finest, longest = min(place for place, _ in coarse), max(count for _, count in coarse)
    used = sum(place == finest for place, _ in coarse) / len(coarse)
    # others that are written more finely show that neither decimals nor digits were cut
    # Digits from which on the largest coordinates can have been cut: no writer keeps fewer, and parts of whole or half
    # millimetres, up to some metres, have fewer.
    cut = longest >= 5 and (all(place >= finest for place, _ in every) or all(count <= longest for _, count in every))
    # Share of the coordinates that use the last digit, above which it is where they were rounded: nine in ten of
    # rounded numbers do.
    return 10.0**finest if used > 0.5 and cut else 0.0


def _sample(indices: Ints) -> Ints:
    """Some of the indices, evenly chosen."""
    # Coordinates of a text whose digits are looked at: at random they show the share that uses the last digit to 1 %.
    return indices[:: max(1, len(indices) // 2000)]


class _Shortest:
    """Whether numbers are written as the shortest text that reads back as the same double, so that nothing is lost.

    Such a writer puts ".0" behind whole numbers, and one of few digits nothing; one of one decimal writes others too.
    """

    def __init__(self) -> None:
        self._whole = self._broken = self._long = False

    def look(self, tokens: Sequence[bytes]) -> None:
        """Look at more of them."""
        whole = [token.endswith(b".0") for token in tokens]
        self._whole = self._whole or any(whole)
        self._broken = self._broken or not all(whole)
        self._long = self._long or any(len(token.partition(b".")[2]) > 1 for token in tokens)

    @property
    def certain(self) -> bool:
        """Whether those that were looked at are written so."""
        return self._whole and (not self._broken or self._long)


def _digits(tokens: Collection[str]) -> list[tuple[int, int]]:
    """(power of ten of the last digit, number of digits) of these numbers; none where one is no number.

    Noughts at either end do not count, and nought itself says nothing.
    """
    out = []
    for token in tokens:
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
