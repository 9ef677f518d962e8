"""Pictures of samples as SVG: a histogram, and one value over another; axes have their names, units and round ticks."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinform.foundation.escapes import html
from kinform.foundation.rounding import ARITHMETIC, SOLVED
from kinform.foundation.words import number
from kinform.model.arrays import Array

BINS_MOST = 60
"""Bars of a histogram at most: thinner than 4 px they are no more to be told apart. A choice."""


_WIDTH, _HEIGHT = 320, 220
"""px of a picture: three stand side by side on a page 1,000 px wide."""
_LEFT, _RIGHT, _TOP, _BOTTOM = 62, 12, 10, 40
"""px of the margins: labels of seven characters on the left, two lines of text below."""
_DOTS = 2000
"""Samples that are drawn: more cover each other, and make the page large. Chosen, not measured."""


def histogram(label: str, values: Array, limits: Sequence[float]) -> str:
    """How many samples have which value. As many bars as Freedman and Diaconis (1981) take, or one for each of a few
    whole values; the limits are lines."""
    counts, edges = np.histogram(values, bins=_bins(values))
    low, high = _span([*limits, float(edges[0]), float(edges[-1])])
    top = float(counts.max())
    x, y = _Axis(low, high, _LEFT, _WIDTH - _RIGHT), _Axis(0.0, top, _HEIGHT - _BOTTOM, _TOP)
    bars = [
        f'<rect x="{x.at(left):.1f}" y="{y.at(c):.1f}" width="{max(x.at(right) - x.at(left) - 0.5, 0.8):.1f}" '
        f'height="{y.at(0.0) - y.at(c):.1f}"/>'
        for c, left, right in zip(counts.tolist(), edges[:-1].tolist(), edges[1:].tolist(), strict=True)
        if c
    ]
    lines = [f'<line class="limit" x1="{x.at(v):.1f}" x2="{x.at(v):.1f}" y1="{_TOP}" y2="{_HEIGHT - _BOTTOM}"/>'
             for v in limits]  # fmt: skip
    return _figure(f"How often: {label}", "".join(bars + lines), x, y, label, "samples")


def scatter(given_label: str, label: str, given: Array, values: Array, limits: Sequence[float]) -> str:
    """A measure over what varies, a dot a sample."""
    kept = np.flatnonzero(np.isfinite(values))[:_DOTS]
    x = _Axis(*_span([float(given.min()), float(given.max())]), _LEFT, _WIDTH - _RIGHT)
    ends = _span([*limits, float(np.nanmin(values)), float(np.nanmax(values))])
    y = _Axis(*ends, _HEIGHT - _BOTTOM, _TOP)
    dots = [f'<circle cx="{x.at(float(given[i])):.1f}" cy="{y.at(float(values[i])):.1f}" r="1.5"/>' for i in kept]
    lines = [f'<line class="limit" x1="{_LEFT}" x2="{_WIDTH - _RIGHT}" y1="{y.at(v):.1f}" y2="{y.at(v):.1f}"/>'
             for v in limits]  # fmt: skip
    more = f" (the first {_DOTS} samples)" if len(kept) == _DOTS else ""
    return _figure(f"{label} over {given_label}{more}", "".join(dots + lines), x, y, given_label, label)


class _Axis:
    """A scale from values to pixels."""

    def __init__(self, low: float, high: float, start: float, end: float):
        self.low, self.high, self._start, self._end = low, high, start, end

    def at(self, value: float) -> float:
        """Pixels."""
        return self._start + (value - self.low) / (self.high - self.low) * (self._end - self._start)

    def ticks(self) -> list[float]:
        """Round values within the axis, least first."""
        # Steps between ticks of an axis, about: five labels fit. Chosen, not measured.
        rough = (self.high - self.low) / 4
        power = 10.0 ** math.floor(math.log10(rough))
        step = next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= rough * (1.0 - SOLVED))
        first, last = math.ceil(self.low / step - SOLVED), math.floor(self.high / step + SOLVED)
        return [k * step for k in range(first, last + 1)]


def _bins(values: Array) -> int | Array:
    """Bars, or their edges where values are few and whole, as of a mobility."""
    if float(np.ptp(values)) <= ARITHMETIC * float(np.abs(values).max()):
        return np.array(_span([float(values.min())]))
    low, high = float(values.min()), float(values.max())
    if np.all(values == np.round(values)) and high - low < BINS_MOST:
        return np.arange(low - 0.5, high + 1.0)
    quarters = np.quantile(values, [0.25, 0.75])
    width = 2.0 * float(quarters[1] - quarters[0]) / len(values) ** (1.0 / 3.0)
    least = math.ceil(math.log2(len(values)) + 1.0)  # Sturges 1926, where half of the samples are one value
    return min(max(math.ceil((high - low) / width) if width > 0.0 else 0, least), BINS_MOST)


def _span(values: Sequence[float]) -> tuple[float, float]:
    """Least and greatest, with room beside them; not less room than rounding shows."""
    low, high = min(values), max(values)
    size = max(abs(low), abs(high))
    room = 0.04 * (high - low) if high - low > ARITHMETIC * size else 0.05 * size or 1.0
    return low - room, high + room


def _figure(caption: str, drawing: str, x: _Axis, y: _Axis, below: str, beside: str) -> str:
    text = html(caption)
    bottom, middle = _HEIGHT - _BOTTOM, (_TOP + _HEIGHT - _BOTTOM) / 2
    digits = [_shown(axis.ticks()) for axis in (x, y)]
    ticks = [
        f'<path d="M{x.at(v):.1f} {bottom}v4"/>'
        f'<text x="{x.at(v):.1f}" y="{bottom + 15}" text-anchor="middle">{t}</text>'
        for v, t in digits[0]
    ] + [
        f'<path d="M{_LEFT} {y.at(v):.1f}h-4"/><text x="{_LEFT - 6}" y="{y.at(v) + 4:.1f}" text-anchor="end">{t}</text>'
        for v, t in digits[1]
    ]
    names = (
        f'<text x="{(_LEFT + _WIDTH - _RIGHT) / 2}" y="{_HEIGHT - 6}" text-anchor="middle">{html(below)}</text>'
        f'<text x="12" y="{middle}" text-anchor="middle" transform="rotate(-90 12 {middle})">{html(beside)}</text>'
    )
    frame = f'<path d="M{_LEFT} {_TOP}V{bottom}H{_WIDTH - _RIGHT}"/>'
    size = f'viewBox="0 0 {_WIDTH} {_HEIGHT}" width="{_WIDTH}" height="{_HEIGHT}"'
    svg = f'<svg role="img" aria-label="{text}" {size}>{drawing}{frame}{"".join(ticks)}{names}</svg>'
    return f"<figure>{svg}<figcaption>{text}</figcaption></figure>"


def _shown(ticks: Sequence[float]) -> list[tuple[float, str]]:
    """Ticks with as many digits as they have."""
    near = 1e-3 * (ticks[-1] - ticks[0])
    digits = next((d for d in range(1, 13) if all(abs(float(f"{v:.{d}g}") - v) <= near for v in ticks)), 12)
    return [(v, number(v, digits)) for v in ticks]
