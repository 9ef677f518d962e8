"""Tables and lines that are readable at any width: columns where they fit, else blocks; what goes on is indented."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from typing import Literal

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from kinform.foundation.words import shortened_ends
from kinform_cli.constants import GAP, INDENT, LEAST_NAME, LEAST_TEXT, MOST_LINES
from kinform_cli.text import NONE


class Rows:
    """A table for people. No value is ever cut; names are shortened in their middle where the columns then fit.

    Columns named in `right` are numbers. Where the columns do not fit, texts (columns named in `texts`) are wrapped and
    names (columns named in `names`) are shortened, as long as they stay apart; else the values of the first `keys`
    columns stand on a line of their own, and below them the other columns, or each of their values with its heading.
    `shared` are the numbers of
    columns that many rows have in common: where the columns do not fit, they head the rows that share them.
    """

    def __init__(
        self,
        *headings: str,
        title: str | None = None,
        right: Iterable[str] = (),
        keys: int = 1,
        shared: Sequence[int] = (),
        names: Iterable[str] = (),
        texts: Iterable[str] = (),
    ):
        self._headings = headings
        self._shared = shared
        self._title = title
        self._right = frozenset(right)
        self._keys = keys
        self._names = frozenset(names)
        self._texts = frozenset(texts)
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
        every, width = range(len(self._headings)), options.max_width
        rest = [k for k in every if k not in self._shared]
        natural = {k: self._natural(k) for k in every}
        if _across(natural.values()) <= width:
            yield self._columns(self._rows, natural)
        elif self._shared and _across(natural[k] for k in rest) <= width - 2:
            for shared, rows in groupby(self._rows, lambda row: [row[k] for k in self._shared]):
                yield _Hanging(Text("  ".join(shared), style="bold"))
                yield Padding(self._columns(list(rows), {k: natural[k] for k in rest}), (0, 0, 0, 2))
        elif (widths := self._fitted(every, width)) is not None:
            yield self._columns(self._rows, widths)
        elif (widths := self._fitted(every[self._keys :], width - 2)) is not None:
            yield Padding(self._columns([], widths), (0, 0, 0, 2))
            for row in self._rows:
                yield _Hanging(Text("  ".join(row[: self._keys]), style="bold"))
                yield Padding(self._columns([row], widths, headed=False), (0, 0, 0, 2))
        else:
            for row in self._rows:
                yield from self._block(row, width)

    def _fitted(self, chosen: Sequence[int], width: int) -> dict[int, int] | None:
        """Widths of the chosen columns with texts wrapped and names shortened; None where that is not enough, or two
        names would look alike."""
        widths = {k: self._natural(k) for k in chosen}
        texts = {k: widths[k] for k in chosen if self._headings[k] in self._texts}
        names = {k: widths[k] for k in chosen if self._headings[k] in self._names}
        least = {k: min(most, max(LEAST_TEXT, self._longest_word(k))) for k, most in texts.items()}
        room = width - _across(widths.values()) + sum(texts.values()) + sum(names.values())
        widths |= _shares(room - sum(least.values()), names)
        widths |= _shares(room - sum(widths[k] for k in names), texts)
        if _across(widths.values()) > width or any(widths[k] < least[k] for k in texts):
            return None
        if any(widths[k] < min(most, LEAST_NAME) for k, most in names.items()):
            return None
        if any(most > MOST_LINES * widths[k] for k, most in texts.items()):
            return None
        for k in names:
            distinct = {row[k] for row in self._rows}
            if len({shortened_ends(name, widths[k]) for name in distinct}) < len(distinct):
                return None
        return widths

    def _longest_word(self, k: int) -> int:
        """Cells of the longest word of a column and its heading."""
        words = (word for value in (self._headings[k], *(row[k] for row in self._rows)) for word in value.split())
        return max(map(cell_len, words), default=0)

    def _natural(self, k: int) -> int:
        """Cells that the widest value of a column takes."""
        return max(map(cell_len, (self._headings[k], *(row[k] for row in self._rows))))

    def _columns(self, rows: Iterable[Sequence[str]], widths: Mapping[int, int], *, headed: bool = True) -> Table:
        """The columns that have a width, with names shortened to it."""
        grid = Table(box=None, header_style="bold cyan", pad_edge=False, show_header=headed)
        for k, width in widths.items():
            heading = self._headings[k]
            side: Literal["right", "left"] = "right" if heading in self._right else "left"
            grid.add_column(heading, justify=side, overflow="fold", min_width=width, max_width=width)
        for row in rows:
            names = {k: shortened_ends(row[k], widths[k]) for k in widths if self._headings[k] in self._names}
            grid.add_row(*(names.get(k, row[k]) for k in widths))
        return grid

    def _block(self, row: Sequence[str], width: int) -> Iterable[RenderableType]:
        """The keys, and below them what is known of the rest."""
        yield _Hanging(Text("  ".join(row[: self._keys]), style="bold"))
        line = ""
        for heading, value in zip(self._headings[self._keys :], row[self._keys :], strict=True):
            fact = f"{heading}: {value}"
            if value in ("", NONE):
                continue
            if line and INDENT + len(line) + GAP + len(fact) > width:
                yield _Hanging(Text(" " * INDENT + line))
                line = fact
            else:
                line += (" " * GAP if line else "") + fact
        if line:
            yield _Hanging(Text(" " * INDENT + line))


def _across(widths: Iterable[int]) -> int:
    """Cells across columns so wide, two blanks between."""
    each = list(widths)
    return sum(each) + 2 * max(len(each) - 1, 0)


def _shares(room: int, wanted: Mapping[int, int]) -> dict[int, int]:
    """What each gets of the room: all that it wants where that is no more than its share, else an equal share of what
    is left."""
    out: dict[int, int] = {}
    for k, want in sorted(wanted.items(), key=lambda item: item[1]):
        out[k] = min(want, max(room, 0) // (len(wanted) - len(out)))
        room -= out[k]
    return out


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
