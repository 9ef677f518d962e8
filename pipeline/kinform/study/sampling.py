"""The samples of a study: a row of values each, the same for the same study everywhere."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
from scipy.stats import norm, qmc

from kinform.model.arrays import Array
from kinform.study.plan import SIGMAS, Axis, Plan


def samples(plan: Plan) -> list[tuple[Any, ...]]:
    """Values of all axes, sample by sample. With `indices` of Sobol' samples: A, then B, then A with each column of B
    in turn (Saltelli 2010)."""
    study = plan.study
    if study.method == "grid":
        return list(itertools.product(*(_grid(axis) for axis in plan.axes)))
    if study.method == "one-at-a-time":
        return _one_at_a_time(plan)
    return [tuple(at(axis, float(u)) for axis, u in zip(plan.axes, row, strict=True)) for row in _unit(plan)]


def middle(axis: Axis) -> Any:
    """The value in the middle: of a list the one in the middle of it."""
    return at(axis, 0.5) if axis.values is None else axis.values[(len(axis.values) - 1) // 2]


def at(axis: Axis, share: float) -> Any:
    """The value below which this share of all values lies."""
    if axis.values is not None:
        return axis.values[min(int(share * len(axis.values)), len(axis.values) - 1)]
    width = axis.high - axis.low
    if axis.distribution == "normal":
        half = width / (2.0 * SIGMAS)
        return float(axis.low + width / 2.0 + half * norm.ppf(share))
    if axis.distribution == "triangular":
        part = np.sqrt(share / 2.0) if share < 0.5 else 1.0 - np.sqrt((1.0 - share) / 2.0)
        return float(axis.low + width * part)
    return float(axis.low + width * share)


def _unit(plan: Plan) -> Array:
    """Shares, one row a sample, none of them 0 or 1."""
    study, d = plan.study, len(plan.axes)
    n = study.samples or 0
    if study.method == "monte-carlo":
        drawn = np.random.Generator(np.random.PCG64(study.seed)).random((n, d))
    elif study.method == "latin-hypercube":
        drawn = qmc.LatinHypercube(d, rng=np.random.default_rng(study.seed)).random(n)
    elif not study.indices:
        drawn = qmc.Sobol(d, rng=np.random.default_rng(study.seed)).random(n)
    else:
        both = qmc.Sobol(2 * d, rng=np.random.default_rng(study.seed)).random(n)
        first, second = both[:, :d], both[:, d:]
        mixed = []
        for k in range(d):
            other = first.copy()
            other[:, k] = second[:, k]
            mixed.append(other)
        drawn = np.vstack([first, second, *mixed])
    least = np.finfo(float).eps
    return np.asarray(np.clip(drawn, least, 1.0 - least))


def _grid(axis: Axis) -> list[Any]:
    if axis.values is not None:
        return list(axis.values)
    count = axis.count or 2
    return [float(v) for v in np.linspace(axis.low, axis.high, count)]


def _one_at_a_time(plan: Plan) -> list[tuple[Any, ...]]:
    """All in the middle; then each over its values, or its limits and steps, with the others in the middle."""
    centre = tuple(middle(axis) for axis in plan.axes)
    out = [centre]
    for k, axis in enumerate(plan.axes):
        out += [(*centre[:k], value, *centre[k + 1 :]) for value in _grid(axis) if value != centre[k]]
    return out
