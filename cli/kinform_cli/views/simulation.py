"""A simulated run in short; the trajectories themselves are in the results file."""

from __future__ import annotations

import math

from rich.console import Group, RenderableType
from rich.text import Text

from kinform.model.design import Design
from kinform.model.simulation import Simulation
from kinform.reports.json_views import coordinates
from kinform_cli.text import Lengths, count, degrees, number, table

__all__ = ["headline", "render"]

_ROTATIONAL = ("revolute", "spherical", "universal", "screw")
"""Joints whose coordinates are all angles."""


def _known(design: Design) -> Simulation:
    assert design.simulation is not None
    return design.simulation


def render(design: Design) -> RenderableType:
    """One sentence, one row a joint coordinate, then what was assumed and what failed."""
    run, lengths = _known(design), Lengths.of(design.assembly)
    items: list[RenderableType] = [Text(headline(run), style="bold")]
    if len(run.time) and run.joint_names:
        rows = table("joint", "type", "start", "end", "lowest", "highest", "fastest", right=_NUMBERS)
        for name, kind, column in coordinates(run):
            values = run.joint_position[:, column]
            fastest = abs(run.joint_velocity[:, column]).max()
            rows.add_row(
                name,
                kind,
                *(_value(kind, float(x), lengths) for x in (values[0], values[-1], values.min(), values.max())),
                _value(kind, float(fastest), lengths) + "/s",
            )
        items.append(rows)
    if len(run.energy) and not math.isnan(run.energy[0, 0]):
        balance = run.energy[:, 0] + run.energy[:, 1] - run.energy[:, 2]
        items.append(f"energy: balance within {number(float(abs(balance - balance[0]).max()))} J")
    items += [f"assumed: {sentence}" for sentence in run.assumptions]
    items += [f"failed: {subject}: {message}" for subject, message in run.failures]
    return Group(*items)


_NUMBERS = ("start", "end", "lowest", "highest", "fastest")


def headline(run: Simulation) -> str:
    """What ran, or why nothing did, in one sentence."""
    why = f": {run.reason}" if run.reason else ""
    if not len(run.time):
        return f"Simulation {run.status}{why}"
    level = f", {run.level} level" if run.level else ""
    extent = f"{number(float(run.time[-1]))} s in {count(len(run.time), 'sample')}"
    return f"Simulation {run.status}{level}, {extent}{why}"


def _value(kind: str, value: float, lengths: Lengths) -> str:
    if kind in _ROTATIONAL:
        return degrees(value)
    if kind == "prismatic":
        return f"{lengths.length(value)} {lengths.unit}"
    return number(value)
