"""`kinform check`: compare behaviour with function; the gate."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinform_cli import files
from kinform_cli.errors import refuse
from kinform_cli.gate import conclude
from kinform_cli.options import Debug, FailOn, FindingsFormat, ManifestFolder, Quiet, Results, Severity, examples
from kinform_cli.progress import Working

if TYPE_CHECKING:
    from kinform.model.design import Design

__all__ = ["EXAMPLES", "check"]

EXAMPLES = examples(
    "kinform check e.h5",
    "kinform check e.h5 --format concise --fail-on warning",
    "kinform check e.h5 --format json > findings.json",
    "kinform check e.h5 -f sarif --manifest-folder designs > findings.sarif",
    "kinform check e.h5 --lock behaviour.lock.json",
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
    lock: Annotated[
        Path | None,
        typer.Option(
            "--lock", metavar="FILE", show_default=False, help="Also compare the behaviour with this lock (KF450)."
        ),
    ] = None,
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
    if lock is not None:
        design = _compared(design, lock, manifest_folder)
    conclude(design, format, fail_on, manifest_folder)


def _compared(design: Design, lock: Path, manifest_folder: Path | None) -> Design:
    """The design with what differs from the lock among its findings, which name it as they name other files."""
    from kinform import changes

    try:
        text = lock.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        told = getattr(error, "strerror", None) or "is not UTF-8 text"
        raise refuse(
            f"the lock cannot be read: {told}", file=lock, remedy="write it first: kinform lock F.h5 -o FILE"
        ) from None
    assert design.report is not None
    shown = str(lock) if manifest_folder is None else Path(os.path.relpath(lock, manifest_folder)).as_posix()
    report = changes.with_lock(design.report, design, changes.read_lock(text, shown))
    return replace(design, report=report)
