"""Products of parameters, thinned: each value of each axis is tested every time, each combination in the sweep."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import pytest


def diagonal(most: int | None = None, /, **axes: Sequence[Any]) -> pytest.MarkDecorator:
    """Parametrizes a test by the product of these axes; combinations off the diagonal are marked `sweep`, and of the
    diagonal those after the first `most`."""
    values = list(axes.values())
    chosen = {tuple(k % len(axis) for axis in values) for k in range(most or max(map(len, values)))}
    params = [
        pytest.param(*(axis[i] for axis, i in zip(values, places, strict=True)), marks=_marks(places in chosen))
        for places in product(*(range(len(axis)) for axis in values))
    ]
    return pytest.mark.parametrize(tuple(axes), params)


def first(count: int, values: Sequence[Any]) -> list[Any]:
    """The values, all after the first `count` marked `sweep`."""
    return [pytest.param(value, marks=_marks(k < count)) for k, value in enumerate(values)]


def first_rows(count: int, rows: Sequence[Sequence[Any]]) -> list[Any]:
    """Rows of values for several parameters, all after the first `count` marked `sweep`."""
    return [pytest.param(*row, marks=_marks(k < count)) for k, row in enumerate(rows)]


def some(every: int, values: Sequence[Any]) -> list[Any]:
    """The values, of which every so many are tested each time; the others are marked `sweep`."""
    return [pytest.param(value, marks=_marks(k % every == 0)) for k, value in enumerate(values)]


def _marks(often: bool) -> Any:
    return () if often else (pytest.mark.sweep,)
