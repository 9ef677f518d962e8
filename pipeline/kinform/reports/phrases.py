"""What several renderers say of findings in the same words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from kinform.foundation import words
from kinform.foundation.escapes import one_line
from kinform.foundation.words import counted
from kinform.model.findings import SEVERITIES, CheckReport, Finding


def where(finding: Finding) -> str:
    """ "m.toml:12", or "" when the finding has no place in a file."""
    if finding.file is None:
        return ""
    return finding.file if finding.line is None else f"{finding.file}:{finding.line}"


def place(finding: Finding, units: str) -> str | None:
    """ "(1, 0, -20) mm", in the unit in which messages show lengths of an assembly of these units; or None."""
    return None if finding.place is None else words.place(finding.place, units)


def details(finding: Finding, units: str) -> dict[str, str]:
    """Found, intended, place and remedy, as far as they are known, by these names; lengths in units of the assembly."""
    facts = {
        "found": finding.found, "intended": finding.intended, "place": place(finding, units), "remedy": finding.remedy,
    }  # fmt: skip
    return {key: value for key, value in facts.items() if value}


def accepted(report: CheckReport) -> list[str]:
    """Of every finding that is accepted, and of every rule all of whose doubts are, a line that says by whom and
    why."""
    findings = [
        f"{item.finding.code} {item.finding.rule}: {', '.join(map(one_line, item.finding.subject))}: "
        f"{one_line(item.reason) if item.reason else 'adopted'} (by the {item.by})"
        for item in report.ignored
    ]
    codes = {item.finding.code for item in report.ignored}
    return findings + [
        f"{rule.code} {rule.rule}: {one_line(rule.reason)}"
        for rule in report.rules
        if rule.outcome == "ignored" and rule.code not in codes
    ]


def skipped(report: CheckReport) -> list[str]:
    """Each reason for which rules were skipped, with their codes."""
    by_reason: dict[str, list[str]] = {}
    for rule in report.rules:
        if rule.outcome == "skipped":
            by_reason.setdefault(one_line(rule.reason), []).append(rule.code)
    return [f"{reason}: {', '.join(codes)}" for reason, codes in by_reason.items()]


def severity_counts(report: CheckReport) -> str:
    """ "1 error, 2 warnings, 0 notes"."""
    counts = Counter(finding.severity for finding in report.findings)
    return ", ".join(counted(counts[severity], severity) for severity in reversed(SEVERITIES))


def rule_counts(report: CheckReport) -> str:
    """ "30 rules ran, 8 skipped, 1 inconclusive"."""
    skipped = sum(rule.outcome == "skipped" for rule in report.rules)
    ignored = f", {counted(len(report.ignored), 'finding')} ignored" if report.ignored else ""
    selected = f" ({len(report.unselected)} by select)" if report.unselected else ""
    ran = counted(report.ran, "rule")
    return f"{ran} ran, {skipped} skipped{selected}, {report.inconclusive} inconclusive{ignored}"


def answers_line(counts: Sequence[tuple[str, int]]) -> str:
    """ "5 agree, 1 not held, 2 undecided (25 %)": how many are undecided is told in any case."""
    told = dict(counts)
    every = sum(told.values())
    undecided = told.pop("undecided", 0)
    words = [f"{count} {'agree' if answer == 'agrees' else answer}" for answer, count in told.items()]
    share = f"{undecided} undecided ({100.0 * undecided / every:.0f} %)" if undecided else "none undecided"
    return ", ".join([*words, share])
