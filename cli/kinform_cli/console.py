"""Where the command writes: results to stdout; progress, summaries, warnings and errors to stderr.

Knows about terminals, colour and closed pipes. On a terminal lines wrap to its width, off a terminal to that which
`COLUMNS` asks for, or 80. Names that a user chose are never read as markup.
"""

from __future__ import annotations

import io
import os
import shutil
import sys
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING

from kinform.foundation import escapes

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
    from rich.text import Text

WIDTH = 80
"""Columns where there is no terminal: what a pager or a log shows without cutting. `COLUMNS` asks for others."""
LEAST_WIDTH = 40
"""Columns below which sentences are not broken further; a choice."""


@dataclass
class Settings:
    """What holds for the whole run of the command: set once, from its options."""

    quiet: bool = False
    debug: bool = False
    cut: OSError | None = None
    """What kept some of stdout from its reader."""


settings = Settings()


def _console(stream: IO[str]) -> Console:
    from rich.console import Console

    class Patient(Console):
        """A console whose reader may leave."""

        def on_broken_pipe(self) -> None:
            _lose(stream, BrokenPipeError())

    return Patient(
        file=stream,
        width=None if stream.isatty() else _asked_width() or WIDTH,
        color_system=None if os.environ.get("NO_COLOR") else "auto",
        markup=False,
        highlight=False,
        emoji=False,
    )


def _asked_width() -> int | None:
    """The columns that `COLUMNS` asks for, as in `COLUMNS=80 kinform show F.h5 | less`."""
    asked = os.environ.get("COLUMNS", "")
    return max(int(asked), LEAST_WIDTH) if asked.isascii() and asked.isdigit() and len(asked) < 6 else None


def decorated() -> bool:
    """Whether stdout is a terminal, or is to be taken for one; else text needs no rich, whose import costs time."""
    return sys.stdout.isatty() or any(name in os.environ for name in ("FORCE_COLOR", "TTY_COMPATIBLE"))


def columns() -> int:
    """Of the terminal; where there is none those that `COLUMNS` asks for, or 80: what is told in lines is no wider."""
    if not sys.stdout.isatty():
        return _asked_width() or WIDTH
    return max(shutil.get_terminal_size((WIDTH, 24)).columns, LEAST_WIDTH)


def stderr() -> Console:
    """The console for people who watch: progress, summaries, warnings, errors."""
    return _console(sys.stderr)


def tell(text: str | Text) -> None:
    """A line on stderr. That nobody can read it changes no verdict."""
    try:
        # where nothing is styled without rich, whose import takes longer than all else
        told = escapes.lines(text) + "\n" if isinstance(text, str) else _drawn(stderr(), text, soft_wrap=True)
        sys.stderr.write(told)
        sys.stderr.flush()
    except OSError:
        _forget(sys.stderr)


def _drawn(console: Console, item: RenderableType, *, soft_wrap: bool = False) -> str:
    """What the console would print, without control characters but those of colours, and without commands for CI."""
    with console.capture() as drawn:
        console.print(_Escaped(item), soft_wrap=soft_wrap, crop=False)
    return escapes.of_terminal(drawn.get())


@dataclass
class _Escaped:
    """An item of whose text control characters are escaped once it is in lines."""

    item: RenderableType

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        from rich.segment import Segment

        for text, style, control in console.render(self.item, options):
            yield Segment(text if control else escapes.harmless(text), style, control)


def _forget(stream: IO[str]) -> None:
    """What is written to the stream from now on goes nowhere, and so does what waits in it."""
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), stream.fileno())


def _lose(stream: IO[str], error: OSError) -> None:
    """Go on without the stream; that not all of stdout was written is remembered for the exit code."""
    if stream is sys.stdout and settings.cut is None:
        settings.cut = error
    _forget(stream)


def emit(text: str) -> None:
    """Write a document to stdout, which `foundation.escapes` made safe, and end the line. What cannot be written is
    remembered, and no exception: the work goes on, and the verdict counts."""
    try:
        sys.stdout.write(text if text.endswith("\n") else text + "\n")
        sys.stdout.flush()
    except OSError as error:
        _lose(sys.stdout, error)


def out(item: RenderableType) -> None:
    """Write a table, a tree or sentences for people to stdout; off a terminal no blanks end a line."""
    console = _console(sys.stdout)
    text = _drawn(console, item)
    emit(text if console.is_terminal else "\n".join(line.rstrip() for line in text.splitlines()))


def flush() -> None:
    """Hand everything to the reader now; what cannot be is remembered as by `emit`."""
    try:
        sys.stdout.flush()
    except OSError as error:
        _lose(sys.stdout, error)


def give_up() -> None:
    """Flush if that is possible, so that the end of the process has nothing left to fail on."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            _forget(stream)


def say(text: str | None) -> None:
    """One line on stderr about what was done; silent with --quiet, or where there is nothing to say."""
    if text is not None and not settings.quiet:
        from kinform_cli.text import hanging

        text = escapes.one_line(text)
        width = max(shutil.get_terminal_size((WIDTH, 24)).columns, LEAST_WIDTH)
        tell(hanging(text, width) if sys.stderr.isatty() else text)


def warn(text: str) -> None:
    """A warning on stderr; silent with --quiet."""
    if not settings.quiet:
        from rich.text import Text

        tell(Text.assemble(("warning: ", "bold yellow"), escapes.one_line(text)))


def write_whole() -> None:
    """Give stdout a buffer where it has none (`PYTHONUNBUFFERED`): without one, what a full disk takes only half of
    counts as written."""
    raw = getattr(sys.stdout, "buffer", None)
    if isinstance(raw, io.RawIOBase):
        given = sys.stdout
        whole = io.BufferedWriter(raw)
        sys.stdout = io.TextIOWrapper(whole, given.encoding, given.errors, newline="\n", write_through=True)
        _KEPT.append(given)


_KEPT: list[object] = []
"""Streams that would close their file when they are forgotten."""


def tolerate_any_character() -> None:
    """Make stdout and stderr write what their encoding lacks as escapes instead of failing."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # closed by the caller (`>&-`)
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115
        elif hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
