"""`kinform run`: everything, reusing what is still valid."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kinform_cli import console, files
from kinform_cli.gate import Gate
from kinform_cli.options import (
    AllowOutside,
    Depfile,
    FailOn,
    FindingsFormat,
    Geometry,
    GeometryKind,
    Jobs,
    Packages,
    PrintedFindings,
    Ranges,
    Severity,
    Sources,
    Units,
    cores,
    examples,
    option,
    reading,
)
from kinform_cli.progress import Working

EXAMPLES = examples(
    "kinform run arm.toml -o arm.h5",
    "kinform run arm.toml -o arm.h5 --format concise --fail-on warning",
    "kinform run housing.stl shaft.stl --units mm -o pair.h5",
    "kinform run arm.toml -o arm.h5 --ranges",
    "kinform run robot.urdf -o robot.h5",
    "kinform run arm.toml                # verify only, keep nothing",
)


def run(
    sources: Sources,
    output: Annotated[
        Path | None, option("--output -o", "F.h5", "Results file to write; what is still valid in it is reused.")
    ] = None,
    units: Units = None,
    allow_outside: AllowOutside = False,
    geometry: Geometry = GeometryKind.visual,
    packages: Packages = None,
    format: PrintedFindings = FindingsFormat.full,
    fail_on: FailOn = Severity.error,
    ranges: Ranges = None,
    jobs: Jobs = None,
    depfile: Depfile = None,
) -> None:
    """Import, contacts, joints, mass, simulate and check in one go.

    Only what a change affects is computed again.

    Exit code 0: every rule that applies ran and passed.
    1: findings at or above --fail-on.
    2: not verified: a rule could not decide, none ran, or the input is bad.
    """
    manifest = files.is_manifest(sources, units)
    files.check_outputs(sources, output, depfile)
    first = output is not None and not output.exists()
    import kinform

    with Working("run") as working:
        outcome = kinform.run(
            sources[0] if manifest else sources,
            output,
            jobs=cores(jobs),
            progress=working.step,
            allow_outside=allow_outside,
            units=units,
            say=console.say,
            ranges=ranges,
            reading=reading(geometry, packages),
        )
    if depfile is not None and output is not None:
        files.write_rule(depfile, output, outcome.gist, sources)
    code = Gate(format, fail_on, sources[0].parent if manifest else None).judge_run(outcome)
    if output is None:
        console.say("nothing was kept: add -o F.h5, and `kinform show` and `kinform report` can look at the results")
    elif first:
        page = output.with_suffix(".html")
        console.say(f"next: kinform report {output} -o {page}   (one page to look at), or: kinform show {output}")
    raise typer.Exit(code)
