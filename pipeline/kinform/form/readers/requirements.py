"""What one key of a requirement says about another: contradictions, and requirements that would ask for nothing.

They are refused where they are read, so that none of them can pass unseen.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from kinform.form.manifest import requirements as tables
from kinform.form.problems import quoted

__all__ = ["faults"]

Fault = tuple[str, str, str | None]
"""What is wrong, the remedy, and the key at which it is."""


def faults(table: Any) -> Iterator[Fault]:
    """Everything that is wrong with one `[[function.require]]`."""
    if isinstance(table, tables.Mass | tables.Inertia | tables.Fit):
        yield from _bounds(table)
    elif isinstance(table, tables.Reach):
        yield from _reach(table)
    elif isinstance(table, tables.Reaction):
        if table.force is None and table.torque is None:
            yield "it limits neither force nor torque", "add force, in N, or torque, in N·m", None
    elif isinstance(table, tables.Balance):
        yield from _balance(table)
    if isinstance(table, tables.Clear | tables.Fit) and table.between is not None and len(set(table.between)) < 2:
        yield f"both sides are {quoted(table.between[0])}", "name two different ones", "between"


def _bounds(table: tables.Mass | tables.Inertia | tables.Fit) -> Iterator[Fault]:
    low, high = table.minimum, table.maximum
    if low is None and high is None:
        yield "it states neither minimum nor maximum", "add one of them", None
    elif low is not None and high is not None and low > high:
        yield f"its minimum, {low:g}, is above its maximum, {high:g}", "exchange them", "minimum"


def _reach(table: tables.Reach) -> Iterator[Fault]:
    if (table.point is None) == (table.direction is None):
        yield "it needs either a point or a direction", "state one of them", None
        return
    pointing, region = table.direction is not None, table.region
    what, other = ("directions", "points") if pointing else ("points", "directions")
    if isinstance(region, tables.Poses):
        if not getattr(region, what):
            yield f"the poses list no {what}", f"add {what} to the region", "region"
        if getattr(region, other) is not None:
            yield f"the poses list {other}, and it is {what} that are asked for", f"remove {other}", "region"
    elif pointing == isinstance(region, tables.Box):
        told = "a box is a region of points" if pointing else "a cone is a region of directions"
        yield told, f"state a {'point' if pointing else 'direction'}, or another region", "region"
    if isinstance(region, tables.Box) and any(a > b for a, b in zip(region.lower, region.upper, strict=True)):
        yield "the lower corner of the box is not below its upper one", "exchange what is the wrong way round", "region"
    stray = "tolerance" if pointing else "angle_tolerance"
    if getattr(table, stray) is not None:
        yield f"{stray} says nothing about {what}", f"state {'angle_tolerance' if pointing else 'tolerance'}", stray


def _balance(table: tables.Balance) -> Iterator[Fault]:
    line = (table.axis is not None, table.point is not None)
    if table.joint is not None and any(line):
        yield "it names a joint, and axis or point too", "keep the joint, or axis and point", "joint"
    elif table.joint is None and not all(line):
        yield "it names neither a joint nor axis and point", "name a joint, or give axis and point", None
