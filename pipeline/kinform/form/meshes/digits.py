"""How finely a text writes its coordinates: the last digit of the largest ones.

A writer that keeps six digits, or three decimals, loses what comes after them, and the more the further a part lies
from the origin. What counts are the numbers of the largest magnitude: their last place, where most of them use it.
Round numbers (a box of whole millimetres) are not rounded ones, and say nothing.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from kinform.form.constants import DIGITS_READ, LARGE_COORDINATES, LAST_DIGIT_USED
from kinform.model.arrays import Array

_NUMBER = re.compile(r"[+-]?(\d*)\.?(\d*)(?:[eEdD]([+-]?\d+))?$")


def written_step(tokens: Sequence[str], values: Array) -> float:
    """Unit of the last digit of the largest of the coordinates `values` (n,), written as `tokens` (n); 0 where the
    digits do not look like rounded ones."""
    size = np.abs(values)
    large = np.flatnonzero(size >= size.max(initial=0.0) * LARGE_COORDINATES)
    chosen = large[:: max(1, len(large) // DIGITS_READ)]
    places: dict[str, int] = {}
    for token in {tokens[k] for k in chosen.tolist()}:
        match = _NUMBER.match(token)
        if match is None:
            return 0.0
        digits = match[2].rstrip("0")
        exponent = int(match[3] or 0)
        whole = match[1].lstrip("0")
        zeros = 0 if digits else len(whole) - len(whole.rstrip("0"))
        places[token] = exponent - len(digits) + zeros
    if not places:
        return 0.0
    finest = min(places.values())
    used = sum(place == finest for place in places.values()) / len(places)
    return 10.0**finest if used > LAST_DIGIT_USED else 0.0
