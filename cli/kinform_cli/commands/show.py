"""`kinform show`: what is in a results file."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from kinform_cli import console, files
from kinform_cli.options import Debug, Quiet, Results, TableFormat, examples

__all__ = ["EXAMPLES", "Topic", "show"]

EXAMPLES = examples(
    "kinform show arm.h5",
    "kinform show arm.h5 joints",
    "kinform show arm.h5 joints --format json | jq '.joints[].type'",
    "kinform show arm.h5 contacts | grep shoulder",
)


class Topic(StrEnum):
    """What can be shown."""

    assembly = "assembly"
    contacts = "contacts"
    joints = "joints"
    mobility = "mobility"
    mass = "mass"
    simulation = "simulation"
    findings = "findings"


def show(
    source: Results,
    topic: Annotated[
        Topic | None,
        typer.Argument(
            metavar="TOPIC",
            show_default=False,
            help="What to show; without it an overview.",
        ),
    ] = None,
    format: Annotated[
        TableFormat, typer.Option("--format", "-f", help="json: SI units and radians.")
    ] = TableFormat.table,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Show what a results file holds: tables for people, or JSON."""
    design = files.read(source)
    from kinform import reports
    from kinform_cli import views

    name = None if topic is None else topic.value
    with files.needing(source):
        if format is TableFormat.json:
            console.emit(reports.summary_json(design, name))
        else:
            console.out(views.render(design, name))
