"""One step of Gauss and Legendre's collocation, which takes a motion across a pose in its middle.

With an even number of stages none lies in the middle, and those next to it keep clear of it: by 0.18 of half the step
with eight. All weights are positive, so that the noise of slopes near the pose is not magnified, and the order is twice
the number of stages (Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, section II.7). States of
stages are found by iteration, each projected onto closed loops before its slope is asked for: off them slopes near a
singular pose mean nothing.

Nodes and weights are made of sums of Legendre polynomials in plain floats: the same on every processor.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.simulation.solver.constants import CONVERGED
from kinform.simulation.solver.run_state import Run


@dataclass(frozen=True, eq=False)
class Passage:
    """A step from `begin` (s) of `span` (s), with s stages."""

    begin: float
    span: float
    start: Array
    """State at its start, loops closed."""
    slopes: Array
    """(s, size) at the stages."""
    end: Array
    """State at its end, loops closed."""

    def slopes_at(self, places: tuple[float, ...]) -> Array:
        """(k, size) by the polynomial through the stages, at shares of the step."""
        return np.array([_sum(_values(place, len(self.slopes)), self.slopes) for place in places])

    def state_at(self, place: float) -> Array:
        """State at a share of the step, by the same polynomial: loops are closed but for its error."""
        return np.asarray(self.start + self.span * _sum(_integrals(place, len(self.slopes)), self.slopes))


def pass_over(run: Run, start: Array, begin: float, span: float, slopes: Array) -> Passage | None:
    """The step from the state `start`, with slopes (s, size) to begin with; None where it cannot be made."""
    stages = len(slopes)
    nodes, slopes, before = places_of(stages), slopes.copy(), np.inf
    # Iterations of the stages: five to ten are usual. A choice.
    for _ in range(40):
        change = 0.0
        for i, place in enumerate(nodes):
            state = start + span * _sum(_integrals(place, stages), slopes)
            slope = np.zeros_like(state)
            gap, _ = run.project(begin + place * span, state)
            if not 0.0 <= gap < run.settings.open or not run.derivative(begin + place * span, state, slope) > 0.0:
                return None
            change = max(change, span * float(np.abs(slope - slopes[i]).max()))
            slopes[i] = slope
        if not np.isfinite(change):
            return None
        if change <= CONVERGED or (change < math.sqrt(CONVERGED) and change > 0.5 * before):
            # What is left is rounding, or the noise of slopes near the pose, which keeps it from falling further.
            break
        before = change
    else:
        return None
    end = start + span * _sum(_integrals(1.0, stages), slopes)
    gap, _ = run.project(begin + span, end)
    return Passage(begin, span, start, slopes, end) if 0.0 <= gap < run.settings.open else None


@cache
def places_of(stages: int) -> tuple[float, ...]:
    """Shares of the step at which the stages lie, ascending: roots of Legendre's polynomial, by Newton's method."""
    nodes = []
    for k in range(stages):
        x = -math.cos(math.pi * (k + 0.75) / (stages + 0.5))
        for _ in range(100):
            value = _legendre(x, stages)
            slope = stages * (x * value[stages] - value[stages - 1]) / (x * x - 1.0)
            x -= value[stages] / slope
            if abs(value[stages] / slope) < CONVERGED:
                break
        nodes.append(0.5 + 0.5 * x)
    return tuple(nodes)


@cache
def _weights(stages: int) -> tuple[float, ...]:
    """Of the stages' slopes in the whole step, twice their share."""
    out = []
    for place in places_of(stages):
        x = 2.0 * place - 1.0
        low = _legendre(x, stages)[stages - 1]
        out.append(2.0 * (1.0 - x * x) / (stages * low) ** 2)
    return tuple(out)


def _integrals(place: float, stages: int) -> list[float]:
    """Weights of the stages' slopes in the way from the start to a share of the step."""
    at = _legendre(2.0 * place - 1.0, stages)
    ways = [at[1] + 1.0, *((at[k + 1] - at[k - 1]) / (2.0 * k + 1.0) for k in range(1, stages))]
    return [0.5 * total for total in _expansion(ways, stages)]


def _values(place: float, stages: int) -> list[float]:
    """Weights of the stages' slopes in that at a share of the step."""
    return _expansion(_legendre(2.0 * place - 1.0, stages)[:stages], stages)


def _expansion(of: list[float], stages: int) -> list[float]:
    """Weights by stage of a linear form that is `of` for Legendre's polynomials, one degree after the other."""
    out = []
    for place, weight in zip(places_of(stages), _weights(stages), strict=True):
        value = _legendre(2.0 * place - 1.0, stages)
        out.append(weight * math.fsum((k + 0.5) * value[k] * of[k] for k in range(stages)))
    return out


def _legendre(x: float, degree: int) -> list[float]:
    """Legendre's polynomials at x, up to the degree."""
    out = [1.0, x]
    for k in range(1, degree):
        out.append(((2.0 * k + 1.0) * x * out[k] - k * out[k - 1]) / (k + 1.0))
    return out


def _sum(weights: list[float], rows: Array) -> Array:
    """(size,) rows, weighed; added one after the other, so the same on every processor."""
    total = np.zeros(rows.shape[1])
    for weight, row in zip(weights, rows, strict=True):
        total += weight * row
    return total
