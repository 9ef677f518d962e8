"""`kinform check`: compare behaviour with function; the gate."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from kinform_cli import files
from kinform_cli.gate import conclude
from kinform_cli.options import Debug, FailOn, FindingsFormat, ManifestFolder, Quiet, Results, Severity, examples
from kinform_cli.progress import Working

__all__ = ["EXAMPLES", "check"]

EXAMPLES = examples(
    "kinform check e.h5",
    "kinform check e.h5 --format concise --fail-on warning",
    "kinform check e.h5 --format json > findings.json",
    "kinform check e.h5 --format sarif --manifest-folder designs > findings.sarif",
    "kinform check e.h5 -o e.h5        # keep the findings in the file",
)


def check(
    source: Results,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="F.h5",
            show_default=False,
            help="Also write the findings to a results file; may be the one that is read.",
        ),
    ] = None,
    format: Annotated[FindingsFormat, typer.Option("--format", "-f", help="How findings are printed.")] = (
        FindingsFormat.full
    ),
    fail_on: FailOn = Severity.error,
    manifest_folder: ManifestFolder = None,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Check form, behaviour and function against each other.

    Exit code 0: every rule that applies ran and passed.
    1: findings at or above --fail-on.
    2: not verified: a rule could not decide, none ran, or the input is bad.
    """
    if output is not None:
        files.check_output(output)
    from kinform import results, stages

    design = files.read(source)
    with files.needing(source), Working("check"):
        design = stages.check(design)
    if output is not None:
        results.write(design, output)
    conclude(design, format, fail_on, manifest_folder)
