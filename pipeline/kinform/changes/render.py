"""A comparison as text for people, as JSON (SI and radians), and as Markdown."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Collection

from kinform.changes.causes import Consequences
from kinform.changes.change import Change
from kinform.changes.comparison import Comparison
from kinform.foundation.escapes import json_text, lines, one_line
from kinform.foundation.words import counted, listed
from kinform.reports.markdown import cell_code, code, escaped, table

SCHEMA = "kinform/diff/1"


def render(comparison: Comparison, format: str) -> str:
    """The comparison in that format, ending in a newline; ValueError for an unknown format."""
    if format not in FORMATS:
        raise ValueError(f"unknown format {format!r}: expected one of {', '.join(FORMATS)}")
    return FORMATS[format](comparison)


def _full(comparison: Comparison) -> str:
    told = []
    if comparison.groups:
        for group in comparison.groups:
            told += cause_lines(group, comparison)
            own = {cause.part for cause in group.causes}
            told += ["  " + line for change in group.changes for line in change_lines(change, own)]
    else:
        told += [line for change in comparison.changes for line in change_lines(change)]
    told += [f"not compared: {one_line(what)}: {one_line(why)}" for what, why in comparison.missing]
    told += new_lines(comparison)
    return lines("\n".join([*told, verdict_words(comparison)]) + "\n")


def new_lines(comparison: Comparison) -> list[str]:
    """That something is known now that was not computed before."""
    return [f"{what} are new: not computed before, nothing to compare with" for what in comparison.new]


def cause_lines(group: Consequences, comparison: Comparison) -> list[str]:
    """What was done, where this group is the only one of it; else by whose names it follows."""
    names = list(dict.fromkeys(one_line(cause.part) for cause in group.causes))
    if not names:
        return ["of parts that were not changed:"] if group.changes else []
    every = len(names) == len({cause.part for cause in comparison.causes})
    if len(names) > 1:
        return [f"of {'all of them' if every else listed(names)} together:"] if group.changes else []
    return [f"{names[0]} {listed([one_line(cause.message) for cause in group.causes])}"]


def change_lines(change: Change, known: Collection[str] = ()) -> list[str]:
    """The change with what was and what is, each said once, as is its subject where that is the only one `known`."""
    text = one_line(change.message)
    line = text if list(known) == list(change.subject) else f"{_subject(change)}: {text}"
    old, new = change.before, change.after
    if old is None or new is None or (one_line(old) in text and one_line(new) in text):
        return [line]
    return [line, f"  {one_line(old)} → {one_line(new)}"]


def _json(comparison: Comparison) -> str:
    found = {
        "schema": SCHEMA,
        "before": comparison.before,
        "after": comparison.after,
        "verdict": verdict_words(comparison),
        "causes": [{"kind": cause.kind, "part": cause.part, "message": cause.message} for cause in comparison.causes],
        "groups": [
            {
                "parts": list(dict.fromkeys(cause.part for cause in group.causes)),
                "changes": [comparison.changes.index(change) for change in group.changes],
            }
            for group in comparison.groups
        ],
        "changes": [dataclasses.asdict(change) for change in comparison.changes],
        "compared": comparison.compared,
        "not_compared": [{"what": what, "why": why} for what, why in comparison.missing],
        "new": comparison.new,
        "tolerance": dataclasses.asdict(comparison.tolerance),
    }
    return json_text(json.dumps(found, indent=1, allow_nan=False)) + "\n"


def _markdown(comparison: Comparison) -> str:
    blocks = [f"### kinform: behaviour of {code(comparison.after)}", escaped(verdict_words(comparison))]
    if comparison.causes:
        blocks.append("\n".join(f"- {code(cause.part)} {escaped(cause.message)}" for cause in comparison.causes))
    if comparison.changes:
        rows = [
            (
                ", ".join(map(cell_code, change.subject)),
                escaped(change.message),
                escaped(change.before or ""),
                escaped(change.after or ""),
            )
            for change in ([change for group in comparison.groups for change in group.changes] or comparison.changes)
        ]
        blocks.append(table(("what", "change", "before", "after"), rows))
    if comparison.missing:
        blocks.append("\n".join(f"- not compared: {escaped(what)}: {escaped(why)}" for what, why in comparison.missing))
    if comparison.new:
        blocks.append("\n".join(f"- {escaped(line)}" for line in new_lines(comparison)))
    return lines("\n\n".join(blocks) + "\n")


def _subject(change: Change) -> str:
    return ", ".join(map(one_line, change.subject))


def verdict_words(comparison: Comparison) -> str:
    """How many changes there are, or that there is none, or that this is not known."""
    beyond = f"beyond {comparison.tolerance.in_words()}"
    if comparison.changes:
        return f"{counted(len(comparison.changes), 'change')} of behaviour {beyond}"
    if comparison.code:
        return "not verified: " + ("not everything" if comparison.compared else "nothing") + " could be compared"
    return f"the same behaviour: nothing changed {beyond}"


FORMATS: dict[str, Callable[[Comparison], str]] = {"full": _full, "json": _json, "md": _markdown}
