"""Workflow commands of GitHub Actions: an annotation a finding, at its line of the manifest.

No line begins with text that a user chose: a part cannot be named so that it becomes a command.
"""

from __future__ import annotations

from kinform.consistency import verdict_of
from kinform.design import Design
from kinform.foundation import escapes
from kinform.foundation.escapes import one_line
from kinform.model.findings import CheckReport, Finding, RuleOutcome
from kinform.reports.constants import QUIET_NOTES
from kinform.reports.phrases import details, rule_counts, severity_counts

_COMMANDS = {"error": "error", "warning": "warning", "note": "notice"}


def render(report: CheckReport, design: Design, fail_on: str = "error") -> str:
    """Annotations of findings, then of rules that could not decide, then a line with the verdict for the log."""
    manifest = design.assembly.source.file
    told = [f for f in report.findings if f.severity != "note" or f.code not in QUIET_NOTES]
    lines = [_finding(finding, manifest, design.assembly.units) for finding in told]
    lines += [_undecided(rule, manifest) for rule in report.rules if rule.outcome == "inconclusive"]
    verdict = verdict_of(report, fail_on)
    last = (verdict.line, verdict.coverage, severity_counts(report), rule_counts(report), design.assembly.name)
    lines.append(escapes.lines("; ".join(one_line(text) for text in last if text)))
    return "\n".join(lines) + "\n"


def _finding(finding: Finding, manifest: str, units: str) -> str:
    title = f"{finding.code} {finding.rule}: {', '.join(map(one_line, finding.subject))}"
    text = "\n".join([finding.message, *(f"{key}: {value}" for key, value in details(finding, units).items())])
    return command(_COMMANDS[finding.severity], finding.file or manifest, finding.line, title, text)


def _undecided(rule: RuleOutcome, manifest: str) -> str:
    return command("warning", manifest, None, f"{rule.code} {rule.rule}: could not decide", rule.reason)


def command(name: str, file: str, line: int | None, title: str, text: str) -> str:
    """One workflow command, with its place."""
    properties = {"file": file, "line": None if line is None else str(line), "title": title}
    stated = ",".join(f"{key}={_property(value)}" for key, value in properties.items() if value)
    return f"::{name} {stated}::{_data(text)}"


def _data(text: str) -> str:
    """As the runner decodes it; other control characters, and what some runners obey within a line, are escaped as in
    Python."""
    return escapes.lines(_encoded(text))


def _property(text: str) -> str:
    return escapes.lines(_encoded(text).replace(":", "%3A").replace(",", "%2C"))


def _encoded(text: str) -> str:
    return "%0A".join(one_line(line).replace("%", "%25") for line in text.split("\n"))
