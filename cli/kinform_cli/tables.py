"""Tables that are readable at any width: rows of columns where they fit, else one block a row."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich.console import Console, ConsoleOptions, RenderResult
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text

__all__ = ["Rows"]

_GAP = 3
"""Blanks between two facts on one line of a block."""
_INDENT = 4


class Rows:
    """A table for people. Nothing is ever cut, and no name broken while there is room for it.

    Where the columns do not fit, each row becomes a block: the values of its first `keys` columns, and
    below them the other values, each with its heading. Columns named in `right` are numbers.
    """

    def __init__(self, *headings: str, title: str | None = None, right: Iterable[str] = (), keys: int = 1):
        self._headings = headings
        self._title = title
        self._right = frozenset(right)
        self._keys = keys
        self._rows: list[Sequence[str]] = []

    def add(self, *values: str) -> None:
        """One more row, a value for each heading."""
        if len(values) != len(self._headings):
            raise ValueError(f"expected {len(self._headings)} values, got {len(values)}")
        self._rows.append(values)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """The title, then columns or blocks."""
        if self._title:
            yield Text(self._title, style="bold")
        grid = self._columns()
        if Measurement.get(console, options.update(max_width=10**6), grid).maximum <= options.max_width:
            yield grid
        else:
            for row in self._rows:
                yield from self._block(row, options.max_width)

    def _columns(self) -> Table:
        grid = Table(box=None, header_style="bold cyan", pad_edge=False)
        for heading in self._headings:
            grid.add_column(heading, justify="right" if heading in self._right else "left", overflow="fold")
        for row in self._rows:
            grid.add_row(*row)
        return grid

    def _block(self, row: Sequence[str], width: int) -> Iterable[Text]:
        yield Text("  ".join(row[: self._keys]), style="bold", overflow="fold")
        line = ""
        for heading, value in zip(self._headings[self._keys :], row[self._keys :], strict=True):
            fact = f"{heading}: {value}"
            if line and _INDENT + len(line) + _GAP + len(fact) > width:
                yield Text(" " * _INDENT + line, overflow="fold")
                line = fact
            else:
                line += (" " * _GAP if line else "") + fact
        yield Text(" " * _INDENT + line, overflow="fold")
