"""`kinform query`: is a freedom there, and if not, which contacts block it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinform.foundation.units import METRES_PER_UNIT, metres_per
from kinform_cli import completion, console, files
from kinform_cli.designs import looked_at
from kinform_cli.errors import refuse
from kinform_cli.options import LookedAt, PrintedTable, TableFormat, argument, examples, option

if TYPE_CHECKING:
    from rich.console import RenderableType

    from kinform.consistency.comparisons.answers import Answer
    from kinform.design import Design
    from kinform.kinematics import IntendedAnswer, IntendedMotion, QueryAnswer, QueryBlocker
    from kinform_cli.text import Lengths


EXAMPLES = examples(
    "kinform query arm.h5 base shoulder --turn z@0,-45.2,16.5",
    "kinform query arm.h5 housing lid --slide 0,0,1",
    "kinform query arm.h5 rail carriage --slide x --format json",
    "kinform query arm.h5 --intended   # every joint of [function]",
)

_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def query(
    source: LookedAt,
    a: Annotated[str | None, argument("A", "Part, group or body.", autocompletion=completion.parts)] = None,
    b: Annotated[
        str | None, argument("B", "Part, group or body that moves relative to A.", autocompletion=completion.parts)
    ] = None,
    turn: Annotated[
        str | None,
        option(
            "--turn",
            "AXIS@POINT",
            "Rotation about an axis (x, y, z, -x … or 0,0,1) through a point (as in 0,0,0: in the assembly's units; or "
            "0,0,44.9mm).",
        ),
    ] = None,
    slide: Annotated[str | None, option("--slide", "DIRECTION", "Translation: x, y, z, -x … or 0,0,1.")] = None,
    intended: Annotated[
        bool, typer.Option("--intended", help="Ask it of every joint of [function], in place of A, B and a motion.")
    ] = False,
    format: PrintedTable = TableFormat.table,
) -> None:
    """Ask whether B can turn or slide relative to A, and if not, which contacts block it.

    The exit code says whether there is an answer (0), not which one.
    """
    if intended:
        if not (a is b is turn is slide is None):
            raise typer.BadParameter("goes without A, B, --turn and --slide", param_hint="--intended")
        _intended(source, format)
        return
    if a is None or b is None:
        raise typer.BadParameter("name A and B, or ask for --intended")
    if (turn is None) == (slide is None):
        raise typer.BadParameter("give either --turn AXIS@POINT or --slide DIRECTION")
    axis, point, unit = (None, None, None) if turn is None else _turn(turn)
    direction = None if slide is None else _direction(slide, "--slide")
    design = _design(source)
    import numpy as np

    from kinform import kinematics
    from kinform_cli import text

    lengths = text.Lengths.of(design.assembly)
    metres = metres_per(unit or design.assembly.units)
    rotation = None if point is None else (np.array(axis), np.array(point) * metres)
    try:
        answer = kinematics.query(design, a, b, turn=rotation, slide=None if direction is None else np.array(direction))
    except KeyError as error:
        raise refuse(str(error.args[0]), file=source) from None
    if format is TableFormat.json:
        motion = {"slide": direction} if rotation is None else {"turn": {"axis": axis, "point": rotation[1]}}
        console.emit(text.dumps(_data(design, motion, answer)))
    else:
        console.out(_render(answer, lengths))


def _design(source: Path) -> Design:
    design = looked_at(source)
    from kinform.errors import StageError

    with files.needing(source):
        if design.kinematics is None:
            raise StageError("`kinform query`", "joints")
    return design


def _intended(source: Path, format: TableFormat) -> None:
    """The answers for all intended joints."""
    design = _design(source)
    from kinform import kinematics
    from kinform.consistency.comparisons.answers import answers
    from kinform_cli import text

    asked = list(zip(kinematics.intended_answers(design), answers(design), strict=True))
    if format is TableFormat.json:
        head = {"schema": "kinform/query-intended/1", "assembly": design.assembly.name}
        console.emit(text.dumps(head | {"joints": [_data_intended(*pair) for pair in asked]}))
    else:
        console.out(_render_intended(design, asked))


def _turn(value: str) -> tuple[tuple[float, ...], tuple[float, ...], str | None]:
    """The axis, the point, and the unit that stands behind it."""
    axis, at, point = value.partition("@")
    if not at:
        raise typer.BadParameter(f"{value!r} has no @POINT, as in z@0,0,0", param_hint="--turn")
    unit = next((name for name in sorted(METRES_PER_UNIT, key=len, reverse=True) if point.endswith(name)), None)
    return _direction(axis, "--turn"), _triple(point.removesuffix(unit or ""), "--turn"), unit


def _direction(value: str, option: str) -> tuple[float, ...]:
    name = value.strip().lower()
    sign = -1.0 if name.startswith("-") else 1.0
    if name.lstrip("+-") in _AXES:
        return tuple(sign * component + 0.0 for component in _AXES[name.lstrip("+-")])
    direction = _triple(value, option)
    if not any(direction):
        raise typer.BadParameter(f"{value!r} is no direction: it is zero", param_hint=option)
    return direction


def _triple(value: str, option: str) -> tuple[float, ...]:
    try:
        numbers = tuple(float(item) for item in value.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise typer.BadParameter(f"{value!r} is not three numbers, as in 0,0,1", param_hint=option)
    return numbers


def _data(design: Design, motion: dict[str, Any], answer: QueryAnswer) -> dict[str, Any]:
    return {
        "schema": "kinform/query/1",
        "assembly": design.assembly.name,
        "bodies": answer.bodies,
        "motion": motion,
        **_answer_fields(answer),
    }


def _answer_fields(answer: QueryAnswer) -> dict[str, Any]:
    from kinform.reports.values.plain import fields

    def ways(pair: tuple[bool | None, bool | None] | None) -> dict[str, bool | None] | None:
        return None if pair is None else {"forward": pair[0], "backward": pair[1]}

    def contacts(blockers: Iterable[QueryBlocker]) -> list[dict[str, Any]]:
        return [fields(blocker, "parts", "patch", "kind", "place", "area") for blocker in blockers]

    return {
        **fields(answer, "free_in_pair", "free_in_assembly", "residual"),
        "blocked_by": contacts(answer.blocked_by),
        "text": answer.text,
        "ways_in_pair": ways(answer.pair_ways),
        "ways_in_assembly": ways(answer.assembly_ways),
        "assembly_blocked_by": contacts(answer.assembly_blocked_by),
        "assembly_blocked_by_joints": answer.assembly_blocked_by_joints,
    }


def _data_intended(answer: IntendedAnswer, given: Answer) -> dict[str, Any]:
    from kinform.reports.values.plain import fields

    return {
        **fields(answer.joint, "name", "type", "between"),
        **fields(given, "answer", "joint"),
        **fields(answer, "free", "text"),
        "motions": [fields(item, "kind", "twist") | _answer_fields(item.answer) for item in answer.motions],
    }


def _render(answer: QueryAnswer, lengths: Lengths) -> RenderableType:
    from kinform_cli.tables import stacked

    items: list[RenderableType] = [answer.text]
    if answer.blocked_by:
        items.append(_contacts("\nBlocked by", answer.blocked_by, lengths))
    elsewhere = [item for item in answer.assembly_blocked_by if item.patch not in {b.patch for b in answer.blocked_by}]
    if elsewhere:
        title = "\nBlocked in the whole assembly also by" if answer.blocked_by else "\nBlocked in the whole assembly by"
        items.append(_contacts(title, elsewhere, lengths))
    if answer.assembly_blocked_by_joints:
        items.append(f"\nand by joints that are stated: {', '.join(answer.assembly_blocked_by_joints)}")
    return stacked(*items)


def _contacts(title: str, blockers: Iterable[QueryBlocker], lengths: Lengths) -> RenderableType:
    from kinform_cli.tables import Rows

    unit = lengths.small
    numeric = ("patch", f"area {unit}²")
    headings = ("part", "part", "patch", "surface", numeric[1], f"at {lengths.unit}")
    rows = Rows(*headings, title=title, right=numeric, keys=2, names=["part"])
    for blocker in blockers:
        rows.add(
            *blocker.parts, str(blocker.patch), blocker.kind, lengths.area(blocker.area), lengths.point(blocker.place)
        )
    return rows


def _render_intended(design: Design, asked: Sequence[tuple[IntendedAnswer, Answer]]) -> RenderableType:
    """For each intended joint the answer that `run` gives too, what it means for the motion, and for what is not free
    the contacts that block it."""
    from rich.text import Text

    from kinform_cli.tables import stacked
    from kinform_cli.text import Lengths

    if not asked:
        return "no joints are intended: [function] states none"
    lengths = Lengths.of(design.assembly)
    items: list[RenderableType] = []
    for answer, given in asked:
        between = " and ".join(answer.joint.between)
        said = f"{given.answer}{_codes(design, given.name)}"
        items.append(Text(f"{answer.joint.name}: {answer.joint.type} between {between}: {said}", style="bold"))
        items.append(f"  {_meaning(answer, given, lengths)}")
        for item in answer.motions:
            if not item.answer.free_in_assembly:
                items.append(f"  {item.kind} ({_sense(item)}): {item.answer.text}")
                blocking = {b.patch: b for b in (*item.answer.blocked_by, *item.answer.assembly_blocked_by)}
                if blocking:
                    items.append(_contacts("Blocked by", blocking.values(), lengths))
    return stacked(*items)


def _codes(design: Design, joint: str) -> str:
    """As in " (KF401)": what the check found of an intended joint."""
    findings = () if design.report is None else design.report.findings
    codes = sorted({finding.code for finding in findings if finding.subject == (joint,)})
    return f" ({', '.join(codes)})" if codes else ""


def _meaning(answer: IntendedAnswer, given: Answer, lengths: Lengths) -> str:
    """Whether the motion is free, and how that goes together with the answer to the joint."""
    if given.answer == "no contact":
        gap = f", {lengths.length(given.gap)} {lengths.small} apart" if given.gap else ""
        free = "the motion is free because nothing holds it" if answer.free else answer.text
        return f"the two bodies do not touch{gap}: {free}"
    if given.answer == "not held":
        return f"{answer.text}; contact leaves more free than that: {given.free}"
    if given.answer == "contradicts":
        return f"{given.blocked_by}; the intended motion: {answer.text}"
    if given.answer == "undecided":
        return f"contact does not decide whether it is this joint; the intended motion: {answer.text}"
    if answer.free is False:
        return f"contact between the two gives this joint; in the whole assembly: {answer.text}"
    return answer.text


def _sense(item: IntendedMotion) -> str:
    from kinform_cli.text import vector

    return vector(item.twist[:3] if item.kind != "slide" else item.twist[3:])
