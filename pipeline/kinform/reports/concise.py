"""One line a finding, as compilers print them: `file:line: severity CODE subject: message`."""

from __future__ import annotations

from kinform.consistency import verdict_of
from kinform.design import Design
from kinform.foundation.escapes import one_line
from kinform.model.findings import CheckReport
from kinform.reports.constants import QUIET_NOTES
from kinform.reports.phrases import rule_counts, severity_counts, where


def render(report: CheckReport, design: Design, fail_on: str = "error") -> str:
    """Findings by code, then rules that could not decide, then a line of summary, and one of coverage."""
    file = one_line(design.assembly.source.file)
    lines = [
        f"{one_line(where(f)) or file}: {f.severity} {f.code} "
        f"{', '.join(one_line(s) for s in f.subject)}: {one_line(f.message)}"
        for f in report.findings
        if f.severity != "note" or f.code not in QUIET_NOTES
    ]
    lines += [
        f"{file}: inconclusive {r.code} {r.rule}: {one_line(r.reason)}"
        for r in report.rules
        if r.outcome == "inconclusive"
    ]
    verdict, name = verdict_of(report, fail_on), one_line(design.assembly.name)
    lines.append(f"{name}: {one_line(verdict.line)}; {severity_counts(report)}; {rule_counts(report)}")
    lines += [f"{name}: {one_line(verdict.coverage)}"] if verdict.coverage else []
    return "\n".join(lines) + "\n"
