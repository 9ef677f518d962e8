"""The designs of a batch, as a table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from kinform.foundation import escapes
from kinform.foundation.escapes import one_line
from kinform_cli.tables import Rows

if TYPE_CHECKING:
    from kinform.batch import Row

_HEADINGS = ("design", "verdict", "errors", "warnings", "notes", "undecided", "ignored", "seconds")


def table(rows: Sequence[Row], fail_on: str) -> Rows:
    """A row a design; `fail_on` is the least severity that makes one inconsistent."""
    from kinform.batch.renderings import table_row

    shown = Rows(*_HEADINGS, right=_HEADINGS[2:], names=["design"])
    for row in rows:
        shown.add(*table_row(row, fail_on))
    return shown


def as_text(rows: Sequence[Row], fail_on: str) -> str:
    """The table as text with columns, whatever their width."""
    from kinform.batch.renderings import table_row

    lines = [_HEADINGS, *([*map(one_line, table_row(row, fail_on))] for row in rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(_HEADINGS))]
    return escapes.lines(
        "".join("  ".join(v.ljust(w) for v, w in zip(line, widths, strict=True)).rstrip() + "\n" for line in lines)
    )
