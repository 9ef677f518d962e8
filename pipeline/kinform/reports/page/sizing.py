"""What drives must be able to do: their efforts over their speeds as SVG, with peaks and root mean squares.

The points are those of the run's output times, in all four quadrants: in the first and third a drive gives power, in
the other two it takes it up.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from kinform.design import Design
from kinform.foundation.escapes import html
from kinform.foundation.units import metres_per
from kinform.model.arrays import Array
from kinform.model.simulation import DriveUse, Simulation
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
    ticks_of,
)

SIZED = ("motion", "effort", "servo", "dc_motor")
"""Kinds of drives that a motor or cylinder stands for."""


def sizing_svgs(design: Design, run: Simulation, titles: Mapping[str, str]) -> list[str]:
    """A plot of each drive that moved or held something, called as `titles` call its joint; turns in revolutions a
    minute, slides in the design's units a second."""
    metres = metres_per(design.assembly.units)
    out = []
    for k, use in enumerate(run.drives):
        if use.kind not in SIZED or len(run.drive_effort) != len(run.time):
            continue
        speed, unit = (1.0 / metres, f"{design.assembly.units}/s") if use.slides else (30.0 / math.pi, "1/min")
        curve = run.drive_speed[:, k] * speed + 0.0, run.drive_effort[:, k] + 0.0
        if np.isfinite(curve).all():
            out.append(_figure(titles.get(use.joint, use.joint), use, *curve, unit, "N" if use.slides else "N·m"))
    return out


def _figure(title: str, use: DriveUse, speeds: Array, efforts: Array, speed_unit: str, unit: str) -> str:
    across = ticks_of(Plot("", "", (Series("", np.append(speeds, 0.0)),)))
    upright = ticks_of(Plot("", "", (Series("", np.append(efforts, 0.0)),), (("", use.rms),)))

    def x(value: float) -> float:
        share = (value - across[0]) / (across[-1] - across[0])
        return PLOT_LEFT + share * (PLOT_RIGHT - PLOT_LEFT)

    def y(value: float) -> float:
        share = (value - upright[0]) / (upright[-1] - upright[0])
        return PLOT_BOTTOM - share * (PLOT_BOTTOM - PLOT_TOP)

    sides, ends = (PLOT_LEFT, PLOT_RIGHT), (PLOT_TOP, PLOT_BOTTOM)
    parts = []
    for tick in upright:
        parts += [line("grid", sides, (y(tick), y(tick)))]
        parts += [text(PLOT_LEFT - 6, y(tick) + 3.5, number(tick), "end")]
    parts.append(line("grid", (x(0.0), x(0.0)), ends))
    for tick, anchor in ((across[0], "start"), (across[-1], "end")):
        said = number(tick) + (f" {speed_unit}" if tick == across[-1] else "")
        parts.append(text(x(tick), PLOT_BOTTOM + 16, said, anchor))
    parts += [line("limit", sides, (y(use.rms), y(use.rms)))]
    parts += [text(PLOT_RIGHT, y(use.rms) - 4.0, f"RMS {number(use.rms)}", "end")]
    parts.append(f'<path class="curve curve-0" d="{_course(x, y, speeds, efforts)}"/>')
    name = f"{title}: {use.kind.replace('_', ' ')}"
    facts = (
        f"peak {number(use.peak)} {unit}, RMS {number(use.rms)} {unit}, up to {number(float(np.abs(speeds).max()))} "
        f"{speed_unit}, peak {number(use.peak_power)} W, RMS {number(use.rms_power)} W"
    )
    return (
        f'<figure class="plot"><figcaption>{html(name)} <span>{html(f"{unit} over {speed_unit}; {facts}")}</span>'
        f'</figcaption><svg viewBox="0 0 {PLOT_WIDTH:.0f} {PLOT_HEIGHT:.0f}" role="img" '
        f'aria-label="{html(f"{name}, effort over speed: {facts}")}">{"".join(parts)}</svg></figure>'
    )


def _course(x: Callable[[float], float], y: Callable[[float], float], speeds: Array, efforts: Array) -> str:
    """The path through the points of the run, thinned evenly where there are many."""
    keep: Sequence[int] = range(len(speeds))
    if len(speeds) > 2 * MOST_COLUMNS:
        spread = np.linspace(0, len(speeds) - 1, 2 * MOST_COLUMNS).round().astype(int).tolist()
        keep = sorted({*spread, int(np.abs(efforts).argmax()), int(np.abs(speeds).argmax())})
    return "M" + "L".join(f"{x(float(speeds[k])):.1f} {y(float(efforts[k])):.1f}" for k in keep)
