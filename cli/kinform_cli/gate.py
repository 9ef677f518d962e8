"""The end of `check` and `run`: findings on stdout, the verdict as exit code."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from kinform.foundation.words import counted
from kinform_cli import console
from kinform_cli.errors import FINDINGS
from kinform_cli.options import FindingsFormat, Severity
from kinform_cli.text import ground_note

if TYPE_CHECKING:
    from kinform.api import Outcome
    from kinform.design import Design
    from kinform.model.findings import Finding


@dataclass(frozen=True)
class Gate:
    """How findings are printed, and which of them fail."""

    format: FindingsFormat
    fail_on: Severity
    manifest_folder: Path | None = None
    """Formats that a repository's host reads name files as seen from here: this goes before them."""

    def judge_run(self, outcome: Outcome) -> int:
        """What a run says on its own account, then its findings; returns the exit code of the gate."""
        assembly = outcome.gist.assembly
        if not assembly.function.stated:
            console.say("note: no [function] is stated: nothing is compared with what the design is for")
        for note in assembly.notes:
            console.say(f"note: {note}")
        console.say(ground_note(outcome.gist))
        return self.judge(outcome.gist, outcome)

    def judge(self, design: Design, outcome: Outcome | None = None) -> int:
        """Print the findings of a design that was checked; returns the exit code of the gate.

        Of a run, `outcome` says what was computed and why: lines on stderr, and part of the JSON.
        """
        if self.manifest_folder is not None and self.format in (FindingsFormat.sarif, FindingsFormat.github):
            design = _seen_from_here(design, self.manifest_folder)
        report, fail_on = design.report, self.fail_on.value
        assert report is not None
        from kinform import reports
        from kinform.model.findings import SEVERITIES, verdict

        run = None
        if outcome is not None:
            run = {"account": outcome.account, "reused": outcome.reused, "recomputed": outcome.recomputed}
            afresh = outcome.account.startswith("no earlier results")
            for sentence in () if afresh else outcome.recomputed:
                console.say(f"computed: {sentence}")
            console.say(outcome.account)
        if self.format is FindingsFormat.full and console.decorated():
            from kinform_cli.views import findings

            console.out(findings.render(design, fail_on))
        else:
            console.emit(reports.render(report, design, self.format.value, fail_on=fail_on, run=run))
        code = verdict(report, fail_on)
        if code == FINDINGS and self.fail_on is not Severity.error:
            failing = SEVERITIES[SEVERITIES.index(fail_on) :]
            many = sum(finding.severity in failing for finding in report.findings)
            console.say(f"{counted(many, 'finding')} at or above {fail_on}")
        return code


def _seen_from_here(design: Design, folder: Path) -> Design:
    """The design with every file of its findings named from the present folder."""
    report, assembly = design.report, design.assembly
    assert report is not None

    def place(file: str) -> str:
        return Path(os.path.relpath(folder / file)).as_posix()

    def from_here(finding: Finding) -> Finding:
        return finding if finding.file is None else replace(finding, file=place(finding.file))

    if assembly.source.file:
        assembly = replace(assembly, source=replace(assembly.source, file=place(assembly.source.file)))
    report = replace(report, findings=tuple(map(from_here, report.findings)))
    return replace(design, assembly=assembly, report=report)
