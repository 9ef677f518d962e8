"""Tables and lines that are readable at any width: columns where they fit, else blocks; what goes on is indented."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.segment import Segment
from rich.style import Style
from rich.text import Text

from kinform.foundation.escapes import one_line
from kinform.foundation.words import shortened_ends
from kinform_cli.text import NONE

GAP = 3
"""Blanks between two facts on one line of a block; a choice."""
INDENT = 4
"""Blanks before the facts of a block; a choice."""
LEAST_NAME = 16
"""Characters to which a name is shortened at most: of the two bodies of a joint seven each. A choice."""
LEAST_TEXT = 24
"""Columns below which a text is not wrapped in a table: about four words a line. A choice."""
MOST_LINES = 4
"""Lines that a text takes in a table at most; a row of which one takes more becomes a block. A choice."""
INSET = 2
"""Blanks before the columns that stand below what heads them; a choice."""


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
        self._headings = tuple(map(one_line, headings))
        self._shared = shared
        self._title = None if title is None else told(title)
        self._right = frozenset(right)
        self._keys = keys
        self._names = frozenset(names)
        self._texts = frozenset(texts)
        self._rows: list[Sequence[str]] = []

    def add(self, *values: str) -> None:
        """One more row, a value for each heading."""
        if len(values) != len(self._headings):
            raise ValueError(f"expected {len(self._headings)} values, got {len(values)}")
        self._rows.append([one_line(value) for value in values])

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """The title, then columns or blocks."""
        if self._title:
            yield Text(self._title, style="bold")
        every, width = range(len(self._headings)), options.max_width
        rest = [k for k in every if k not in self._shared]
        natural = {k: self._natural(k) for k in every}
        if _across(natural.values()) <= width:
            yield from self._columns(console, self._rows, natural)
        elif self._shared and _across(natural[k] for k in rest) <= width - INSET:
            for shared, rows in groupby(self._rows, lambda row: [row[k] for k in self._shared]):
                yield _Hanging(Text("  ".join(shared), style="bold"))
                yield from self._columns(console, rows, {k: natural[k] for k in rest}, INSET)
        elif (widths := self._fitted(every, width)) is not None:
            yield from self._columns(console, self._rows, widths)
        elif (widths := self._fitted(every[self._keys :], width - INSET)) is not None:
            yield from self._columns(console, [], widths, INSET)
            for row in self._rows:
                yield _Hanging(Text("  ".join(row[: self._keys]), style="bold"))
                yield from self._columns(console, [row], widths, INSET, headed=False)
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

    def _columns(
        self,
        console: Console,
        rows: Iterable[Sequence[str]],
        widths: Mapping[int, int],
        indent: int = 0,
        *,
        headed: bool = True,
    ) -> Iterator[Segment]:
        """Lines of the columns that have a width, with names shortened to it.

        Made here, for all values have their width already: rich's table measures and wraps each again, which took
        seconds for thousands of rows.
        """
        names = [k for k in widths if self._headings[k] in self._names]
        heading = console.get_style("bold cyan")
        if headed:
            yield from _row_lines(console, self._cells(self._headings, widths), indent, heading)
        for row in rows:
            short = {k: shortened_ends(row[k], widths[k]) for k in names}
            yield from _row_lines(console, self._cells([short.get(k, v) for k, v in enumerate(row)], widths), indent)

    def _cells(self, values: Sequence[str], widths: Mapping[int, int]) -> list[tuple[str, int, bool]]:
        """Value, width, and whether it stands to the right, of each column that has a width."""
        return [(values[k], width, self._headings[k] in self._right) for k, width in widths.items()]

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


def _row_lines(
    console: Console, cells: Sequence[tuple[str, int, bool]], indent: int, style: Style | None = None
) -> Iterator[Segment]:
    """The lines of one row: what is wider than its column goes on below."""
    columns = [_pieces(console, value, width) for value, width, _ in cells]
    for k in range(max(map(len, columns), default=0)):
        if indent:
            yield Segment(" " * indent)
        for n, (pieces, (_, width, right)) in enumerate(zip(columns, cells, strict=True)):
            piece = pieces[k] if k < len(pieces) else ""
            blank = " " * (width - cell_len(piece))
            yield Segment(("  " if n else "") + (blank + piece if right else piece + blank), style)
        yield Segment.line()


def _pieces(console: Console, value: str, width: int) -> list[str]:
    """The value in lines no wider than this."""
    if "\n" not in value and cell_len(value) <= width:
        return [value]
    return [line.plain.rstrip() for line in Text(value).wrap(console, width, overflow="fold")]


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
        lines = self._text.plain.split("\n")
        if max(map(cell_len, lines), default=0) <= options.max_width:
            if "\t" in self._text.plain:
                yield self._text
            else:
                # nothing to wrap: as it is, for thousands of rows
                yield from self._text.render(console, end="\n")
            return
        for line in self._text.split("\n", allow_blank=True):
            margin = len(line.plain) - len(line.plain.lstrip(" "))
            room = max(options.max_width - margin - 2, 10)
            for k, piece in enumerate(line[margin:].wrap(console, room, overflow="fold")):
                piece.rstrip()
                yield Text.assemble(" " * (margin + (2 if k else 0)), piece)


def stacked(*items: RenderableType) -> Group:
    """Items below each other; lines of text that do not fit go on indented. A string, and a text of one style, is one
    line, after empty ones where it begins with ends of lines."""
    return Group(*map(_stacked, items))


def _stacked(item: RenderableType) -> RenderableType:
    if isinstance(item, str):
        return _Hanging(Text(told(item)))
    if isinstance(item, Text):
        return _Hanging(item if item.spans else Text(told(item.plain), style=item.style))
    return item


def told(text: str) -> str:
    """A heading or a sentence with the names of strangers in it: on one line, after its own empty ones."""
    line = text.lstrip("\n")
    return "\n" * (len(text) - len(line)) + one_line(line)
