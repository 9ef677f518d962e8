"""Curves over time as SVG.

Series differ by dash and by a label, not by colour alone. Long runs are thinned to the extremes of each column.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from kinform.foundation.escapes import html
from kinform.foundation.rounding import ARITHMETIC, SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array

PLOT_WIDTH, PLOT_HEIGHT = 380.0, 168.0
"""px, of a plot. Chosen by eye."""
PLOT_LEFT, PLOT_RIGHT, PLOT_TOP, PLOT_BOTTOM = 54.0, 366.0, 12.0, 142.0
"""px, of the area of the curves. Chosen by eye."""
MOST_COLUMNS = 300
"""Columns of a curve, about its pixels on the page; in each the least and the greatest value are kept. Chosen by
eye."""
MOST_EVENTS = 40
"""Collisions that are marked in a plot: more touch each other. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class Series:
    """One curve."""

    label: str
    values: Array


@dataclass(frozen=True, eq=False)
class Plot:
    """Curves of one quantity, with horizontal lines for limits."""

    title: str
    unit: str
    series: tuple[Series, ...]
    limits: tuple[tuple[str, float], ...] = ()


def plot_svg(plot: Plot, time: Array, events: Sequence[tuple[float, str]] = ()) -> str:
    """The plot as SVG, with upright lines for events (s, what happens); the viewer moves its cursor."""
    ticks = ticks_of(plot)
    low, high = ticks[0], ticks[-1]
    start, end = float(time[0]), float(time[-1])

    def x(t: Any) -> Any:
        return PLOT_LEFT + (t - start) / ((end - start) or 1.0) * (PLOT_RIGHT - PLOT_LEFT)

    def y(value: Any) -> Any:
        return PLOT_BOTTOM - (value - low) / ((high - low) or 1.0) * (PLOT_BOTTOM - PLOT_TOP)

    across, upright = (PLOT_LEFT, PLOT_RIGHT), (PLOT_TOP, PLOT_BOTTOM)
    parts = []
    for tick in ticks:
        parts += [
            line("grid", across, (y(tick), y(tick))),
            text(PLOT_LEFT - 6, y(tick) + 3.5, number(tick), "end"),
        ]
    for share, anchor in ((0.0, "start"), (0.5, "middle"), (1.0, "end")):
        label = number(start + share * (end - start)) + (" s" if share == 1.0 else "")
        parts.append(
            text(
                PLOT_LEFT + share * (PLOT_RIGHT - PLOT_LEFT),
                PLOT_BOTTOM + 16,
                label,
                anchor,
            )
        )
    for label, value in plot.limits:
        at = y(value)
        inside = at + (11.0 if at < (PLOT_TOP + PLOT_BOTTOM) / 2 else -4.0)
        side, anchor = (PLOT_LEFT + 4.0, "start") if label.startswith("found") else (PLOT_RIGHT, "end")
        named = html(f"{label} {number(value)}{plot.unit}")
        parts += [line("limit", across, (at, at)), text(side, inside, named, anchor)]
    for moment, event in events[:MOST_EVENTS]:
        sign = f"✕<title>{html(event)}</title>"
        parts.append(line("event", (x(moment), x(moment)), upright))
        parts.append(text(x(moment), PLOT_TOP - 2, sign, "middle", "tick event-sign"))
    parts += [
        f'<path class="curve curve-{k}" d="{_path(x(time), y(series.values))}"/>'
        for k, series in enumerate(plot.series)
    ]
    several, below = len(plot.series) > 1, PLOT_HEIGHT + 8
    for k, series in enumerate(plot.series if several else ()):
        at = PLOT_LEFT + 104.0 * k
        parts.append(line(f"curve curve-{k}", (at, at + 18), (below, below)))
        parts.append(text(at + 23, PLOT_HEIGHT + 12, html(series.label)))
    parts.append(f'<line class="cursor" visibility="hidden" x1="0" x2="0" y1="{PLOT_TOP}" y2="{PLOT_BOTTOM}"/>')
    spoken = html(_spoken_text(plot, start, end, events))
    return (
        f'<figure class="plot"><figcaption>{html(plot.title)} <span>{html(plot.unit)}</span></figcaption>'
        f'<svg viewBox="0 0 {PLOT_WIDTH:.0f} {PLOT_HEIGHT + (18 if several else 0):.0f}" '
        f'role="img" aria-label="{spoken}" data-from="{start!r}" data-to="{end!r}" data-left="{PLOT_LEFT}" '
        f'data-right="{PLOT_RIGHT}">{"".join(parts)}</svg></figure>'
    )


