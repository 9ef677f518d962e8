"""What several renderers say in the same words."""

from __future__ import annotations

from collections import Counter

from kinform.model.findings import SEVERITIES, CheckReport, Finding

__all__ = ["counted", "one_line", "rule_counts", "severity_counts", "verdict_line", "where"]


def counted(number: int, noun: str) -> str:
    """ "1 error", "2 errors"."""
    return f"{number} {noun}" + ("" if number == 1 else "s")


def one_line(text: str) -> str:
    """The text with control characters escaped, so that it stays on one line."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def where(finding: Finding) -> str:
    """ "m.toml:12", or "" when the finding has no place in a file."""
    if finding.file is None:
        return ""
    return finding.file if finding.line is None else f"{finding.file}:{finding.line}"


def severity_counts(report: CheckReport) -> str:
    """ "1 error, 2 warnings, 0 notes"."""
    found = Counter(finding.severity for finding in report.findings)
    return ", ".join(counted(found[severity], severity) for severity in reversed(SEVERITIES))


def rule_counts(report: CheckReport) -> str:
    """ "30 rules ran, 8 skipped, 1 inconclusive"."""
    skipped = sum(rule.outcome == "skipped" for rule in report.rules)
    ignored = f", {counted(len(report.ignored), 'finding')} ignored" if report.ignored else ""
    return f"{counted(report.ran, 'rule')} ran, {skipped} skipped, {report.inconclusive} inconclusive{ignored}"


def verdict_line(report: CheckReport) -> str:
    """The verdict in one line; silence is never a pass."""
    if any(finding.severity == "error" for finding in report.findings):
        return "inconsistent"
    if report.ran == 0:
        return "not verified: no rule ran"
    if report.inconclusive:
        return "not verified: " + counted(report.inconclusive, "rule") + " could not decide"
    return "consistent"
