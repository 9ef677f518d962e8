"""Amplitudes of a sampled quantity by frequency, and its extremes over each period.

Spectra are discrete Fourier transforms of what is left of the samples without their straight line (least squares,
weighted as the window), under a Hann window over all of them, scaled so that a sine of amplitude A that falls on a
frequency of the spectrum shows A there, and up to 15 % less midway between two. Lines are found between frequencies by
the ratio of the two greatest neighbours, which is exact for a lone sine under this window (Grandke, Interpolation
Algorithms for Discrete Fourier Transforms of Weighted Signals, IEEE Trans. Instrum. Meas. 32, 1983).
"""

from __future__ import annotations

import math

import numpy as np

from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array

MOST_LINES = 3
"""Lines that are named: a choice, of what a reader takes in."""
LEAST_PERIODS = 8.0
"""Periods below which an envelope says no more than the curve: a choice."""
LEAST_IN_PERIOD = 4.0
"""Samples of a period, at least, for its extremes to be among them: one is then within an eighth of a period of
each."""


@dataclass(frozen=True)
class Line:
    """A sine in a spectrum."""

    frequency: float
    """Hz."""
    amplitude: float
    """In the unit of the samples."""


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Amplitudes by frequency."""

    frequency: Array
    """(n,) Hz, from 0 to half the rate of the samples at most."""
    amplitude: Array
    """(n,) in the unit of the samples."""
    lines: tuple[Line, ...]
    """The greatest, falling."""


def even_samples(time: Array) -> int:
    """How many of the times (T,), from the first on, follow each other evenly: runs may end with a shorter step."""
    if len(time) < 2:
        return len(time)
    steps = np.diff(time)
    uneven = np.flatnonzero(np.abs(steps - steps[0]) > SINGLE * steps[0])
    return int(uneven[0]) + 1 if len(uneven) else len(time)


def amplitude_spectrum(time: Array, values: Array) -> Spectrum | None:
    """The spectrum of samples (T,) at times (T,), s, those that follow each other evenly; none of fewer than 16, and of
    samples that are not all numbers."""
    count = even_samples(time)
    samples = np.asarray(values[:count], dtype=np.float64)
    # Samples of a spectrum, at least: the window alone is four of its eight frequencies wide.
    if count < 16 or not np.isfinite(samples).all():
        return None
    span = float(time[count - 1] - time[0]) * count / (count - 1)
    window = 0.5 - 0.5 * np.cos(2.0 * math.pi / count * np.arange(count))
    amplitude = 4.0 / count * np.abs(np.fft.rfft(_without_line(samples, window) * window))
    amplitude[0] *= 0.5
    return Spectrum(np.arange(len(amplitude)) / span, amplitude, _lines(amplitude, samples, span))


def _without_line(samples: Array, window: Array) -> Array:
    """The samples less their straight line, by least squares with the window's weights: a line without them would leave
    a step at the ends of a sine."""
    place, whole = np.arange(len(samples), dtype=np.float64), float(window.sum())
    place -= float((window * place).sum()) / whole
    level = samples - float((window * samples).sum()) / whole
    return np.asarray(level - float((window * place * level).sum() / (window * place * place).sum()) * place)


def _lines(amplitude: Array, samples: Array, span: float) -> tuple[Line, ...]:
    """Sines that stand out, the greatest first."""
    inner = amplitude[1:-1]
    tops = 1 + np.flatnonzero((inner > amplitude[:-2]) & (inner >= amplitude[2:]))
    # Share of the greatest amplitude that a line has at least: the lobes of the window beside a line have up to 2.7 %
    # of it.
    floor = max(3e-2 * float(amplitude.max()), SOLVED * float(np.abs(samples).max(initial=0.0)))
    found = []
    for k in tops[amplitude[tops] > floor].tolist():
        side = 1 if amplitude[k + 1] > amplitude[k - 1] else -1
        share = float(amplitude[k + side] / amplitude[k])
        offset = min(max((2.0 * share - 1.0) / (1.0 + share), 0.0), 0.5)
        height = float(amplitude[k]) * (1.0 - offset**2) / float(np.sinc(offset))
        found.append(Line((k + side * offset) / span, height))
    return tuple(sorted(found, key=lambda line: (-line.amplitude, line.frequency))[:MOST_LINES])


def envelope(time: Array, values: Array, period: float) -> tuple[Array, Array] | None:
    """(T,) the least and the greatest of the samples (T,) within half a period (s) before and after each; none where
    the samples do not follow each other evenly through eight periods, or less than four go into one."""
    count = even_samples(time)
    if count < len(time) - 1 or count < 2:
        return None
    step = float(time[1] - time[0])
    if (count - 1) * step < LEAST_PERIODS * period or period < LEAST_IN_PERIOD * step:
        return None
    half = math.ceil(0.5 * period / step)
    padded = np.pad(np.asarray(values, dtype=np.float64), half, mode="edge")
    around = np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1)
    return around.min(axis=1), around.max(axis=1)
