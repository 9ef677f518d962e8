"""Bores of several bodies line up, nothing is in them, and nothing else holds the bodies together.

Bores in a row that a pin could go through, of about one size and near each other, which no part comes into. They count
where the bodies may move relative to each other otherwise than a pin there would let them: so screw holes of a hinge
that has its pin, hollow shafts, and holes of parts that are one body are not reported. A warning of three bores and
more on one line that change from body to body and back, as the knuckles of a hinge or a fork and its tongue do; else a
note: holes may be for screws that are in no mesh, or for nothing. Where a stated joint hangs on them KF401 or KF414
names them, and where the function states all joints nothing else does.

Why it matters: without the pin or the screws the parts fall apart, and joints and mobility are those of loose parts.

What to do: add the pin; or join what screws hold by [[group]].

Example: the knuckles of a butt hinge touch on their end faces, and its pin was left out of the export.
"""

from __future__ import annotations

from collections.abc import Sequence

from kinform.consistency.comparisons.gathering import Ranked, gathered
from kinform.consistency.comparisons.missing_pin import bores_in_words, lack, pin_in_words
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, skipped
from kinform.consistency.questions.empty_bores import Row, holds_something
from kinform.consistency.rule import Rule
from kinform.foundation.words import quoted

_CONTACT = {"planar": "contact of flat faces"}


def check(context: Context) -> Outcome:
    """Every row that would hold what nothing else holds, those between the same bodies together."""
    if context.kinematics.membership:
        return skipped("the function states all joints: it decides what holds")
    compared = () if context.lacks("comparisons") else context.comparisons
    stated = [{body.name for body in comparison.bodies} for comparison in compared]
    of_bodies: dict[tuple[str, ...], list[Row]] = {}
    for row in context.empty_rows:
        names = {str(name) for name in row.bodies}
        if not any(len(pair) == 2 and pair <= names for pair in stated) and holds_something(row, context.kinematics):
            of_bodies.setdefault(row.bodies, []).append(row)
    ranked = (_ranked(context, rows) for rows in of_bodies.values())
    return decided(gathered(ranked, "row"))


def _ranked(context: Context, rows: Sequence[Row]) -> Ranked:
    first = max(rows, key=lambda row: len(row.parts))
    # on two lines they are for screws or dowels
    missing = first.alternates and all(row.on(first.axis, first.start) for row in rows)
    lacks = lack(first) if missing else "nothing in them"
    what = bores_in_words(first, context.units, len(rows))
    joint = next((j for j in context.kinematics.joints if set(j.bodies) <= set(first.bodies)), None)
    holds = "nothing holds" if joint is None else f"only {_CONTACT.get(joint.type, 'contact')} holds"
    parts = sorted(set(first.parts))
    remedy = "Join the parts by [[group]] if screws hold them, or add what goes through the holes."
    if missing:
        remedy = pin_in_words(first, context.units)
    finding = RULE.at("warning" if missing else "note").finding(
        parts,
        f"{what} in {quoted(parts)}, {lacks}: {holds} {quoted(first.bodies)} together",
        found=f"{what}, {lacks}",
        intended="a pin" if missing else "a pin, screws, or no holes",
        place=first.start + 0.5 * first.length * first.axis,
        remedy=remedy,
    )
    return Ranked("pin" if missing else "holes", float(len(rows)), finding)


RULE = Rule(
    "KF211", "bores-empty", "warning", __doc__, check, needs=("several parts", "contacts", "kinematics"), also=("note",)
)
