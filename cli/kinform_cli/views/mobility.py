"""Mobility: how many freedoms, counted in the ways that the results contract defines."""

from __future__ import annotations

from typing import Any

from rich.console import Group, RenderableType

from kinform.model.design import Design
from kinform.model.kinematics import Mobility
from kinform_cli.text import table

__all__ = ["counts", "data", "render"]

_MEANINGS = (
    ("effective", "without idle freedoms: what the function's `mobility` is compared with"),
    ("instantaneous", "velocities that the bilateral constraints leave"),
    ("finite", "of these, motions that go on over a finite distance"),
    ("idle", "freedoms that move one body within surfaces that slide on themselves"),
    ("redundant", "constraints more than are needed"),
    ("blocked_mobility", "instantaneous, counted with everything that blocks"),
)


def counts(mobility: Mobility) -> dict[str, int | None]:
    """All counts by name."""
    return {
        "instantaneous": mobility.instantaneous,
        "finite": mobility.finite,
        "effective": mobility.effective,
        "idle": mobility.idle,
        "redundant": mobility.redundant,
        "blocked_mobility": mobility.blocked,
    }


def data(design: Design) -> dict[str, Any]:
    """The counts, the idle bodies, the joints that the counts depend on, and the freedoms."""
    assert design.kinematics is not None
    mobility = design.kinematics.mobility
    return {
        "schema": "kinform/mobility/1",
        "assembly": design.assembly.name,
        **counts(mobility),
        "idle_bodies": mobility.idle_bodies,
        "uncertain": mobility.uncertain,
        "bodies": [body.name for body in design.kinematics.bodies],
        "freedoms": mobility.freedoms,
    }


def render(design: Design) -> RenderableType:
    """The counts with their meaning."""
    assert design.kinematics is not None
    mobility = design.kinematics.mobility
    grid = table("count", "", "meaning", title="Mobility relative to ground", right=["count"])
    values = counts(mobility)
    for name, meaning in _MEANINGS:
        value = values[name]
        grid.add_row("not computed" if value is None else str(value), name.replace("_", " "), meaning)
    items: list[RenderableType] = [grid]
    if mobility.idle_bodies:
        items.append(f"idle: {', '.join(mobility.idle_bodies)}")
    if mobility.uncertain:
        items.append(f"the counts depend on joints that are not certain: {', '.join(mobility.uncertain)}")
    return Group(*items)
