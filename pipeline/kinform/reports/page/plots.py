"""Plots of a run: joint values with their limits, sensors, efforts of drives, reactions, energy, spectra, envelopes."""

from __future__ import annotations

import math
from dataclasses import replace
from importlib.resources import files

import numpy as np

from kinform.design import Design
from kinform.foundation.escapes import html
from kinform.foundation.rounding import ARITHMETIC
from kinform.foundation.units import metres_per
from kinform.function import designers_joints, stated_ranges
from kinform.model.arrays import Ints
from kinform.model.simulation import Simulation
from kinform.reports.page.curves import Plot, Series, number, plot_svg
from kinform.reports.page.sizing import SIZED, sizing_svgs
from kinform.reports.page.spectra import AROUND, METHOD, envelope_plots, spectrum_svg
from kinform.reports.values.runs import coordinates

MOST_PLOTS = 48
"""Plots of one group: twelve rows of four; of spectra, and of envelopes, half as many. Chosen, not measured."""


def plot_groups(design: Design) -> list[tuple[str, list[str], str]]:
    """Groups of plots: heading, SVG of each, and a remark where some are left out."""
    run = design.simulation
    if run is None or len(run.time) < 2:
        return []
    named = {} if design.kinematics is None else designers_joints(design.assembly, design.kinematics)
    titles = {name: f"{one.name}, {name}" for name, one in named.items()}
    groups = [
        ("Joint values", _values(design, run, titles)),
        ("Sensors", _sensors(design, run)),
        ("Drive efforts", _efforts(design, run, titles)),
        ("Friction and losses", _driven(run, titles, LOSING, worked=True)),
        ("Reactions in the joints", _reactions(run, titles)),
        ("Energy", _energy(run)),
    ]
    events = [(item.time, f"{item.parts[0]} and {item.parts[1]} collide") for item in run.collisions or ()]
    out = []
    for heading, found in groups:
        if found:
            left = f"{len(found) - MOST_PLOTS} more are in the results file." if len(found) > MOST_PLOTS else ""
            out.append((heading, [plot_svg(plot, run.time, events) for plot in found[:MOST_PLOTS]], left))
    sized = sizing_svgs(design, run, titles)
    if sized:
        out.append(("Effort over speed of the drives", sized, ""))
    repeating = [*_sensors(design, run), *_driven(run, titles)][: MOST_PLOTS // 2]
    spectra = [svg for svg in (spectrum_svg(plot, run.time) for plot in repeating) if svg]
    enveloped = [plot for one in repeating for plot in envelope_plots(one, run.time)][: MOST_PLOTS // 2]
    if spectra:
        out.append(("Spectra of sensors and drives", spectra, METHOD))
    if enveloped:
        out.append(
            ("Envelopes of sensors and drives", [plot_svg(plot, run.time, events) for plot in enveloped], AROUND)
        )
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
        f'<h4>{html(heading)}</h4><div class="kinform-plots">{"".join(drawn)}</div><p>{html(left)}</p>'
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
    room = max(high - low, ARITHMETIC)
    near = tuple(limit for limit in plot.limits if low - room <= limit[1] <= high + room)
    far = "".join(
        f", {label} {number(value)}{plot.unit} not shown" for label, value in plot.limits if (label, value) not in near
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


def _sensors(design: Design, run: Simulation) -> list[Plot]:
    """What each sensor read of each quantity; angles in degrees, lengths in the units of the design."""
    metres = metres_per(design.assembly.units)
    groups: dict[tuple[str, str], list[int]] = {}
    for k, reading in enumerate(run.readings):
        groups.setdefault((reading.sensor, reading.quantity), []).append(k)
    out = []
    for (sensor, quantity), columns in groups.items():
        first = run.readings[columns[0]]
        scale, shown = _sensor_unit(first.unit, design.assembly.units, metres)
        open_ = [run.readings[k].component or quantity for k in columns if not run.readings[k].known]
        title = f"{sensor}: {quantity}" + (f", not determined: {', '.join(open_)}" if open_ else "")
        series = tuple(Series(run.readings[k].component, run.sensed[:, k] * scale + 0.0) for k in columns)
        plot = Plot(title, shown, series)
        out.append(_with_prefix(plot) if first.unit in ("N", "N·m") else plot)
    return out


def _sensor_unit(unit: str, units: str, metres: float) -> tuple[float, str]:
    """Factor and unit in which a reading is drawn."""
    if unit.startswith("rad"):
        return 180.0 / math.pi, unit.replace("rad", "°", 1)
    if unit == "m" or unit.startswith("m/"):
        return 1.0 / metres, units + unit[1:]
    return 1.0, unit


LOSING = ("friction", "gear_loss", "rotor")
"""Kinds that take work out."""


def _driven(
    run: Simulation, titles: dict[str, str], kinds: tuple[str, ...] = SIZED, *, worked: bool = False
) -> list[Plot]:
    """What each drive of these kinds gives: those that a motor or cylinder stands for. `worked`: and its work."""
    if len(run.drive_effort) != len(run.time):
        return []
    return [
        _with_prefix(
            Plot(
                f"{titles.get(use.joint, use.joint)}: {use.kind.replace('_', ' ')}"
                + (f", {number(use.work)} J" if worked else ""),
                "N" if use.slides else "N·m",
                (Series("", run.drive_effort[:, k] + 0.0),),
            )
        )
        for k, use in enumerate(run.drives)
        if use.kind in kinds
    ]


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
