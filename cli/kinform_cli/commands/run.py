"""`kinform run`: everything, reusing what is still valid."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kinform_cli.inputs import Sources, is_manifest
from kinform_cli.options import (
    AllowOutside,
    Debug,
    Depfile,
    FailOn,
    FindingsFormat,
    Jobs,
    Quiet,
    Ranges,
    Severity,
    Units,
    examples,
)
from kinform_cli.running import execute

__all__ = ["EXAMPLES", "run"]

EXAMPLES = examples(
    "kinform run arm.toml -o arm.h5",
    "kinform run arm.toml -o arm.h5 --format concise --fail-on warning",
    "kinform run housing.stl shaft.stl --units mm -o pair.h5",
    "kinform run arm.toml -o arm.h5 --ranges",
    "kinform run arm.toml                # verify only, keep nothing",
)


def run(
    sources: Sources,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="F.h5",
            show_default=False,
            help="Results file to write; what is still valid in it is reused.",
        ),
    ] = None,
    units: Units = None,
    allow_outside: AllowOutside = False,
    format: Annotated[FindingsFormat, typer.Option("--format", "-f", help="How findings are printed.")] = (
        FindingsFormat.full
    ),
    fail_on: FailOn = Severity.error,
    ranges: Ranges = None,
    jobs: Jobs = None,
    depfile: Depfile = None,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Import, contacts, joints, mass, simulate and check in one go.

    Only what a change affects is computed again.

    Exit code 0: every rule that applies ran and passed.
    1: findings at or above --fail-on.
    2: not verified: a rule could not decide, none ran, or the input is bad.
    """
    code = execute(
        sources,
        output,
        manifest=is_manifest(sources, units),
        units=units,
        allow_outside=allow_outside,
        format=format,
        fail_on=fail_on,
        ranges=ranges,
        jobs=jobs,
        depfile=depfile,
    )
    raise typer.Exit(code)
