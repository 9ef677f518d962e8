"""Tables and lines that are readable at any width: columns where they fit, else blocks; what goes on is indented."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import Literal

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from kinform_cli.constants import GAP, INDENT


class Rows:
    """A table for people. Nothing is ever cut, and no name broken while there is room for it.

    Where the columns do not fit, each row becomes a block: the values of its first `keys` columns, and
    below them the other values, each with its heading. Columns named in `right` are numbers. `shared` are the numbers
    of columns that many rows have in common: where the columns do not fit, they head the rows that share them.
    """

    def __init__(
        self,
        *headings: str,
        title: str | None = None,
        right: Iterable[str] = (),
        keys: int = 1,
        shared: Sequence[int] = (),
    ):
        self._headings = headings
        self._shared = shared
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
        wide = options.update(max_width=10**6)
        every = range(len(self._headings))
        grid = self._columns(every, self._rows)
        rest = [k for k in every if k not in self._shared]
        if Measurement.get(console, wide, grid).maximum <= options.max_width:
            yield grid
        elif (
            self._shared
            and Measurement.get(console, wide, self._columns(rest, self._rows)).maximum + 2 <= options.max_width
        ):
            for shared, rows in groupby(self._rows, lambda row: [row[k] for k in self._shared]):
                yield _Hanging(Text("  ".join(shared), style="bold"))
                yield Padding(self._columns(rest, list(rows)), (0, 0, 0, 2))
        else:
            for row in self._rows:
                yield from self._block(row, options.max_width)

    def _columns(self, chosen: Iterable[int], rows: Iterable[Sequence[str]]) -> Table:
        """Columns as wide as all rows of the table need, also where some are shown by themselves."""
        grid = Table(box=None, header_style="bold cyan", pad_edge=False)
        for k in chosen:
            heading = self._headings[k]
            width = max(cell_len(heading), *(cell_len(row[k]) for row in self._rows)) if self._rows else None
            side: Literal["right", "left"] = "right" if heading in self._right else "left"
            grid.add_column(heading, justify=side, overflow="fold", min_width=width)
        for row in rows:
            grid.add_row(*(row[k] for k in chosen))
        return grid

    def _block(self, row: Sequence[str], width: int) -> Iterable[RenderableType]:
        yield _Hanging(Text("  ".join(row[: self._keys]), style="bold"))
        line = ""
        for heading, value in zip(self._headings[self._keys :], row[self._keys :], strict=True):
            fact = f"{heading}: {value}"
            if line and INDENT + len(line) + GAP + len(fact) > width:
                yield _Hanging(Text(" " * INDENT + line))
                line = fact
            else:
                line += (" " * GAP if line else "") + fact
        yield _Hanging(Text(" " * INDENT + line))


class _Hanging:
    """A line that goes on indented where it does not fit."""

    def __init__(self, text: Text):
        self._text = text

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """The line, or its pieces."""
        if max(map(cell_len, self._text.plain.split("\n")), default=0) <= options.max_width:
            yield self._text
            return
        for line in self._text.split("\n", allow_blank=True):
            margin = len(line.plain) - len(line.plain.lstrip(" "))
            room = max(options.max_width - margin - 2, 10)
            for k, piece in enumerate(line[margin:].wrap(console, room, overflow="fold")):
                piece.rstrip()
                yield Text.assemble(" " * (margin + (2 if k else 0)), piece)


def stacked(*items: RenderableType) -> Group:
    """Items below each other; lines of text that do not fit go on indented."""
    return Group(
        *(
            _Hanging(Text(item) if isinstance(item, str) else item) if isinstance(item, str | Text) else item
            for item in items
        )
    )
