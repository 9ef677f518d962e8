"""The end of `check` and `run`: findings on stdout, the verdict as exit code."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

import typer

from kinform_cli import console
from kinform_cli.errors import FINDINGS
from kinform_cli.options import FindingsFormat, Severity
from kinform_cli.text import count

if TYPE_CHECKING:
    from kinform.model.design import Design

__all__ = ["conclude"]


def conclude(design: Design, format: FindingsFormat, fail_on: Severity) -> NoReturn:
    """Print the findings of a design that was checked, and leave with the exit code of the gate."""
    from kinform import reports
    from kinform.consistency import verdict
    from kinform.model.findings import SEVERITIES

    report = design.report
    assert report is not None
    if format is FindingsFormat.full:
        from kinform_cli.views import findings

        console.out(findings.render(design))
    else:
        console.emit(reports.render(report, design, format.value))
    code = verdict(report, fail_on.value)
    if code == FINDINGS and fail_on is not Severity.error:
        counted = SEVERITIES[SEVERITIES.index(fail_on.value) :]
        many = sum(finding.severity in counted for finding in report.findings)
        console.say(f"{count(many, 'finding')} at or above {fail_on.value}")
    raise typer.Exit(code)
