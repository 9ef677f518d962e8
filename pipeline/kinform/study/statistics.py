"""What follows from samples: yield with its confidence, sensitivities, worst cases.

Yield: the share of good samples with the interval of Clopper and Pearson. Rank correlation: Spearman's. First-order
Sobol' indices: Saltelli et al. 2010, by scipy, with percentiles of a bootstrap. Samples that failed are not good, and
count in the yield; sensitivities leave them out, and indices are not said where one failed.
"""

from __future__ import annotations

import math

import numpy as np
from scipy import stats

from kinform.foundation.rounding import ARITHMETIC
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.study.session import Outcome

CONFIDENCE = 0.95
"""Of all intervals: what is commonly given."""


@dataclass(frozen=True)
class Sensitivity:
    """How a measure goes with what varies."""

    axis: str
    rank: float | None
    """Spearman's rank correlation; None where nothing is ranked."""
    index: float | None = None
    """First-order Sobol' index."""
    index_low: float | None = None
    index_high: float | None = None


@dataclass(frozen=True)
class Statistics:
    """Of one measure."""

    name: str
    known: int
    """Samples of which it is known."""
    nominal: float | None
    mean: float | None
    mean_low: float | None
    mean_high: float | None
    deviation: float | None
    """Of the samples, with n - 1."""
    deviation_low: float | None
    deviation_high: float | None
    lowest: float | None
    highest: float | None
    good: int | None
    """Samples within its limits; None where it has none."""
    share: tuple[float, float, float] | None
    """Yield, and the interval that holds it."""
    sensitivities: tuple[Sensitivity, ...]
    worst: tuple[int, ...]
    """Samples whose value is nearest to, or farthest beyond, a limit; without limits farthest from the mean."""


def random_samples(outcome: Outcome) -> bool:
    """Whether samples are drawn by chance: of others a yield is no probability, and means have no interval."""
    return outcome.plan.study.method in ("monte-carlo", "latin-hypercube", "sobol")


def independent(outcome: Outcome) -> int:
    """How many samples, from the first, are draws of their own: of indices those in A and B."""
    study = outcome.plan.study
    return 2 * (study.samples or 0) if study.indices else len(outcome.samples)


def statistics(outcome: Outcome) -> tuple[Statistics, ...]:
    """Of each measure, in their order."""
    return tuple(_of_measure(outcome, k) for k in range(len(outcome.plan.measures)))


def whole_yield(outcome: Outcome) -> tuple[int, int, tuple[float, float, float]] | None:
    """Samples that meet all limits, of how many, the share and its interval; None where there are no limits, or samples
    are not drawn by chance."""
    limited = [k for k, one in enumerate(outcome.plan.measures) if one.least is not None or one.most is not None]
    if not limited or not random_samples(outcome):
        return None
    n = independent(outcome)
    good = sum(all(_is_good(outcome, k, i) for k in limited) for i in range(n))
    return good, n, _share(good, n)


def _values(outcome: Outcome, k: int) -> Array:
    return np.array([math.nan if row[k] is None else row[k] for row in outcome.measured], dtype=float)


def _is_good(outcome: Outcome, k: int, i: int) -> bool:
    measure, value = outcome.plan.measures[k], outcome.measured[i][k]
    return value is not None and (measure.least is None or value >= measure.least) and (measure.most is None or value <= measure.most)  # fmt: skip # noqa: E501


def _of_measure(outcome: Outcome, k: int) -> Statistics:
    measure, n = outcome.plan.measures[k], independent(outcome)
    values = _values(outcome, k)
    known = values[:n][np.isfinite(values[:n])]
    limited = measure.least is not None or measure.most is not None
    good = sum(_is_good(outcome, k, i) for i in range(n)) if limited else None
    chance = random_samples(outcome)
    mean, deviation = (float(np.mean(known)) if len(known) else None, _deviation(known))
    low = high = spread_low = spread_high = None
    if chance and mean is not None and deviation is not None:
        half = stats.t.ppf(0.5 + CONFIDENCE / 2.0, len(known) - 1) * deviation / math.sqrt(len(known))
        low, high = mean - float(half), mean + float(half)
        spread_low, spread_high = _deviation_interval(known, deviation)
    return Statistics(
        measure.name, len(known), outcome.nominal[k], mean, low, high, deviation, spread_low, spread_high,
        float(known.min()) if len(known) else None, float(known.max()) if len(known) else None, good,
        _share(good, n) if good is not None and chance else None, _sensitivities(outcome, k, values),
        _worst(outcome, k, values),
    )  # fmt: skip


