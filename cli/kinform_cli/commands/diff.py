"""`kinform diff`: what changed in behaviour between two results files."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinform_cli import console, files
from kinform_cli.designs import looked_at
from kinform_cli.options import Tolerances, argument, examples, option
from kinform_cli.text import hanging

if TYPE_CHECKING:
    from kinform.changes import Tolerance


EXAMPLES = examples(
    "kinform diff before.h5 after.h5",
    "kinform diff before.h5 after.h5 --tolerance 0.1mm --tolerance 1%",
    "kinform diff before.h5 after.h5 --report change.html    # as one page",
    "kinform diff before.h5 after.h5 --format md > change.md",
)


class DiffFormat(StrEnum):
    """How changes are printed."""

    full = "full"
    json = "json"
    md = "md"


def diff(
    before: Annotated[Path, argument("A.h5", "Results file before; or a manifest, robot description or scene.")],
    after: Annotated[Path, argument("B.h5", "Results file after; the same.")],
    format: Annotated[DiffFormat, typer.Option("--format", "-f", help="json: SI and radians.")] = DiffFormat.full,
    tolerances: Tolerances = None,
    report: Annotated[
        Path | None, option("--report", "FILE.html", "Also write a page: before and after in one view.")
    ] = None,
) -> None:
    """Say what changed in behaviour: joints, axes, freedoms, ranges, masses, overlaps, findings.

    Exit code 0: the same behaviour.
    1: something changed beyond the tolerances.
    2: not verified: one of the files lacks what the other has, or the input is bad.
    """
    within = tolerance(tolerances)
    from kinform import changes

    if report is not None:
        files.check_page(report, inputs=[before, after])
    old, new = looked_at(before), looked_at(after)
    files.warn_of_origin(old, before)
    files.warn_of_origin(new, after)
    result = changes.compare_designs(old, new, within)
    if report is not None:
        files.write_text(report, changes.diff_page(result, old, new, (before.name, after.name)))
        console.say(f"{report}: to be opened in a browser")
    text = changes.render(result, format.value)
    console.emit(hanging(text, console.columns()) if format is DiffFormat.full else text)
    raise typer.Exit(result.code)


def tolerance(stated: list[str] | None) -> Tolerance | None:
    """The tolerances of the command line; a usage error where one is none."""
    if not stated:
        return None
    from kinform.changes import Tolerance

    try:
        return Tolerance.of(stated)
    except ValueError as error:
        raise typer.BadParameter(str(error), param_hint="--tolerance") from None
