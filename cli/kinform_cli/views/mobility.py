"""Mobility: how many freedoms, counted in the ways that the results contract defines."""

from __future__ import annotations

from rich.console import Group, RenderableType

from kinform.model.design import Design
from kinform.reports.json_views import mobility_counts
from kinform_cli.text import table

__all__ = ["render"]

_MEANINGS = (
    ("effective", "without idle freedoms: what the function's `mobility` is compared with"),
    ("instantaneous", "velocities that the bilateral constraints leave"),
    ("finite", "of these, motions that go on over a finite distance"),
    ("idle", "freedoms that move one body within surfaces that slide on themselves"),
    ("redundant", "constraints more than are needed"),
    ("blocked_mobility", "instantaneous, counted with everything that blocks"),
)


def render(design: Design) -> RenderableType:
    """The counts with their meaning."""
    assert design.kinematics is not None
    mobility = design.kinematics.mobility
    grid = table("count", "", "meaning", title="Mobility relative to ground", right=["count"])
    values = mobility_counts(mobility)
    for name, meaning in _MEANINGS:
        value = values[name]
        grid.add_row("not computed" if value is None else str(value), name.replace("_", " "), meaning)
    items: list[RenderableType] = [grid]
    if mobility.idle_bodies:
        items.append(f"idle: {', '.join(mobility.idle_bodies)}")
    if mobility.uncertain:
        items.append(f"the counts depend on joints that are not certain: {', '.join(mobility.uncertain)}")
    return Group(*items)
