"""What follows from samples, where it is known otherwise: Ishigami's function, and binomials."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from kinform.study.plan import Axis, Measure, Plan, Study
from kinform.study.sampling import samples
from kinform.study.session import Outcome
from kinform.study.statistics import statistics, whole_yield


def outcome(function, axes: int, **study) -> Outcome:
    limits = {key: study.pop(key) for key in ("least", "most") if key in study}
    measure = Measure(name="m", value="mobility.effective", **limits)
    made = Plan(
        Path("s.toml"), Path("d.toml"), Study(design="d.toml", **study),
        tuple(Axis(f"x{k}", ("x",), None, "uniform", -math.pi, math.pi) for k in range(axes)), (measure,), (), "",
    )  # fmt: skip
    rows = samples(made)
    values = [function(*row) for row in rows]
    return Outcome(made, tuple(rows), tuple((v,) for v in values), ("",) * len(rows), (None,))


def ishigami(a: float, b: float, c: float) -> float:
    return math.sin(a) + 7 * math.sin(b) ** 2 + 0.1 * c**4 * math.sin(a)


def test_first_order_indices_of_ishigami():
    """Ishigami and Homma 1990: with a = 7, b = 0.1 the indices are 0.3139, 0.4424 and 0."""
    found = statistics(outcome(ishigami, 3, method="sobol", samples=1024, indices=True))[0].sensitivities
    for one, index in zip(found, (0.3139, 0.4424, 0.0), strict=True):
        assert one.index == pytest.approx(index, abs=0.03)
        assert one.index_low <= index <= one.index_high


def test_mean_and_deviation_lie_in_their_intervals_as_often_as_said():
    inside = [0, 0]
    for seed in range(100):
        one = statistics(outcome(lambda x: x, 1, method="monte-carlo", samples=200, seed=seed))[0]
        inside[0] += one.mean_low <= 0.0 <= one.mean_high
        inside[1] += one.deviation_low <= math.pi / math.sqrt(3) <= one.deviation_high
    assert all(88 <= many <= 100 for many in inside), inside


def test_the_yield_counts_what_failed_as_bad():
    whole = outcome(lambda x: x if x < 3 else None, 1, method="monte-carlo", samples=1000, least=0.0)
    good, n, (share, low, high) = whole_yield(whole)
    assert n == 1000 and share == good / n and low < 3 / (2 * math.pi) < high


def test_ranks_see_what_grows_and_the_worst_are_the_farthest_beyond():
    whole = outcome(lambda x, y: math.exp(x), 2, method="latin-hypercube", samples=100, most=1.0)
    one = statistics(whole)[0]
    assert one.sensitivities[0].rank == pytest.approx(1.0)
    assert abs(one.sensitivities[1].rank) < 0.3
    assert one.worst[0] == int(np.argmax([row[0] for row in whole.samples]))


def test_of_a_grid_no_probability_is_said():
    whole = outcome(lambda x, y: x, 2, method="one-at-a-time", most=0.0)
    assert whole_yield(whole) is None and statistics(whole)[0].mean_low is None
