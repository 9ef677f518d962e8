"""The end of `check` and `run`: findings on stdout, the verdict as exit code."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from kinform_cli import console
from kinform_cli.choices import FindingsFormat, Severity
from kinform_cli.errors import FINDINGS
from kinform_cli.text import count

if TYPE_CHECKING:
    from kinform.api import Outcome
    from kinform.design import Design
    from kinform.model.findings import Finding

__all__ = ["conclude", "show", "show_run"]


def conclude(
    design: Design,
    format: FindingsFormat,
    fail_on: Severity,
    manifest_folder: Path | None = None,
    outcome: Outcome | None = None,
) -> NoReturn:
    """Print the findings of a design that was checked, and leave with the exit code of the gate; see `show`."""
    import typer

    raise typer.Exit(show(design, format, fail_on, manifest_folder, outcome))


def show_run(outcome: Outcome, format: FindingsFormat, fail_on: Severity, manifest_folder: Path | None) -> int:
    """What a run says on its own account, then its findings; returns the exit code of the gate."""
    design = outcome.gist
    if not design.assembly.function.stated:
        console.say("note: no [function] is stated: nothing is compared with what the design is for")
    for note in design.assembly.notes:
        console.say(f"note: {note}")
    from kinform_cli.notes import ground_note

    console.say(ground_note(design))
    return show(design, format, fail_on, manifest_folder, outcome)


def show(
    design: Design,
    format: FindingsFormat,
    fail_on: Severity,
    manifest_folder: Path | None = None,
    outcome: Outcome | None = None,
) -> int:
    """Print the findings of a design that was checked; returns the exit code of the gate.

    Formats that a repository's host reads name files as seen from here: `manifest_folder` goes before them.
    Of a run, `outcome` says what was computed and why: lines on stderr, and part of the JSON.
    """
    if manifest_folder is not None and format in (FindingsFormat.sarif, FindingsFormat.github):
        design = _seen_from_here(design, manifest_folder)
    from kinform import reports
    from kinform.model.findings import SEVERITIES, verdict

    run = None
    if outcome is not None:
        run = {"account": outcome.account, "reused": outcome.reused, "recomputed": outcome.recomputed}
        afresh = outcome.account.startswith("no earlier results")
        for sentence in () if afresh else outcome.recomputed:
            console.say(f"computed: {sentence}")
        console.say(outcome.account)
    report = design.report
    assert report is not None
    if format is FindingsFormat.full:
        from kinform_cli.views import findings

        console.out(findings.render(design, fail_on.value))
    else:
        console.emit(reports.render(report, design, format.value, fail_on=fail_on.value, run=run))
    code = verdict(report, fail_on.value)
    if code == FINDINGS and fail_on is not Severity.error:
        counted = SEVERITIES[SEVERITIES.index(fail_on.value) :]
        many = sum(finding.severity in counted for finding in report.findings)
        console.say(f"{count(many, 'finding')} at or above {fail_on.value}")
    return code


def _seen_from_here(design: Design, folder: Path) -> Design:
    """The design with every file of its findings named from the present folder."""
    report, assembly = design.report, design.assembly
    assert report is not None

    def place(file: str) -> str:
        return Path(os.path.relpath(folder / file)).as_posix()

    def moved(finding: Finding) -> Finding:
        return finding if finding.file is None else dataclasses.replace(finding, file=place(finding.file))

    if assembly.source.file:
        source = dataclasses.replace(assembly.source, file=place(assembly.source.file))
        assembly = dataclasses.replace(assembly, source=source)
    report = dataclasses.replace(report, findings=tuple(map(moved, report.findings)))
    return dataclasses.replace(design, assembly=assembly, report=report)
