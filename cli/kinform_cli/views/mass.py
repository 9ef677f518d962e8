"""Mass properties of bodies and parts."""

from __future__ import annotations

from collections.abc import Iterable

from rich.console import Group, RenderableType
from rich.text import Text

from kinform.model.design import Design
from kinform.model.mass import MassProperties, MassReport
from kinform_cli.tables import Rows
from kinform_cli.text import NONE, Lengths, number

__all__ = ["bodies", "render"]


def _known(design: Design) -> MassReport:
    assert design.mass is not None
    return design.mass


def bodies(design: Design) -> RenderableType:
    """One row a body."""
    return _table("Mass of bodies", _known(design).bodies, Lengths.of(design.assembly))


def render(design: Design) -> RenderableType:
    """Bodies, then parts, then what is wrong."""
    report = _known(design)
    items: list[RenderableType] = [
        bodies(design),
        _table("\nMass of parts", report.parts, Lengths.of(design.assembly)),
    ]
    unknown = [item for item in report.parts if item.mass is None and item.reason]
    if unknown or report.problems:
        items.append(Text("\nNot known, or not possible", style="bold"))
        items += [f"  {item.name}: {item.reason}" for item in unknown]
        said = {(item.name, item.reason) for item in unknown}
        items += [f"  {part}: {message}" for part, message in report.problems if (part, message) not in said]
    return Group(*items)


def _table(title: str, rows: Iterable[MassProperties], lengths: Lengths) -> Rows:
    grid = Rows(
        "name", "mass kg", f"centre of mass {lengths.unit}", "principal moments kg·m²", "from", title=title,
        right=["mass kg"],
    )  # fmt: skip
    for row in rows:
        known = row.mass is not None
        grid.add(
            row.name,
            number(row.mass),
            lengths.point(row.centre_of_mass),
            ", ".join(f"{moment:.3g}" for moment in row.principal_moments) if known else NONE,
            row.origin + (f" (±{100 * row.mass_bound:.2g} %)" if known and row.mass_bound > 0 else ""),
        )
    return grid
