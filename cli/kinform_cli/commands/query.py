"""`kinform query`: is a freedom there, and if not, which contacts block it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from kinform_cli import console, files
from kinform_cli.errors import refuse
from kinform_cli.options import Debug, Quiet, Results, TableFormat, examples

if TYPE_CHECKING:
    from rich.console import RenderableType

    from kinform.kinematics import QueryAnswer
    from kinform.model.design import Design
    from kinform_cli.text import Lengths

__all__ = ["EXAMPLES", "query"]

EXAMPLES = examples(
    "kinform query arm.h5 base shoulder --turn z@0,-45.2,16.5",
    "kinform query arm.h5 housing lid --slide 0,0,1",
    "kinform query arm.h5 rail carriage --slide x --format json",
)

_NAMED = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def query(
    source: Results,
    a: Annotated[str, typer.Argument(metavar="A", show_default=False, help="Part, group or body.")],
    b: Annotated[
        str,
        typer.Argument(metavar="B", show_default=False, help="Part, group or body that moves relative to A."),
    ],
    turn: Annotated[
        str | None,
        typer.Option(
            "--turn",
            metavar="AXIS@POINT",
            show_default=False,
            help="Rotation about an axis (x, y, z, -x … or 0,0,1) through a point (as in 0,0,0; "
            "in the assembly's units).",
        ),
    ] = None,
    slide: Annotated[
        str | None,
        typer.Option("--slide", metavar="DIRECTION", show_default=False, help="Translation: x, y, z, -x … or 0,0,1."),
    ] = None,
    format: Annotated[
        TableFormat, typer.Option("--format", "-f", help="json: SI units and radians.")
    ] = TableFormat.table,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Ask whether B can turn or slide relative to A, and if not, which contacts block it.

    The exit code says whether there is an answer (0), not which one.
    """
    if (turn is None) == (slide is None):
        raise typer.BadParameter("give either --turn AXIS@POINT or --slide DIRECTION")
    axis, point = (None, None) if turn is None else _turn(turn)
    direction = None if slide is None else _direction(slide, "--slide")
    design = files.read(source)
    import numpy as np

    from kinform import kinematics
    from kinform.errors import StageError
    from kinform_cli import text

    lengths = text.Lengths.of(design.assembly)
    with files.needing(source):
        if design.kinematics is None:
            raise StageError("`kinform query`", "joints")
    rotation = None if point is None else (np.array(axis), np.array(point) * lengths.metres)
    try:
        answer = kinematics.query(design, a, b, turn=rotation, slide=None if direction is None else np.array(direction))
    except KeyError as error:
        raise refuse(str(error.args[0]), file=source, remedy="name two of them, as they are written") from None
    if format is TableFormat.json:
        motion = {"slide": direction} if rotation is None else {"turn": {"axis": axis, "point": rotation[1]}}
        console.emit(text.dumps(_data(design, motion, answer)))
    else:
        console.out(_render(answer, lengths))


def _turn(value: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    axis, at, point = value.partition("@")
    if not at:
        raise typer.BadParameter(f"{value!r} has no @POINT, as in z@0,0,0", param_hint="--turn")
    return _direction(axis, "--turn"), _triple(point, "--turn")


def _direction(value: str, option: str) -> tuple[float, ...]:
    name = value.strip().lower()
    sign = -1.0 if name.startswith("-") else 1.0
    if name.lstrip("+-") in _NAMED:
        return tuple(sign * component + 0.0 for component in _NAMED[name.lstrip("+-")])
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
        "free_in_pair": answer.free_in_pair,
        "free_in_assembly": answer.free_in_assembly,
        "residual": answer.residual,
        "blocked_by": [
            {
                "parts": blocker.parts,
                "patch": blocker.patch,
                "kind": blocker.kind,
                "place": blocker.place,
                "area": blocker.area,
            }
            for blocker in answer.blocked_by
        ],
        "text": answer.text,
    }


def _render(answer: QueryAnswer, lengths: Lengths) -> RenderableType:
    from rich.console import Group

    from kinform_cli.tables import Rows

    if not answer.blocked_by:
        return answer.text
    unit = lengths.unit
    numeric = ("patch", f"area {unit}²")
    headings = ("part", "part", "patch", "surface", numeric[1], f"at {unit}")
    rows = Rows(*headings, title="\nBlocked by", right=numeric, keys=2)
    for blocker in answer.blocked_by:
        rows.add(
            *blocker.parts,
            str(blocker.patch),
            blocker.kind,
            lengths.area(blocker.area),
            lengths.point(blocker.place),
        )
    return Group(answer.text, rows)
