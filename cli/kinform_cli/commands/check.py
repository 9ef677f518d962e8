"""`kinform check`: compare behaviour with function; the gate."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kinform.foundation.words import counted
from kinform_cli import console, files
from kinform_cli.designs import looked_at
from kinform_cli.errors import refuse
from kinform_cli.gate import Gate, say_next
from kinform_cli.options import (
    FailOn,
    FindingsFormat,
    LookedAt,
    ManifestFolder,
    Printed,
    PrintedFindings,
    Severity,
    Strict,
    Verbose,
    examples,
    option,
    printed,
)
from kinform_cli.progress import Working

if TYPE_CHECKING:
    from kinform.design import Design
    from kinform.model.findings import CheckReport

JSON_BYTES = 16 << 20
"""Bytes of a JSON file (a lock, a baseline): a hundred thousand entries. Values take 25 times that at worst, 400 MB."""


EXAMPLES = examples(
    "kinform check e.h5",
    "kinform check e.h5 --format concise --fail-on warning",
    "kinform check e.h5 --format json > findings.json",
    "kinform check e.h5 -f sarif --manifest-folder designs > findings.sarif",
    "kinform check e.h5 --lock behaviour.lock.json",
    "kinform check e.h5 --witness      # replay the proofs of its findings",
    "kinform check e.h5 -o e.h5        # keep the findings in the file",
    "kinform check e.h5 --write-baseline b.json",
    "kinform check e.h5 --baseline b.json     # only what is new counts",
)


def check(
    source: LookedAt,
    output: Annotated[
        Path | None,
        option("--output -o", "F.h5", "Also write the findings to a results file; may be the one that is read."),
    ] = None,
    format: PrintedFindings = None,
    verbose: Verbose = False,
    fail_on: FailOn = Severity.error,
    baseline: Annotated[Path | None, option("--baseline", "B.json", "Findings of this file do not count.")] = None,
    write_baseline: Annotated[
        Path | None, option("--write-baseline", "B.json", "Write today's findings as a baseline.")
    ] = None,
    manifest_folder: ManifestFolder = None,
    lock: Annotated[Path | None, option("--lock", "FILE", "Also compare the behaviour with this lock (KF450).")] = None,
    strict: Strict = False,
    witness: Annotated[
        bool,
        typer.Option("--witness", help="Replay the witness of every finding by another method, in place of checking."),
    ] = False,
) -> None:
    """Check form, behaviour and function against each other.

    Exit code 0: no findings, and nothing that was asked for is undecided.
    1: findings at or above --fail-on.
    2: not verified: a rule could not decide, none ran, the input is bad, or what --strict adds.

    With --witness: 0 where no witness fails, 1 where one does not hold.

    A results file that your kinform did not write is checked, and the verdict says so.
    """
    how = printed(format, verbose)
    if witness:
        if any(others := (output, baseline, write_baseline, lock)):
            raise typer.BadParameter(f"goes without {next(filter(None, others))}", param_hint="--witness")
        raise typer.Exit(_replayed(source, how, manifest_folder))
    files.check_findings(how.files, [source, *filter(None, (output, write_baseline))])
    if output is not None:
        files.check_folder(output.parent, inputs=[source])
        files.check_output(output)
    if write_baseline is not None:
        files.check_text_output(write_baseline, inputs=[source])
    from kinform import results, stages
    from kinform.consistency import adopt

    design = looked_at(source)
    if output is not None:
        files.warn_if_not_whole(output)
    with files.needing(source), Working("check"):
        design = stages.check(design)
    if output is not None:
        results.write(design, output)
    report = design.report
    assert report is not None
    if baseline is not None:
        report = _without_baseline(report, baseline)
    if write_baseline is not None:
        adopted = adopt(report)
        files.write_text(write_baseline, adopted.text())
        console.say(f"{counted(len(adopted.keys), 'finding')} written to {write_baseline}")
    design = replace(design, report=report)
    if lock is not None:
        design = _with_lock(design, lock, manifest_folder)
    code = Gate(how, fail_on, manifest_folder, strict).judge(design)
    if code and how.format is FindingsFormat.brief:
        say_next(source if output is None else output)
    raise typer.Exit(code)


def _replayed(source: Path, how: Printed, manifest_folder: Path | None) -> int:
    """Replay the witnesses of a results file, or of what a check finds now; returns the exit code."""
    from kinform import replays, stages
    from kinform.foundation.boundary import Boundary
    from kinform.reports import witnesses

    if how.files or how.format not in (FindingsFormat.brief, FindingsFormat.full, FindingsFormat.json):
        raise typer.BadParameter("replays are printed as text or as json", param_hint="--format")
    design = looked_at(source)
    if design.report is None:
        with files.needing(source), Working("check"):
            design = stages.check(design)
    files.warn_of_origin(design, source)
    assert design.report is not None
    folder = source.parent if manifest_folder is None else manifest_folder
    boundary = Boundary(source, packages=() if manifest_folder is None else (manifest_folder,))
    with Working("replay"):
        replayed = replays.replay_all(design.report, design, folder, boundary)
    as_text = witnesses.as_json if how.format is FindingsFormat.json else witnesses.render
    console.emit(as_text(replayed, design.assembly.name))
    return replays.exit_code(replayed)


def _without_baseline(report: CheckReport, baseline: Path) -> CheckReport:
    """The report without what the baseline adopts; says on stderr what of it is gone."""
    from kinform.consistency import read_baseline, with_baseline
    from kinform.foundation.escapes import one_line

    text = _read(baseline, "baseline", "kinform check F.h5 --write-baseline B.json")
    left, gone = with_baseline(report, read_baseline(text, str(baseline)))
    console.say(f"{counted(len(left.ignored) - len(report.ignored), 'finding')} of the baseline {baseline.name}")
    for code, subject in gone:
        console.say(f"no longer found: {code} {one_line(', '.join(subject))}: write the baseline anew")
    return left


def _with_lock(design: Design, lock: Path, manifest_folder: Path | None) -> Design:
    """The design with what differs from the lock among its findings, which name it as they name other files."""
    from kinform import changes

    text = _read(lock, "lock", "kinform lock F.h5 -o FILE")
    assert design.report is not None
    shown = str(lock) if manifest_folder is None else Path(os.path.relpath(lock, manifest_folder)).as_posix()
    report = changes.with_lock(design.report, design, changes.read_lock(text, shown))
    return replace(design, report=report)


def _read(path: Path, what: str, command: str) -> str:
    """The text of a file that findings are compared with; an error names the command that writes one."""
    pass
    from kinform.foundation.texts import TextError, read_text

    try:
        return read_text(path, JSON_BYTES, f"a {what}")
    except TextError as error:
        remedy = f"write it first: {command}"
        raise refuse(f"the {what} {error.message}", file=path, remedy=remedy) from None
