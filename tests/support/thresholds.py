"""Answers that change at a threshold, wherever between two values it lies."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np


def changes_once(answer: Callable[[float], Any], low: float, high: float, before: Any, after: Any) -> None:
    """The answer is `before` at the low value and `after` at the high one, and changes once on the way."""
    found = [answer(float(value)) for value in np.geomspace(low, high, 9)]
    assert (found[0], found[-1]) == (before, after)
    assert sum(one != other for one, other in pairwise(found)) == 1, found
