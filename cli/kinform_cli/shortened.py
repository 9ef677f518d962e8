"""The beginning of what would go on for pages, and how to see all of it."""

from __future__ import annotations

from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.segment import Segment
from rich.text import Text

from kinform_cli.constants import MOST_OF_TOPIC


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
            if lines > MOST_OF_TOPIC + MOST_OF_TOPIC // 5:
                yield from held[:left]
                yield Text(f"… and more: {self._remedy}", style="yellow")
                return
        yield from held
