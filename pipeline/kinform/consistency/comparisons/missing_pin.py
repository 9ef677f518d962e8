"""Rows of empty bores as the cause of a joint that is missing or not held, in words."""

from __future__ import annotations

from kinform.consistency.comparisons.comparison import WITH_LINE, Comparison
from kinform.consistency.context import Context
from kinform.consistency.questions.empty_bores import Row
from kinform.foundation.words import axis, counted, length, place


def bores_in_words(row: Row, units: str, times: int = 1) -> str:
    """ "3 aligned bores of 5 mm", or several such rows."""
    bores = f"{counted(len(row.parts), 'aligned bore')} of {length(2.0 * row.radius, units)}"
    return bores if times == 1 else f"{times} times {bores}"


def lack(row: Row) -> str:
    """What it lacks: a pin where bodies take turns along it, else a pin, a bearing or a screw."""
    return "no pin" if row.alternates else "nothing in them"


def pin_in_words(row: Row, units: str) -> str:
    """What to add, as an instruction."""
    size, long = (length(value, units) for value in (2.0 * row.radius, row.length))
    what = "a pin" if row.alternates else "what goes through the bores"
    return f"Add {what}: {size} in diameter, {long} long, from {place(row.start, units)} along {axis(row.axis)}."


def missing_pin(context: Context, comparison: Comparison) -> tuple[str, str] | None:
    """What an intended joint lacks, and the remedy, where empty bores of its bodies lie on its axis; None elsewhere."""
    intended, bodies = comparison.intended, {str(body.name) for body in comparison.bodies}
    if intended.type not in WITH_LINE or context.lacks("contacts") is not None:
        return None
    rows = [row for row in context.empty_rows if bodies <= set(row.bodies) and row.on(intended.axis, intended.point)]
    if not rows:
        return None
    row = max(rows, key=lambda row: (len(row.parts), row.length))
    return f"likely cause: {bores_in_words(row, context.units)}, {lack(row)}", pin_in_words(row, context.units)
