"""The joints that the function states, each with the answer that contact alone gives to it."""

from __future__ import annotations

from kinform.consistency.comparisons.answers import Answer, answers
from kinform.design import Design
from kinform.foundation import words
from kinform.frozen import dataclass
from kinform.reports.page.phrases import axis_words, point_words

SIGNS = {"agrees": "✓", "not held": "▲", "contradicts": "✕", "no contact": "▲", "undecided": "?"}
MARKS = {
    "agrees": "agrees", "not held": "doubtful", "contradicts": "disagrees", "no contact": "doubtful",
    "undecided": "not-decided",
}  # fmt: skip
"""How an answer is set: as the rows of the agreement."""
ORDER = ("contradicts", "no contact", "undecided", "not held", "agrees")
"""What the page shows first."""


@dataclass(frozen=True)
class AnswerRow:
    """One intended joint."""

    name: str
    answer: str
    stated: str
    why: str
    joint: int
    """Number of the derived joint, −1 where there is none."""

    @property
    def sign(self) -> str:
        """Of the answer."""
        return SIGNS[self.answer]

    @property
    def mark(self) -> str:
        """The class of the row."""
        return MARKS[self.answer]


def answer_rows(design: Design) -> list[AnswerRow]:
    """A row an intended joint, those that geometry contradicts first; empty without joints."""
    if design.kinematics is None:
        return []
    numbers = {str(joint.name): k for k, joint in enumerate(design.kinematics.joints)}
    stated = {joint.name: joint for joint in design.assembly.function.joints}
    units = design.assembly.units
    rows = []
    for answer in answers(design):
        joint = stated[answer.name]
        asked = joint.type + axis_words(joint.type, joint.axis, joint.axis2)
        asked += point_words(joint.type, joint.point, units) + f", between {words.listed(joint.between)}"
        number = numbers.get(answer.joint or "", -1)
        rows.append(AnswerRow(answer.name, answer.answer, asked, _why(answer, units), number))
    return sorted(rows, key=lambda row: ORDER.index(row.answer))


def _why(answer: Answer, units: str) -> str:
    """What else is free or in the way, and how far axis and place are from what is stated."""
    told = []
    if answer.free:
        told.append(f"contact leaves it {answer.free}")
    if answer.blocked_by:
        told.append(answer.blocked_by)
    if answer.gap is not None:
        told.append(f"boxes {words.length(answer.gap, units)} apart" if answer.gap > 0.0 else "the boxes meet")
    if answer.angle is not None and answer.answer in ("agrees", "contradicts"):
        # To a nanometre and its angle: finer is rounding, which differs from one processor to the next.
        off = "" if answer.offset is None else f", {words.length(round(answer.offset, 9), units, 3)} beside"
        told.append(f"axis {words.angle(round(answer.angle, 9), 3)} off{off}")
    return "; ".join(told)