def _deviation(known: Array) -> float | None:
    return float(np.std(known, ddof=1)) if len(known) > 1 else None


def _deviation_interval(known: Array, deviation: float) -> tuple[float, float]:
    """The interval of the deviation, from the fourth moment of the samples: they need not be normal."""
    n = len(known)
    centred = known - known.mean()
    variance = deviation**2
    if variance == 0.0:
        return 0.0, 0.0
    kurtosis = float(np.mean(centred**4)) / float(np.mean(centred**2)) ** 2
    error = math.sqrt(max(kurtosis - (n - 3) / (n - 1), 0.0) / n)
    half = float(stats.norm.ppf(0.5 + CONFIDENCE / 2.0)) * error
    return deviation * math.exp(-half / 2.0), deviation * math.exp(half / 2.0)


def _share(good: int, n: int) -> tuple[float, float, float]:
    interval = stats.binomtest(good, n).proportion_ci(CONFIDENCE, method="exact")
    return good / n, float(interval.low), float(interval.high)


def _sensitivities(outcome: Outcome, k: int, values: Array) -> tuple[Sensitivity, ...]:
    axes = outcome.plan.axes
    n = independent(outcome)
    ranks = []
    for j in range(len(axes)):
        column = [row[j] for row in outcome.samples[:n]]
        numbers = all(isinstance(v, int | float) for v in column)
        kept = np.isfinite(values[:n])
        given = np.array(column, dtype=float)[kept] if numbers else np.zeros(0)
        ranks.append(_rank(given, values[:n][kept]))
    indices = _indices(outcome, values) if outcome.plan.study.indices else None
    if indices is None:
        return tuple(Sensitivity(axis.name, rank) for axis, rank in zip(axes, ranks, strict=True))
    return tuple(
        Sensitivity(axis.name, rank, *(float(part[j]) for part in indices))
        for j, (axis, rank) in enumerate(zip(axes, ranks, strict=True))
    )


def _rank(given: Array, values: Array) -> float | None:
    if len(given) < 3 or _constant(given) or _constant(values):
        return None
    return float(stats.spearmanr(given, values).statistic)


def _constant(values: Array) -> bool:
    return bool(np.ptp(values) <= ARITHMETIC * np.max(np.abs(values)))


def _indices(outcome: Outcome, values: Array) -> tuple[Array, Array, Array] | None:
    """First-order indices of all axes, and the ends of their intervals; None where a value is missing or all are
    equal."""
    n, d = outcome.plan.study.samples or 0, len(outcome.plan.axes)
    if not np.all(np.isfinite(values)) or _constant(values):
        return None
    parts = values.reshape(d + 2, n)
    given = {"f_A": parts[0][None], "f_B": parts[1][None], "f_AB": parts[2:][:, None]}
    found = stats.sobol_indices(func=given, n=n, rng=np.random.default_rng(outcome.plan.study.seed))
    # Resamples of the bootstrap of Sobol' indices; scipy's own choice is as many.
    ends = found.bootstrap(CONFIDENCE, n_resamples=999).first_order.confidence_interval
    return np.ravel(found.first_order), np.ravel(ends.low), np.ravel(ends.high)


def _worst(outcome: Outcome, k: int, values: Array) -> tuple[int, ...]:
    measure = outcome.plan.measures[k]
    known = np.flatnonzero(np.isfinite(values))
    if not len(known):
        return ()
    some = values[known]
    beyond = np.full(len(some), -math.inf)
    if measure.most is not None:
        beyond = np.maximum(beyond, some - measure.most)
    if measure.least is not None:
        beyond = np.maximum(beyond, measure.least - some)
    if measure.least is None and measure.most is None:
        beyond = np.abs(some - some.mean())
    order = sorted(range(len(known)), key=lambda i: (-beyond[i], known[i]))
    # Samples that are listed as the worst of a measure; a choice.
    return tuple(int(known[i]) for i in order[:5])
