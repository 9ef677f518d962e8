"""The overview of a large design: the beginning of each topic, and the command that shows all of it."""

from __future__ import annotations

import io

from rich.console import Console
from rich.text import Text

from kinform_cli.constants import MOST_OF_TOPIC
from kinform_cli.shortened import Shortened
from kinform_cli.tables import Rows, stacked


def drawn(item: object) -> list[str]:
    file = io.StringIO()
    Console(file=file, width=80).print(item)
    return [line.rstrip() for line in file.getvalue().splitlines()]


def table(rows: int) -> Rows:
    made = Rows("name", "count")
    for k in range(rows):
        made.add(f"pin{k}", str(k))
    return made


def test_what_is_hardly_longer_than_the_limit_is_shown_whole():
    whole = drawn(table(MOST_OF_TOPIC + 2))
    assert drawn(Shortened(table(MOST_OF_TOPIC + 2), "never")) == whole


def test_of_a_long_table_the_first_lines_and_the_remedy_are_shown():
    got = drawn(stacked("before", Shortened(table(5000), "`kinform show a.h5 joints`"), "after"))
    whole = drawn(table(5000))
    assert got[0] == "before"
    assert got[1 : MOST_OF_TOPIC + 1] == whole[:MOST_OF_TOPIC]
    assert got[MOST_OF_TOPIC + 1 :] == ["… and more: `kinform show a.h5 joints`", "after"]


def test_lines_beyond_are_not_even_drawn():
    asked = []

    class Endless:
        def __rich_console__(self, console, options):
            for k in range(10**9):
                asked.append(k)
                yield Text(str(k))

    assert len(drawn(Shortened(Endless(), "more"))) == MOST_OF_TOPIC + 1
    assert len(asked) < 2 * MOST_OF_TOPIC
