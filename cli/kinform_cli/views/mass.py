"""Mass properties of bodies and parts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from rich.console import RenderableType
from rich.text import Text

from kinform.design import Design
from kinform.foundation import words
from kinform.model.mass import MassProperties
from kinform_cli.shortened import beginning
from kinform_cli.tables import Rows, stacked
from kinform_cli.text import NONE, Lengths, number

HEAVY = 1.0
"""kg: where something in a table weighs as much, masses are in kg, else in g."""


def bodies(design: Design, *, short: bool = False) -> RenderableType:
    """One row a body; with `short` no more than can be shown of it."""
    assert design.mass is not None
    table = _table("Mass of bodies", design.mass.bodies, Lengths.of(design.assembly), short)
    return stacked(table, *_unclear(design))


def render(design: Design) -> RenderableType:
    """Bodies, then parts, then what is wrong."""
    report = design.mass
    assert report is not None
    items: list[RenderableType] = [
        bodies(design),
        "",
        _table("Mass of parts", report.parts, Lengths.of(design.assembly)),
    ]
    unknown = [item for item in report.parts if item.mass is None and item.reason]
    if unknown or report.problems:
        items.append(Text("\nNot known, or not possible", style="bold"))
        reasons: dict[str, list[str]] = {}
        for item in unknown:
            reasons.setdefault(item.reason, []).append(item.name)
        items += [f"  {', '.join(names)}: {reason}" for reason, names in reasons.items()]
        listed = {(item.name, item.reason) for item in unknown}
        items += [f"  {part}: {message}" for part, message in report.problems if (part, message) not in listed]
    return stacked(*items)


def _unclear(design: Design) -> list[RenderableType]:
    """How much of the mass could be in another body, where bodies follow from the function."""
    members = () if design.kinematics is None else design.kinematics.membership
    unclear = {one.part for one in members if one.either}
    assert design.mass is not None
    masses = [row.mass for row in design.mass.parts if row.name in unclear]
    if not unclear:
        return []
    total = sum(mass for mass in masses if mass is not None)
    weight = f"{number(total)} kg" if total >= HEAVY else f"{number(1e3 * total)} g"
    known = f", {weight} in all" if masses and None not in masses else ""
    return [Text(f"{words.counted(len(unclear), 'part')}{known}, could be in another body: kinform show F.h5 bodies")]


def _table(title: str, rows: Sequence[MassProperties], lengths: Lengths, short: bool = False) -> RenderableType:
    if rows and all(row.mass is None for row in rows):
        return Text(f"{title}: none is known", style="bold")
    mass_unit, grams = ("kg", 1.0) if _most(row.mass for row in rows) >= HEAVY else ("g", 1e3)
    moment_unit, moments = words.moment_unit(_most(moment for row in rows for moment in row.principal_moments))
    mass = f"mass {mass_unit}"
    headings = ("name", mass, f"centre of mass {lengths.unit}", f"principal moments {moment_unit}", "from")
    grid = Rows(*headings, title=title, right=[mass], names=["name"])
    for row in beginning(rows, short):
        weighed = row.mass is not None
        grid.add(
            row.name,
            NONE if row.mass is None else number(grams * row.mass),
            lengths.point(row.centre_of_mass),
            ", ".join(words.number(moments * moment, 3) for moment in row.principal_moments) if weighed else NONE,
            (row.origin if weighed else NONE)
            + (f" ±{100 * row.mass_bound:.2g} %" if weighed and row.mass_bound > 0 else ""),
        )
    return grid


def _most(values: Iterable[float | None]) -> float:
    """The greatest of those that are known."""
    return max((value for value in values if value is not None and math.isfinite(value)), default=0.0)
