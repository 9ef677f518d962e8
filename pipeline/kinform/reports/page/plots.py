"""Curves over time as SVG: joint values with their limits, efforts of drives, reactions, energy.

Series differ by dash and by a label, not by colour alone. Long runs are thinned to the extremes of each column.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape
from importlib.resources import files
from typing import Any

import numpy as np

from kinform.design import Design
from kinform.foundation.units import metres_per
from kinform.function import designers_joints, stated_ranges
from kinform.model.arrays import Array, Ints
from kinform.model.simulation import Simulation
from kinform.reports import constants
from kinform.reports.page.subjects import wanted_names
from kinform.reports.values.runs import coordinates


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


def plot_groups(design: Design) -> list[tuple[str, list[str], str]]:
    """Groups of plots: heading, SVG of each, and a remark where some are left out."""
    run = design.simulation
    if run is None or len(run.time) < 2:
        return []
    titles = {name: f"{', '.join(known)}, {name}" for name, known in wanted_names(design).items()}
    groups = [
        ("Joint values", _values(design, run, titles)),
        ("Drive efforts", _efforts(design, run, titles)),
        ("Reactions in the joints", _reactions(run, titles)),
        ("Energy", _energy(run)),
    ]
    events = [(item.time, f"{item.parts[0]} and {item.parts[1]} collide") for item in run.collisions or ()]
    out = []
    for heading, found in groups:
        if found:
            left = (
                f"{len(found) - constants.MOST_PLOTS} more are in the results file."
                if len(found) > constants.MOST_PLOTS
                else ""
            )
            out.append((heading, [plot_svg(plot, run.time, events) for plot in found[: constants.MOST_PLOTS]], left))
    return out


_CELL = (
    ".kinform-plots{--line:#8884;--soft:#888;--bad:#c2410c;--c0:#3f7fbf;--c1:#c9772b;--c2:#2e9e76;"
    "display:grid;grid-template-columns:repeat(auto-fill,minmax(330px,1fr));gap:14px 28px}"
)
"""Colours that are readable on white and on black: a notebook does not say which it is."""


def plots_html(design: Design) -> str:
    """All plots with their style, for a cell of a notebook."""
    css = files("kinform.reports.page").joinpath("assets", "page.css").read_text(encoding="utf-8")
    style = "".join(f".kinform-plots {line}" for line in css.splitlines() if line.startswith(".plot "))
    shown = [
        f'<h4>{escape(heading)}</h4><div class="kinform-plots">{"".join(drawn)}</div><p>{escape(left)}</p>'
        for heading, drawn, left in plot_groups(design)
    ]
    return f"<style>{_CELL}{style}</style>{''.join(shown) or '<p>nothing was simulated</p>'}"


def _values(design: Design, run: Simulation, titles: dict[str, str]) -> list[Plot]:
    metres = metres_per(design.assembly.units)
    stated = [] if design.kinematics is None else list(stated_ranges(design.assembly, design.kinematics))
    signs = _signs(design, run)
    out = []
    for name, kind, unit, column in coordinates(run):
        scale, shown = _scale(unit, design.assembly.units, metres)
        scale *= signs[column]
        values = run.joint_position[:, column] * scale + 0.0
        limits: list[tuple[str, float]] = []
        if "." not in name and kind in ("revolute", "prismatic") and design.ranged is not None:
            found = next((j for j in design.ranged.joints if j.name == name), None)
            if found is not None:
                ends = [("found", found.range_lower, found.range_upper)] if found.range_status == "found" else []
                wanted = next((ends for joint, ends in stated if joint == name), None)
                ends += [("required", *wanted)] if wanted is not None else []
                for word, low, high in ends:
                    limits += [(f"{word} limit", v * scale) for v in (low, high) if v is not None and math.isfinite(v)]
        out.append(_without_far_limits(Plot(titles.get(name, name), shown, (Series("", values),), tuple(limits))))
    return out


def _without_far_limits(plot: Plot) -> Plot:
    """The plot without the limits found that are so far from the curve that it would be flat; they are named."""
    every = [
        v for s in plot.series for v in (float(np.nanmin(s.values)), float(np.nanmax(s.values))) if math.isfinite(v)
    ]
    every += [value for label, value in plot.limits if not label.startswith("found")]
    if not every:
        return plot
    low, high = min(every), max(every)
    room = max(high - low, 1e-12)
    near = tuple(limit for limit in plot.limits if low - room <= limit[1] <= high + room)
    far = "".join(
        f", {label} {_number(value)}{plot.unit} not shown" for label, value in plot.limits if (label, value) not in near
    )
    return replace(plot, title=plot.title + far, limits=near)


def _signs(design: Design, run: Simulation) -> Ints:
    """(n,) of the designer's values in kinform's, by coordinate of the run."""
    known = {} if design.kinematics is None else designers_joints(design.assembly, design.kinematics)
    signs = [known[name].sign if name in known else 1 for name in run.joint_names]
    return np.repeat(np.array(signs, dtype=np.int64), np.diff(run.joint_offset))


def _efforts(design: Design, run: Simulation, titles: dict[str, str]) -> list[Plot]:
    signs = _signs(design, run)
    out = []
    for name, _, unit, column in coordinates(run):
        values = signs[column] * run.joint_effort[:, column] + 0.0 if run.joint_effort.size else np.zeros(0)
        if len(values) and np.isfinite(values).any() and np.nanmax(np.abs(values)) > 0.0:
            out.append(_with_prefix(Plot(titles.get(name, name), "N" if unit == "m" else "N·m", (Series("", values),))))
    return out


def _reactions(run: Simulation, titles: dict[str, str]) -> list[Plot]:
    """Force and torque that each joint carries, where the simulation gives them."""
    wrenches = getattr(run, "F_B", np.zeros((0, 0, 6)))
    if wrenches.ndim != 3 or len(wrenches) != len(run.time):
        return []
    out = []
    for k, name in enumerate(run.joint_names):
        for unit, part, what in (("N", slice(3, 6), "force"), ("N·m", slice(0, 3), "torque")):
            size = np.linalg.norm(wrenches[:, k, part], axis=1)
            out.append(_with_prefix(Plot(f"{titles.get(name, name)}: {what}", unit, (Series("", size),))))
    return out


def _energy(run: Simulation) -> list[Plot]:
    if not run.energy.size or not np.isfinite(run.energy).any():
        return []
    names = ("kinetic", "potential", "work put in")
    base = np.array([0.0, run.energy[0, 1], 0.0])
    series = tuple(Series(name, run.energy[:, k] - base[k]) for k, name in enumerate(names))
    balance = run.energy[:, 0] + run.energy[:, 1] - run.energy[:, 2]
    return [
        _with_prefix(Plot("Energy, potential from its start", "J", series)),
        _with_prefix(Plot("Error of the balance", "J", (Series("", balance - balance[0]),))),
    ]


def _with_prefix(plot: Plot) -> Plot:
    """The plot with a prefix before its unit, so that its numbers are short."""
    largest = max((float(np.nanmax(np.abs(s.values), initial=0.0)) for s in plot.series), default=0.0)
    for factor, prefix in ((1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"), (1e-15, "f")):
        if largest >= factor:
            return replace(
                plot, unit=prefix + plot.unit, series=tuple(replace(s, values=s.values / factor) for s in plot.series)
            )
    return plot


def _scale(unit: str, units: str, metres: float) -> tuple[float, str]:
    if unit == "rad":
        return 180.0 / math.pi, "°"
    return (1.0 / metres, units) if unit == "m" else (1.0, "")


def plot_svg(plot: Plot, time: Array, events: Sequence[tuple[float, str]] = ()) -> str:
    """The plot as SVG, with upright lines for events (s, what happens); the viewer moves its cursor."""
    ticks = _ticks(plot)
    low, high = ticks[0], ticks[-1]
    start, end = float(time[0]), float(time[-1])

    def x(t: Any) -> Any:
        return constants.PLOT_LEFT + (t - start) / ((end - start) or 1.0) * (constants.PLOT_RIGHT - constants.PLOT_LEFT)

    def y(value: Any) -> Any:
        return constants.PLOT_BOTTOM - (value - low) / ((high - low) or 1.0) * (
            constants.PLOT_BOTTOM - constants.PLOT_TOP
        )

    across, upright = (constants.PLOT_LEFT, constants.PLOT_RIGHT), (constants.PLOT_TOP, constants.PLOT_BOTTOM)
    parts = []
    for tick in ticks:
        parts += [
            _line("grid", across, (y(tick), y(tick))),
            _text(constants.PLOT_LEFT - 6, y(tick) + 3.5, _number(tick), "end"),
        ]
    for share, anchor in ((0.0, "start"), (0.5, "middle"), (1.0, "end")):
        text = _number(start + share * (end - start)) + (" s" if share == 1.0 else "")
        parts.append(
            _text(
                constants.PLOT_LEFT + share * (constants.PLOT_RIGHT - constants.PLOT_LEFT),
                constants.PLOT_BOTTOM + 16,
                text,
                anchor,
            )
        )
    for label, value in plot.limits:
        at = y(value)
        inside = at + (11.0 if at < (constants.PLOT_TOP + constants.PLOT_BOTTOM) / 2 else -4.0)
        side, anchor = (
            (constants.PLOT_LEFT + 4.0, "start") if label.startswith("found") else (constants.PLOT_RIGHT, "end")
        )
        text = escape(f"{label} {_number(value)}{plot.unit}")
        parts += [_line("limit", across, (at, at)), _text(side, inside, text, anchor)]
    for moment, event in events[: constants.MOST_EVENTS]:
        sign = f"✕<title>{escape(event)}</title>"
        parts.append(_line("event", (x(moment), x(moment)), upright))
        parts.append(_text(x(moment), constants.PLOT_TOP - 2, sign, "middle", "tick event-sign"))
    parts += [
        f'<path class="curve curve-{k}" d="{_path(x(time), y(series.values))}"/>'
        for k, series in enumerate(plot.series)
    ]
    several, below = len(plot.series) > 1, constants.PLOT_HEIGHT + 8
    for k, series in enumerate(plot.series if several else ()):
        at = constants.PLOT_LEFT + 104.0 * k
        parts.append(_line(f"curve curve-{k}", (at, at + 18), (below, below)))
        parts.append(_text(at + 23, constants.PLOT_HEIGHT + 12, escape(series.label)))
    parts.append(
        f'<line class="cursor" visibility="hidden" x1="0" x2="0" '
        f'y1="{constants.PLOT_TOP}" y2="{constants.PLOT_BOTTOM}"/>'
    )
    spoken = escape(_spoken_text(plot, start, end, events), quote=True)
    return (
        f'<figure class="plot"><figcaption>{escape(plot.title)} <span>{escape(plot.unit)}</span></figcaption>'
        f'<svg viewBox="0 0 {constants.PLOT_WIDTH:.0f} {constants.PLOT_HEIGHT + (18 if several else 0):.0f}" '
        f'role="img" aria-label="{spoken}" data-from="{start!r}" data-to="{end!r}" data-left="{constants.PLOT_LEFT}" '
        f'data-right="{constants.PLOT_RIGHT}">{"".join(parts)}</svg></figure>'
    )


def _line(kind: str, x: tuple[float, float], y: tuple[float, float]) -> str:
    return f'<line class="{kind}" x1="{x[0]:.1f}" x2="{x[1]:.1f}" y1="{y[0]:.1f}" y2="{y[1]:.1f}"/>'


def _text(x: float, y: float, text: str, anchor: str = "", kind: str = "tick") -> str:
    anchored = f' text-anchor="{anchor}"' if anchor else ""
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}"{anchored}>{text}</text>'


def _spoken_text(plot: Plot, start: float, end: float, events: Sequence[tuple[float, str]]) -> str:
    texts = []
    for series in plot.series:
        finite = series.values[np.isfinite(series.values)]
        if len(finite):
            name = f"{series.label}: " if series.label else ""
            texts.append(f"{name}{_number(float(finite.min()))} to {_number(float(finite.max()))} {plot.unit}")
    limits = "".join(f", {label} {_number(value)} {plot.unit}" for label, value in plot.limits)
    happens = "".join(f", at {_number(moment)} s {text}" for moment, text in events[: constants.MOST_EVENTS])
    return f"{plot.title} from {_number(start)} to {_number(end)} s: {'; '.join(texts)}{limits}{happens}"


def _ticks(plot: Plot) -> list[float]:
    """Three to six round values around everything that is drawn."""
    every = np.concatenate([s.values for s in plot.series] + [np.array([v for _, v in plot.limits])])
    every = every[np.isfinite(every)]
    low, high = (float(every.min()), float(every.max())) if len(every) else (0.0, 1.0)
    if high - low <= constants.FLAT * max(abs(low), abs(high), 1e-12):
        pad = abs(high) * 0.5 or 1.0
        low, high = low - pad, high + pad
    raw = (high - low) / constants.TICKS
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(m * power for m in constants.ROUND_STEPS if m * power >= 0.999 * raw)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
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
    if len(y) <= 2 * constants.MOST_COLUMNS:
        return range(len(y))
    edges = np.linspace(0, len(y), constants.MOST_COLUMNS + 1).astype(int)
    kept = {0, len(y) - 1}
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        piece = np.where(np.isfinite(y[a:b]), y[a:b], 0.0)
        kept |= {a + int(piece.argmin()), a + int(piece.argmax())}
    return sorted(kept)


def _number(value: float) -> str:
    return f"{value + 0.0:.4g}"
