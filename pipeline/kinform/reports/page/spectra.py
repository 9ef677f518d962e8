"""Amplitudes by frequency as SVG, on scales of decades, with the greatest lines named; and envelopes over time."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from kinform.foundation.escapes import html
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array
from kinform.reports.page.curves import (
    MOST_COLUMNS,
    PLOT_BOTTOM,
    PLOT_HEIGHT,
    PLOT_LEFT,
    PLOT_RIGHT,
    PLOT_TOP,
    PLOT_WIDTH,
    Plot,
    Series,
    line,
    number,
    text,
)
from kinform.simulation import Spectrum, amplitude_spectrum, envelope

METHOD = (
    "Amplitudes of sines, of what is left without a straight line, under a Hann window over the whole run; between two "
    "frequencies of a spectrum a sine shows up to 15 % lower, its line is named as it is. What is faster than half the "
    "rate of the outputs shows at a lower frequency than it has."
)
"""What the spectra are, as the page says it."""
AROUND = "The least and the greatest within half a period of the strongest line before and after."
"""What the envelopes are."""

_Scales = tuple[Callable[[float], float], Callable[[float], float]]


def spectrum_svg(plot: Plot, time: Array) -> str:
    """The spectra of the plot's series over `time`; empty where none has one."""
    found = [(series.label, amplitude_spectrum(time, series.values)) for series in plot.series]
    drawn = [(label, spectrum) for label, spectrum in found if spectrum is not None]
    top = max((float(spectrum.amplitude.max()) for _, spectrum in drawn), default=0.0)
    size = max(float(np.nanmax(np.abs(series.values), initial=0.0)) for series in plot.series)
    if not top > SOLVED * size:
        return ""
    high = math.ceil(math.log10(top))
    # Decades of amplitude that a spectrum shows: sensors are rarely better, and the lobes of the window fade below.
    low = high - 4
    whole = drawn[0][1].frequency
    seen = max(int(np.flatnonzero(spectrum.amplitude > 10.0**low).max(initial=0)) for _, spectrum in drawn)
    # Frequencies that a spectrum shows at least; else twice as many as stand above its lowest decade. Chosen, not
    # measured.
    last = float(whole[min(max(2 * seen, 24), len(whole) - 1)])
    x, y = _scales(last, low, high)
    several, below = len(drawn) > 1, PLOT_HEIGHT + 8
    parts = _axes(x, y, last, low, high)
    for k, (label, spectrum) in enumerate(drawn):
        if not spectrum.amplitude.max() > 10.0**low:
            continue
        parts.append(f'<path class="curve curve-{k % 3}" d="{_course((x, y), spectrum, last, 10.0**low)}"/>')
        if several:
            at = PLOT_LEFT + 104.0 * k
            parts.append(line(f"curve curve-{k % 3}", (at, at + 18), (below, below)))
            parts.append(text(at + 23, PLOT_HEIGHT + 12, html(label)))
    lines = "; ".join(filter(None, (_lines(label, spectrum, plot.unit) for label, spectrum in drawn)))
    lower = f"; up to {number(float(whole[-1]))} Hz less than {number(10.0**low)}" if last < whole[-1] else ""
    spoken = f"{plot.title}, amplitude in {plot.unit} from 0 to {number(last)} Hz: {lines or 'no line'}{lower}"
    return (
        f'<figure class="plot"><figcaption>{html(plot.title)} <span>{html(f"{plot.unit}; {lines}".strip("; "))}'
        f'</span></figcaption><svg viewBox="0 0 {PLOT_WIDTH:.0f} '
        f'{PLOT_HEIGHT + (18 if several else 0):.0f}" role="img" '
        f'aria-label="{html(spoken)}">{"".join(parts)}</svg></figure>'
    )


def _scales(last: float, low: int, high: int) -> _Scales:
    """px of a frequency (Hz), and of an amplitude."""

    def x(frequency: float) -> float:
        return PLOT_LEFT + frequency / last * (PLOT_RIGHT - PLOT_LEFT)

    def y(amplitude: float) -> float:
        share = (math.log10(max(amplitude, 10.0**low)) - low) / (high - low)
        return PLOT_BOTTOM - share * (PLOT_BOTTOM - PLOT_TOP)

    return x, y


def _axes(x: Callable[[float], float], y: Callable[[float], float], last: float, low: int, high: int) -> list[str]:
    parts = []
    for power in range(low, high + 1):
        parts.append(line("grid", (PLOT_LEFT, PLOT_RIGHT), (y(10.0**power),) * 2))
        parts.append(text(PLOT_LEFT - 6, y(10.0**power) + 3.5, number(10.0**power), "end"))
    for share, anchor in ((0.0, "start"), (0.5, "middle"), (1.0, "end")):
        said = number(share * last) + (" Hz" if share == 1.0 else "")
        parts.append(text(x(share * last), PLOT_BOTTOM + 16, said, anchor))
    return parts


def _course(scales: _Scales, spectrum: Spectrum, last: float, floor: float) -> str:
    """The path through the amplitudes up to the last frequency; of long spectra the greatest of each column."""
    shown = spectrum.frequency <= last
    frequency, amplitude = spectrum.frequency[shown], np.maximum(spectrum.amplitude[shown], floor)
    if len(amplitude) > 2 * MOST_COLUMNS:
        edges = np.linspace(0, len(amplitude), MOST_COLUMNS + 1).astype(int)
        keep = [a + int(amplitude[a:b].argmax()) for a, b in zip(edges[:-1], edges[1:], strict=True)]
        frequency, amplitude = frequency[keep], amplitude[keep]
    x, y = scales
    points = zip(frequency.tolist(), amplitude.tolist(), strict=True)
    return "M" + "L".join(f"{x(f):.1f} {y(a):.1f}" for f, a in points)


def _lines(label: str, spectrum: Spectrum, unit: str) -> str:
    named = ", ".join(f"{number(line.amplitude)} {unit} at {number(line.frequency)} Hz" for line in spectrum.lines)
    return f"{label}: {named}" if label and named else named


def envelope_plots(plot: Plot, time: Array) -> list[Plot]:
    """The envelope of each series that repeats: over one period of its strongest line."""
    out = []
    for series in plot.series:
        spectrum = amplitude_spectrum(time, series.values)
        if spectrum is None or not spectrum.lines:
            continue
        strongest = spectrum.lines[0].frequency
        ends = envelope(time, series.values, 1.0 / strongest)
        if ends is not None:
            title = ", ".join(filter(None, (plot.title, series.label, f"over periods of {number(strongest)} Hz")))
            names = ("curve", "least", "greatest")
            of_all = (series.values, *ends)
            out.append(Plot(title, plot.unit, tuple(Series(name, v) for name, v in zip(names, of_all, strict=True))))
    return out
