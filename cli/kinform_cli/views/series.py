"""The series of a simulated run, each as a line with its extremes and when they occur.

A line has blocks of eight heights, or where the output cannot show these, characters of growing weight. Each column
stands for a stretch of the series and shows its value that is farthest from the median, so that no peak is lost.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.model.simulation import Simulation
from kinform.reports.values.runs import coordinates
from kinform_cli.tables import Rows
from kinform_cli.text import Lengths, degrees, number, scaled

SPARK_WIDTH = 20
"""Characters of a line of blocks: with the extremes it fits in 80 columns where names are short."""


BLOCKS = "▁▂▃▄▅▆▇█"
PLAIN = "_.:-=+*#"

Series = tuple[str, NDArray[np.float64], bool]
"""(name, values (T,), whether they are angles)."""
Measured = tuple[str, str, NDArray[np.float64]]
"""(name, unit, values (T,) in it)."""


def render(run: Simulation, lengths: Lengths) -> Rows | None:
    """One row a series; None where nothing was simulated."""
    series = list(_series(run, lengths))
    if len(run.time) < 2 or not series:
        return None
    end = number(float(run.time[-1]))
    rows = Rows(
        "series",
        "lowest",
        "at s",
        "highest",
        "at s",
        f"0 to {end} s",
        right=("lowest", "at s", "highest"),
        names=["series"],
    )
    for name, values, angles in series:
        least, most = _extremes(values)
        rows.add(
            name,
            _value(float(values[least]), angles),
            number(float(run.time[least])),
            _value(float(values[most]), angles),
            number(float(run.time[most])),
            spark(values, SPARK_WIDTH, _levels()),
        )
    return rows


def _extremes(values: NDArray[np.float64]) -> tuple[int, int]:
    """Where the lowest and the highest are: the first places that are not lower or higher by rounding only."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    same = SINGLE * (high - low)
    return int(np.argmax(values <= low + same)), int(np.argmax(values >= high - same))


def _series(run: Simulation, lengths: Lengths) -> Iterator[Series]:
    """Positions, then what moves them, then energies; what is not known throughout is left out."""
    efforts: list[Measured] = []
    columns = list(coordinates(run))
    rest = {
        unit: SOLVED * np.nanmax(np.abs(run.joint_position[:, [c for *_, u, c in columns if u == unit]]), initial=0.0)
        for unit in sorted({unit for *_, unit, _ in columns})
    }
    for name, _, unit, column in columns:
        values = run.joint_position[:, column]
        values = np.where(np.nanmax(np.abs(values), initial=0.0) > rest[unit], values, 0.0 * values)
        angles = unit == "rad"
        label = f"{name} {lengths.unit}" if unit == "m" else name
        yield label, values / lengths.metres if unit == "m" else values, angles
        effort = run.joint_effort[:, column]
        if np.isfinite(effort).any():
            efforts.append((name, "N" if unit == "m" else "N·m", effort))
    yield from _beyond_rounding(efforts)
    yield from _reactions(run)
    if len(run.energy):
        energies = [(name, "J", run.energy[:, k]) for k, name in enumerate(("kinetic", "potential"))]
        yield from _beyond_rounding([item for item in energies if np.isfinite(item[2]).any()])


def _reactions(run: Simulation) -> Iterator[Series]:
    """Sizes of the forces and torques that joints carry, where the run has them."""
    wrenches = run.F_B
    if len(wrenches) != len(run.time) or not np.isfinite(wrenches).all():
        return
    for k, name in enumerate(run.joint_names):
        yield _in_words(f"{name} |F|", "N", np.linalg.norm(wrenches[:, k, 3:], axis=1))
        yield _in_words(f"{name} |τ|", "N·m", np.linalg.norm(wrenches[:, k, :3], axis=1))


def _beyond_rounding(measured: list[Measured]) -> Iterator[Series]:
    """Those that are more than rounding beside the greatest of them."""
    sizes = [float(np.nanmax(np.abs(values))) for *_, values in measured]
    for item, size in zip(measured, sizes, strict=True):
        if size > SOLVED * max(sizes):
            yield _in_words(*item)


def _in_words(name: str, unit: str, values: NDArray[np.float64]) -> Series:
    """The series in thousandths or thousands of its unit where that reads better."""
    shown, factor = scaled(unit, float(np.nanmax(np.abs(values))))
    return f"{name} {shown}", factor * values, False


def _value(value: float, angles: bool) -> str:
    return degrees(round(value, 12)) if angles and math.isfinite(value) else number(value)


def _levels() -> str:
    """The characters that stdout can show, from low to high."""
    try:
        BLOCKS.encode(getattr(sys.stdout, "encoding", None) or "utf-8")
    except (UnicodeError, LookupError):
        return PLAIN
    return BLOCKS


def spark(values: NDArray[np.float64], width: int, characters: str = BLOCKS) -> str:
    """The series (T,), in at most `width` characters: blanks where nothing is known, the lowest if constant."""
    finite = values[np.isfinite(values)]
    if not len(finite) or width < 1:
        return ""
    low, high = float(finite.min()), float(finite.max())
    middle = float(np.median(finite))
    line = ""
    for stretch in np.array_split(values, min(width, len(values))):
        inside = stretch[np.isfinite(stretch)]
        if not len(inside):
            line += " "
            continue
        value = float(inside[np.argmax(np.abs(inside - middle))])
        share = (value - low) / (high - low) if high > low else 0.0
        line += characters[min(int(share * len(characters)), len(characters) - 1)]
    return line