def line(kind: str, x: tuple[float, float], y: tuple[float, float]) -> str:
    return f'<line class="{kind}" x1="{x[0]:.1f}" x2="{x[1]:.1f}" y1="{y[0]:.1f}" y2="{y[1]:.1f}"/>'


def text(x: float, y: float, text: str, anchor: str = "", kind: str = "tick") -> str:
    anchored = f' text-anchor="{anchor}"' if anchor else ""
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}"{anchored}>{text}</text>'


def _spoken_text(plot: Plot, start: float, end: float, events: Sequence[tuple[float, str]]) -> str:
    texts = []
    for series in plot.series:
        finite = series.values[np.isfinite(series.values)]
        if len(finite):
            name = f"{series.label}: " if series.label else ""
            texts.append(f"{name}{number(float(finite.min()))} to {number(float(finite.max()))} {plot.unit}")
    limits = "".join(f", {label} {number(value)} {plot.unit}" for label, value in plot.limits)
    happens = "".join(f", at {number(moment)} s {event}" for moment, event in events[:MOST_EVENTS])
    return f"{plot.title} from {number(start)} to {number(end)} s: {'; '.join(texts)}{limits}{happens}"


def ticks_of(plot: Plot) -> list[float]:
    """Three to six round values around everything that is drawn."""
    every = np.concatenate([s.values for s in plot.series] + [np.array([v for _, v in plot.limits])])
    every = every[np.isfinite(every)]
    low, high = (float(every.min()), float(every.max())) if len(every) else (0.0, 1.0)
    if high - low <= SOLVED * max(abs(low), abs(high), ARITHMETIC):
        pad = abs(high) * 0.5 or 1.0
        low, high = low - pad, high + pad
    # Steps of a scale at least about so many, before they are made round: what stands beside the axis without crowding.
    # Chosen, not measured.
    raw = (high - low) / 4.0
    power = 10.0 ** math.floor(math.log10(raw))
    # Round steps of a scale, times a power of ten.
    step = next(m * power for m in (1.0, 2.0, 2.5, 5.0, 10.0) if m * power >= 0.999 * raw)
    first, last = math.floor(low / step + SOLVED), math.ceil(high / step - SOLVED)
    return [k * step if k else 0.0 for k in range(first, last + 1)]


def _path(x: Array, y: Array) -> str:
    """The curve, with gaps where it is not known."""
    keep = _kept_samples(y)
    out, pen = [], "M"
    for k in keep:
        if not math.isfinite(y[k]):
            pen = "M"
            continue
        out.append(f"{pen}{x[k]:.1f} {y[k]:.1f}")
        pen = "L"
    return "".join(out)


def _kept_samples(y: Array) -> Sequence[int]:
    if len(y) <= 2 * MOST_COLUMNS:
        return range(len(y))
    edges = np.linspace(0, len(y), MOST_COLUMNS + 1).astype(int)
    kept = {0, len(y) - 1}
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        piece = np.where(np.isfinite(y[a:b]), y[a:b], 0.0)
        kept |= {a + int(piece.argmin()), a + int(piece.argmax())}
    return sorted(kept)


def number(value: float) -> str:
    return f"{value + 0.0:.4g}"
