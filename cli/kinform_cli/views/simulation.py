"""A simulated run in short; the trajectories themselves are in the results file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rich.console import RenderableType
from rich.text import Text

from kinform.design import Design
from kinform.foundation.rounding import SOLVED
from kinform.foundation.words import by_cause, counted
from kinform.function import as_intended, designers_joints
from kinform.model.simulation import Simulation
from kinform_cli.tables import Rows, stacked
from kinform_cli.text import Lengths, degrees, number, quantity

BALANCED = 1e-8
"""Share of the largest energy below which the balance is as exact as the integration is asked to be."""
NAMED_PAIRS = 3
"""Pairs of parts that are named where all have one reason."""


_NUMBERS = ("start", "end", "lowest", "highest", "fastest")
_SHOWN: dict[str, Any] = {"names": ["joint"], "texts": ["stopped by"]}
_COMPONENTS = ("τx", "τy", "τz", "Fx", "Fy", "Fz")


def render(design: Design) -> RenderableType:
    """One sentence, one row a joint coordinate, then what was assumed and what failed."""
    run, lengths = design.simulation, Lengths.of(design.assembly)
    assert run is not None
    if design.kinematics is not None:
        run = as_intended(run, designers_joints(design.assembly, design.kinematics))
    items: list[RenderableType] = [Text(headline(run), style="bold")]
    if run.not_dynamic:
        items.append(f"not dynamic: {by_cause(run.not_dynamic)}")
    if len(run.time) and run.joint_names:
        from kinform.reports.values.runs import coordinates
        from kinform_cli.views import series

        rows = Rows("joint", "type", *_NUMBERS, right=_NUMBERS, names=["joint"])
        for name, kind, unit, column in coordinates(run):
            values = run.joint_position[:, column]
            shown = [_value(unit, float(x), lengths) for x in (values[0], values[-1], values.min(), values.max())]
            rows.add(name, kind, *shown, _rate(unit, float(abs(run.joint_velocity[:, column]).max()), lengths))
        items.append(rows)
        lines = series.render(run, lengths)
        if lines is not None:
            items += ["", lines]
    items += _drives(run) + _gears(run) + _undetermined(run)
    if len(run.energy) and not math.isnan(run.energy[0, 0]):
        items.append(_energy(run))
    items += _ranges(run, lengths) + _collisions(run, lengths)
    items += [f"assumed: {sentence}" for sentence in run.assumptions]
    items += [f"failed: {subject}: {message}" for subject, message in run.failures]
    return stacked(*items)


def headline(run: Simulation) -> str:
    """What ran, or why nothing did, in one sentence."""
    why = f": {run.reason}" if run.reason else ""
    if not len(run.time):
        return f"Simulation {run.status}{why}"
    level = f", {run.level} level" if run.level else ""
    extent = f"{number(float(run.time[-1]))} s in {counted(len(run.time), 'sample')}"
    return f"Simulation {run.status}{level}, {extent}{why}"


def _drives(run: Simulation) -> list[RenderableType]:
    """What each drive gave; for a prescribed motion that is what a motor must be able to do."""
    if not run.drives:
        return []
    slides = dict(zip(run.joint_names, run.joint_types, strict=True))
    columns = ("peak", "RMS", "top speed", "peak power", "work")
    rows = Rows("drive on", "kind", *columns, title="\ndrives", right=columns, names=["drive on"])
    for use in run.drives:
        unit = "N" if use.slides or slides.get(use.joint) == "prismatic" else "N·m"
        efforts = (quantity(value, unit) for value in (use.peak, use.rms))
        # what goes in and comes out again leaves rounding, which differs between machines
        rest = SOLVED * use.peak_power * float(run.time[-1] - run.time[0])
        work = use.work if abs(use.work) > rest else 0.0
        power = quantity(use.peak_power, "W"), quantity(work, "J")
        speed = quantity(use.peak_speed, "m/s" if unit == "N" else "rad/s")
        rows.add(use.joint, use.kind.replace("_", " "), *efforts, speed, *power)
    return [rows]


def _gears(run: Simulation) -> list[RenderableType]:
    """What each gear passed on at most: to its two joints, and between its teeth."""
    if not run.gear_names or not len(run.gear_effort):
        return []
    columns = ("peak on the first joint", "on the second", "between the teeth N")
    rows = Rows("gear", *columns, title="\nefforts that gears pass on (N·m or N)", right=columns, names=["gear"])
    for k, name in enumerate(run.gear_names):
        peaks = (*abs(run.gear_effort[:, k]).max(axis=0), abs(run.gear_force[:, k]).max())
        rows.add(name, *(number(float(peak)) if math.isfinite(peak) else "not known" for peak in peaks))
    return [rows]


def _undetermined(run: Simulation) -> list[RenderableType]:
    """Which components of the reactions redundancy leaves open."""
    if len(run.undetermined) != len(run.joint_names):
        return []
    out: list[RenderableType] = []
    for name, flags in zip(run.joint_names, run.undetermined, strict=True):
        loose = [label for label, flag in zip(_COMPONENTS, flags, strict=True) if flag]
        if loose:
            out.append(f"not determined, redundancy leaves it open: {', '.join(loose)} of {name}")
    return out


def _ranges(run: Simulation, lengths: Lengths) -> list[RenderableType]:
    """How far each joint goes to both sides, and what stops it."""
    if not run.ranges:
        return []
    rows = Rows("joint", "from", "to", "stopped by", title="ranges until parts meet", right=("from", "to"), **_SHOWN)
    reasons = []
    for item in run.ranges:
        unit = "m" if item.slides else "rad"
        ends = (item.lower, item.upper)
        shown = [end.status if end.value is None else _value(unit, end.value, lengths) for end in ends]
        stops = ["/".join(end.parts) or ("dead point" if end.status == "found" else "") for end in ends]
        rows.add(item.joint, *shown, ", ".join(dict.fromkeys(stop for stop in stops if stop)))
        why = dict.fromkeys(end.reason for end in ends if end.status == "unknown")
        reasons += [f"range of {item.joint} unknown: {reason}" for reason in why]
        if item.left_out and not why:
            reasons.append(f"range of {item.joint}: without {_pairs(item.left_out)}, which overlap, or roll")
    return [rows, *reasons]


def _pairs(pairs: Sequence[tuple[str, str]]) -> str:
    more = len(pairs) - NAMED_PAIRS
    rest = f", and {counted(more, 'pair')} more" if more > 0 else ""
    return ", ".join(" and ".join(pair) for pair in pairs[:NAMED_PAIRS]) + rest


def _collisions(run: Simulation, lengths: Lengths) -> list[RenderableType]:
    """First contacts in the order of time, and the pairs of which nothing is known."""
    out: list[RenderableType] = [
        f"collision: {' and '.join(item.parts)} at t = {number(item.time)} s, "
        f"at {lengths.point(item.place)} {lengths.unit}"
        for item in run.collisions or ()
    ]
    pairs: dict[str, list[str]] = {}
    for a, b, why in run.uncollided:
        pairs.setdefault(why, []).append(f"{a} and {b}")
    for why, names in pairs.items():
        more = len(names) - NAMED_PAIRS
        rest = f"; and {counted(more, 'pair')} more" if more > 0 else ""
        out.append(f"collision unknown of {'; '.join(names[:NAMED_PAIRS])}{rest}: {why}")
    return out


def _energy(run: Simulation) -> str:
    balance = run.energy[:, 0] + run.energy[:, 1] - run.energy[:, 2]
    lost = float(abs(balance - balance[0]).max())
    exact = lost <= BALANCED * float(abs(run.energy).max())
    return (
        "energy: the balance holds to eight digits"
        if exact
        else f"energy: the balance is off by up to {quantity(lost, 'J')}"
    )


def _value(unit: str, value: float, lengths: Lengths) -> str:
    if unit == "rad":
        return degrees(value)
    return f"{lengths.place(value)} {lengths.unit}" if unit == "m" else _quaternion(value)


def _rate(unit: str, value: float, lengths: Lengths) -> str:
    """Of a quaternion's coordinates the rates are those of the rotation vector; the first has none."""
    return f"{_value('rad' if unit == '1' else unit, value, lengths)}/s"


def _quaternion(value: float) -> str:
    return f"{value:.4f}"
