"""The end of `check` and `run`: findings on stdout, the verdict as exit code."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform_cli import console, files
from kinform_cli.errors import FINDINGS
from kinform_cli.options import FindingsFormat, Printed, Severity
from kinform_cli.text import command, ground_note

if TYPE_CHECKING:
    from kinform.api import Outcome
    from kinform.design import Design

NOTHING_REUSED = ("no earlier results", "earlier results of unknown origin")
"""How the account of a run begins that reused nothing. A warning has already named results of unknown origin."""


@dataclass(frozen=True)
class Gate:
    """How findings are printed, and which of them fail."""

    printed: Printed
    fail_on: Severity
    manifest_folder: Path | None = None
    """Formats that a repository's host reads name files as seen from here: this goes before them."""
    strict: bool = False
    """Whether the exit code is 2 also where the report leaves open what `Verdict.open` lists."""

    def judge_run(self, outcome: Outcome) -> int:
        """What a run says on its own account, then its findings; returns the exit code of the gate."""
        if self.printed.format is FindingsFormat.brief:  # which tells it in its own words
            return self.judge(outcome.gist, outcome)
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
        report, fail_on = design.report, self.fail_on.value
        assert report is not None
        if self.strict:
            report = replace(report, strict=True)
            design = replace(design, report=report)
        from kinform.consistency import verdict
        from kinform.model.findings import SEVERITIES

        run = None
        if outcome is not None:
            run = {"account": outcome.account, "reused": outcome.reused, "recomputed": outcome.recomputed}
            afresh = outcome.account.startswith(NOTHING_REUSED)
            brief = self.printed.format is FindingsFormat.brief
            for sentence in () if afresh or brief else outcome.recomputed:
                console.say(f"computed: {sentence}")
            console.say(None if afresh and brief else outcome.account)
        for format, path in self.printed.files:
            files.write_text(path, self._text(design, format, run))
        if self.printed.format in (FindingsFormat.full, FindingsFormat.brief) and console.decorated():
            from kinform_cli.views import findings

            console.out(findings.coloured(self._text(design, self.printed.format, run)))
        else:
            console.emit(self._text(design, self.printed.format, run))
        code = verdict(report, fail_on)
        if code == FINDINGS and self.fail_on is not Severity.error:
            failing = SEVERITIES[SEVERITIES.index(fail_on) :]
            many = sum(finding.severity in failing for finding in report.findings)
            console.say(f"{counted(many, 'finding')} at or above {fail_on}")
        return code

    def _text(self, design: Design, format: FindingsFormat, run: Mapping[str, Any] | None) -> str:
        """The findings in that format."""
        from kinform import reports

        if self.manifest_folder is not None and format in (FindingsFormat.sarif, FindingsFormat.github):
            from kinform.reports.from_here import seen_from_here

            design = seen_from_here(design, self.manifest_folder)
        assert design.report is not None
        return reports.render(
            design.report, design, format.value, fail_on=self.fail_on.value, run=run, width=console.columns()
        )


def say_next(results: Path) -> None:
    """Say by which commands more of these results is shown."""
    page = command("kinform", "report", results, "-o", results.with_suffix(".html"))
    console.say(f"next: {page}   (one page to look at)")
    console.say(f"  or: {command('kinform', 'show', results)}")
