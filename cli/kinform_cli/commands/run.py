"""`kinform run`: everything, reusing what is still valid."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kinform_cli import console, files
from kinform_cli.gate import Gate, say_next
from kinform_cli.options import (
    AllowOutside,
    AllowXacro,
    Depfile,
    Deviation,
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
    Strict,
    TrustResults,
    Units,
    Verbose,
    cores,
    examples,
    option,
    printed,
    reading,
)
from kinform_cli.progress import Working
from kinform_cli.text import command

EXAMPLES = examples(
    "kinform run arm.toml -o arm.h5",
    "kinform run arm.toml -o arm.h5 --format concise --fail-on warning",
    "kinform run housing.stl shaft.stl --units mm -o pair.h5",
    "kinform run arm.toml -o arm.h5 --no-ranges",
    "kinform run robot.urdf -o robot.h5",
    "kinform run arm.toml                # verify only, keep nothing",
    "kinform run .                       # the manifest in this folder",
    "kinform run arm.toml -v -f sarif=arm.sarif -f junit=arm.xml",
)


def run(
    sources: Sources,
    output: Annotated[
        Path | None, option("--output -o", "F.h5", "Results file to write; what is still valid in it is reused.")
    ] = None,
    units: Units = None,
    allow_outside: AllowOutside = False,
    allow_xacro: AllowXacro = False,
    geometry: Geometry = GeometryKind.visual,
    packages: Packages = None,
    deviation: Deviation = None,
    format: PrintedFindings = None,
    verbose: Verbose = False,
    fail_on: FailOn = Severity.error,
    ranges: Ranges = None,
    jobs: Jobs = None,
    depfile: Depfile = None,
    strict: Strict = False,
    trust_results: TrustResults = False,
) -> None:
    """Import, contacts, joints, mass, simulate and check in one go.

    Only what a change affects is computed again.

    Exit code 0: no findings, and nothing that was asked for is undecided.
    1: findings at or above --fail-on.
    2: not verified: a rule could not decide, none ran, the input is bad, or what --strict adds.
    """
    sources = files.sources_of(sources)
    how = printed(format, verbose)
    manifest = files.is_manifest(sources, units)
    files.check_outputs(sources, output, depfile)
    files.check_findings(how.files, [*sources, *filter(None, (output, depfile))])
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
            reading=reading(geometry, packages, deviation, allow_xacro=allow_xacro),
            trust_results=trust_results,
        )
    if depfile is not None and output is not None:
        files.write_rule(depfile, output, outcome.gist, sources)
    code = Gate(how, fail_on, sources[0].parent if manifest else None, strict).judge_run(outcome)
    if output is None:
        again = command("kinform", "run", *sources, *(["--units", units] if units else []), "-o", _results(sources[0]))
        console.say(f"nothing was kept: {again} keeps it for `kinform show` and `kinform report`")
    elif first or (how.format is FindingsFormat.brief and code):
        say_next(output)
    raise typer.Exit(code)


def _results(source: Path) -> Path:
    """A name for the results of a source, in the present folder."""
    return Path(f"{source.resolve().stem}.h5")
