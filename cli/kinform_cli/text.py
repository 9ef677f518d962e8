"""How numbers, names and tables are written for people, and values for machines."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rich.table import Table

if TYPE_CHECKING:
    from kinform.model.assembly import Assembly

__all__ = ["NONE", "Lengths", "count", "degrees", "dumps", "number", "table", "vector"]

NONE = "–"
"""What stands in a table where there is no value."""

_NOTHING = 1e-9
"""Lengths (m) below this are written as 0."""


def number(value: float | None) -> str:
    """Six significant digits, no trailing zeros; a dash for what is unknown."""
    if value is None or math.isnan(value):
        return NONE
    if math.isinf(value):
        return "∞" if value > 0 else "-∞"
    text = f"{value:.6g}"
    return "0" if text == "-0" else text


def degrees(radians: float) -> str:
    """An angle in degrees, with its sign."""
    return f"{number(math.degrees(radians))}°"


def vector(direction: Iterable[float] | None) -> str:
    """A direction: x, y or z where it is one to four decimals, else its components."""
    if direction is None:
        return NONE
    rounded = [round(float(component), 4) + 0.0 for component in direction]
    for name, unit in (("x", [1, 0, 0]), ("y", [0, 1, 0]), ("z", [0, 0, 1])):
        if rounded == unit:
            return name
    return ", ".join(f"{component:g}" for component in rounded)


def count(many: int, noun: str, plural: str | None = None) -> str:
    """As in "1 part", "2 parts", "2 bodies"."""
    return f"{many} {noun if many == 1 else plural or noun + 's'}"


@dataclass(frozen=True)
class Lengths:
    """Lengths in the unit of the assembly."""

    unit: str
    metres: float

    @staticmethod
    def of(assembly: Assembly) -> Lengths:
        """In the unit of that assembly's manifest."""
        from kinform.form.units import metres_per

        return Lengths(assembly.units, metres_per(assembly.units))

    def length(self, metres: float | None) -> str:
        """A length, without its unit."""
        if metres is None:
            return NONE
        return number(0.0 if abs(metres) < _NOTHING else metres / self.metres)

    def point(self, point: Iterable[float] | None) -> str:
        """A place, without its unit."""
        if point is None or any(math.isnan(x) for x in point):
            return NONE
        return ", ".join(self.length(float(x)) for x in point)

    def area(self, square_metres: float) -> str:
        """An area, without its unit."""
        return f"{square_metres / self.metres**2:.4g}"


def table(*columns: str, title: str | None = None, right: Iterable[str] = ()) -> Table:
    """An empty table with these headings; cells wrap, and are never cut. `right`: numbers."""
    grid = Table(box=None, title=title, title_justify="left", title_style="bold", header_style="bold cyan")
    grid.pad_edge = False
    for heading in columns:
        grid.add_column(heading, justify="right" if heading in right else "left", overflow="fold")
    return grid


def dumps(value: Any) -> str:
    """JSON text of a value; null for what is not a finite number."""
    from kinform.reports.json_views import plain

    return json.dumps(plain(value), indent=1, allow_nan=False)
