"""Mass properties of bodies and parts."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import RenderableType
from rich.text import Text

from kinform.design import Design
from kinform.model.mass import MassProperties, MassReport
from kinform_cli.tables import Rows, stacked
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
        said = {(item.name, item.reason) for item in unknown}
        items += [f"  {part}: {message}" for part, message in report.problems if (part, message) not in said]
    return stacked(*items)


def _table(title: str, rows: Sequence[MassProperties], lengths: Lengths) -> RenderableType:
    if rows and all(row.mass is None for row in rows):
        return Text(f"{title}: none is known", style="bold")
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
            (row.origin if known else NONE)
            + (f" (±{100 * row.mass_bound:.2g} %)" if known and row.mass_bound > 0 else ""),
        )
    return grid
