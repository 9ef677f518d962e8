"""The answer that geometry gives to each intended joint: agrees, not held, contradicts, no contact, or undecided.

| answer | contact ... |
|---|---|
| agrees | gives this joint, within the limits of KF403 and KF404 |
| not held | leaves the intended motion free, and more |
| contradicts | forbids the intended motion, as is proven (KF402), or gives the joint elsewhere, or with another pitch |
| no contact | there is none between the two bodies |
| undecided | neither; or nothing proves that it is forbidden, or elsewhere; or a part with play between the two may \
carry the joint, or hold more of it |
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from kinform.consistency.comparisons.comparison import Comparison
from kinform.consistency.comparisons.intended_joints import compare_joints
from kinform.consistency.context import Context
from kinform.design import Design
from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.model.assembly import Assembly
from kinform.model.kinematics import Body

AnswerName = Literal["agrees", "not held", "contradicts", "no contact", "undecided"]
ANSWERS: tuple[AnswerName, ...] = get_args(AnswerName)


@dataclass(frozen=True, eq=False)
class Answer:
    """What geometry says to one intended joint. Angles in rad, lengths in m; None: not comparable."""

    name: str
    between: tuple[str, str]
    type: str
    answer: AnswerName
    joint: str | None
    """The derived joint."""
    angle: float | None
    offset: float | None
    free: str
    """What else is free, of joints that are not held."""
    blocked_by: str
    """What forbids the motion, of joints that are contradicted."""
    gap: float | None
    """Between the boxes of the two bodies, where they do not touch; 0 where the boxes meet."""


def answer_counts(given: Iterable[str]) -> tuple[tuple[str, int], ...]:
    """How many joints have each answer, in the order of `ANSWERS`, without those that none has."""
    every = Counter(given)
    counts = [(answer, every[answer]) for answer in ANSWERS]
    return tuple((answer, count) for answer, count in counts if count)


def answer_of(context: Context, c: Comparison) -> Answer:
    """The answer to the intended joint of a comparison; needs kinematics."""
    kind, free, blocked = _kind(context, c)
    return Answer(
        name=c.intended.name,
        between=c.intended.between,
        type=c.intended.type,
        answer=kind,
        joint=None if c.joint is None else str(c.joint.name),
        angle=c.angle,
        offset=c.offset,
        free=free,
        blocked_by=blocked,
        gap=_gap(context.assembly, c.bodies) if kind == "no contact" else None,
    )


def answers(design: Design, context: Context | None = None) -> tuple[Answer, ...]:
    """The answers to all intended joints, in the order of the function; needs kinematics. Where rules have run, the
    answers are theirs. `context` is what else is asked about the design."""
    assert design.kinematics is not None
    assembly = design.assembly
    compared = compare_joints(assembly, design.contacts, design.kinematics, assembly.function.joints)
    context = context or Context(design)
    given = tuple(answer_of(context, one) for one in compared)
    said = {} if design.report is None else {s.name: s.outcome for s in design.report.statements if s.kind == "joint"}
    words: dict[str, AnswerName] = {answer: answer for answer in ANSWERS} | {"not checked": "undecided"}
    return tuple(replace(one, answer=words.get(said.get(one.name, ""), one.answer)) for one in given)


def _kind(context: Context, c: Comparison) -> tuple[AnswerName, str, str]:
    """The answer, what else is free, and what forbids it."""
    if c.state == "taken":
        assert c.joint is not None
        if c.afloat:
            return "undecided", "", ""
        if not c.joint.patches:
            return "no contact", "", ""
        reading = c.joint.readings[0]
        if reading.cause == "doubt":
            return "undecided", "", ""
        return "not held", f"{reading.type}, {counted(reading.freedoms, 'freedom')} by contact", ""
    if c.state in ("absent", "stated"):
        return "no contact", "", ""
    if c.state == "undecided":
        return "undecided", "", ""
    if c.loose:
        return "not held", f"{c.type}, {counted(c.freedoms, 'freedom')} by contact", ""
    judged = context.forbidden(c)
    if judged is not None:
        why = c.reason or "both sides are one body" if c.state == "one body" else f"by contact it is {c.type}"
        return ("contradicts", "", why) if judged.witness is not None else ("undecided", "", "")
    if c.right_type:
        off = (c.tilted, c.displaced)
        if any(off):
            return "contradicts", "", "its axis is elsewhere"
        if c.other_pitch:
            return "contradicts", "", "it advances otherwise"
        return "undecided" if None in off else "agrees", "", ""
    return "not held", f"{c.type}, {counted(c.freedoms, 'freedom')} by contact", ""


def _gap(assembly: Assembly, bodies: Sequence[Body]) -> float | None:
    """m between the bounding boxes of two bodies."""
    boxes = []
    for body in bodies:
        placed = [
            part.mesh.placed_box(part.X_WP) for name in body.parts if (part := assembly.part(name)).mesh is not None
        ]
        if not placed:
            return None
        boxes.append((np.min([low for low, _ in placed], axis=0), np.max([high for _, high in placed], axis=0)))
    (low_a, high_a), (low_b, high_b) = boxes
    return float(np.linalg.norm(np.maximum(np.maximum(low_a - high_b, low_b - high_a), 0.0)))
