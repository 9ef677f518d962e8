"""A comparison as text for people, as JSON (SI and radians), and as Markdown."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable

from kinform.changes.change import Change
from kinform.changes.comparison import Comparison
from kinform.foundation.words import counted, one_line
from kinform.reports.markdown import cell_code, code, escaped, table

SCHEMA = "kinform/diff/1"


def render(comparison: Comparison, format: str) -> str:
    """The comparison in that format, ending in a newline; ValueError for an unknown format."""
    if format not in FORMATS:
        raise ValueError(f"unknown format {format!r}: expected one of {', '.join(FORMATS)}")
    return FORMATS[format](comparison)


def _full(comparison: Comparison) -> str:
    lines = []
    for change in comparison.changes:
        lines.append(f"{_subject(change)}: {one_line(change.message)}")
        if change.before is not None and change.after is not None:
            lines.append(f"  {one_line(change.before)} → {one_line(change.after)}")
    lines += [f"not compared: {what}: {why}" for what, why in comparison.missing]
    return "\n".join([*lines, _verdict(comparison)]) + "\n"


def _json(comparison: Comparison) -> str:
    found = {
        "schema": SCHEMA,
        "before": comparison.before,
        "after": comparison.after,
        "verdict": _verdict(comparison),
        "changes": [dataclasses.asdict(change) for change in comparison.changes],
        "compared": comparison.compared,
        "not_compared": [{"what": what, "why": why} for what, why in comparison.missing],
        "tolerance": dataclasses.asdict(comparison.tolerance),
    }
    return json.dumps(found, indent=1, allow_nan=False) + "\n"


def _markdown(comparison: Comparison) -> str:
    blocks = [f"### kinform: behaviour of {code(comparison.after)}", escaped(_verdict(comparison))]
    if comparison.changes:
        rows = [
            (
                ", ".join(map(cell_code, change.subject)),
                escaped(change.message),
                escaped(change.before or ""),
                escaped(change.after or ""),
            )
            for change in comparison.changes
        ]
        blocks.append(table(("what", "change", "before", "after"), rows))
    if comparison.missing:
        blocks.append("\n".join(f"- not compared: {what}: {why}" for what, why in comparison.missing))
    return "\n\n".join(blocks) + "\n"


def _subject(change: Change) -> str:
    return ", ".join(map(one_line, change.subject))


def _verdict(comparison: Comparison) -> str:
    beyond = f"beyond {comparison.tolerance.in_words()}"
    if comparison.changes:
        return f"{counted(len(comparison.changes), 'change')} of behaviour {beyond}"
    if comparison.code:
        return "not verified: " + ("not everything" if comparison.compared else "nothing") + " could be compared"
    return f"the same behaviour: nothing changed {beyond}"


FORMATS: dict[str, Callable[[Comparison], str]] = {"full": _full, "json": _json, "md": _markdown}
