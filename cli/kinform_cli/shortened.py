"""The beginning of what would go on for pages, and how to see all of it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import TypeVar

from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.segment import Segment
from rich.text import Text

MOST_OF_TOPIC = 60
"""Lines of a topic in the overview of a large design; a choice: a screen or two, after which one looks at the
topic alone. A fifth more is shown whole."""


_T = TypeVar("_T")


def beginning(items: Sequence[_T], short: bool) -> Sequence[_T]:
    """Of items that take a line at least each: all, or with `short` as many as `Shortened` can show and one more, so
    that it says that there are others."""
    return tuple(islice(items, 6 * MOST_OF_TOPIC // 5 + 1)) if short else items


class Shortened:
    """The first lines of an item that has many more; it is drawn only so far."""

    def __init__(self, item: RenderableType, remedy: str):
        self._item, self._remedy = item, remedy

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """All lines of an item that is short; else the first ones, and the command that shows all."""
        lines, left = 0, 0
        held: list[Segment] = []
        for segment in console.render(self._item, options):
            held.append(segment)
            lines += segment.text.count("\n")
            if lines == MOST_OF_TOPIC and not left:
                left = len(held)
            if lines > 6 * MOST_OF_TOPIC // 5:
                yield from held[:left]
                yield Text(f"… and more: {self._remedy}", style="yellow")
                return
        yield from held
