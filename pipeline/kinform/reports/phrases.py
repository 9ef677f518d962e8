"""What several renderers say of findings and verdicts in the same words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from kinform.foundation import words
from kinform.foundation.escapes import one_line
from kinform.foundation.words import counted, few
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


def verdict_line(report: CheckReport, fail_on: str = "error") -> str:
    """The verdict in one line, by the least severity that fails; silence is never a pass."""
    return _with_origin(verdict_word(report, fail_on), report)


def verdict_word(report: CheckReport, fail_on: str = "error") -> str:
    """As verdict_line, without where results come from that do not decide the verdict: for programs."""
    if any(finding.severity in SEVERITIES[SEVERITIES.index(fail_on) :] for finding in report.findings):
        return "inconsistent"
    if report.ran == 0:
        return "not verified: no rule ran"
    if report.inconclusive:
        return "not verified: " + counted(report.inconclusive, "rule") + " could not decide"
    return f"not verified: {UNKNOWN}" if report.origin == "refused" else "consistent"


def _with_origin(verdict: str, report: CheckReport) -> str:
    """The verdict, which says where it rests on results of unknown origin."""
    return verdict if report.origin == "recorded" or UNKNOWN in verdict else f"{verdict} ({UNKNOWN})"


def verdict_told(report: CheckReport, stated: bool, fail_on: str = "error") -> str:
    """The verdict for people: what was compared, and what is wrong with what. "inconsistent" is a design that does not
    do what is stated; where only meshes or contacts are faulty, or no function is `stated`, that is said."""
    told = _told(report, stated, fail_on)
    left_out = report.unselected
    told += f"; {counted(len(left_out), 'rule')} left out by select: {few(left_out)}" if left_out else ""
    return _with_origin(told, report)


def _told(report: CheckReport, stated: bool, fail_on: str) -> str:
    """The verdict, whatever rules were selected and whoever wrote the results."""
    line = verdict_word(report, fail_on)
    if line != "inconsistent":
        return line if stated or report.ran == 0 else f"{line}; {GEOMETRY_ONLY}"
    level = SEVERITIES.index(fail_on)
    failing = [finding for finding in report.findings if SEVERITIES.index(finding.severity) >= level]
    groups = {subject: _severities(failing, subject) for subject in dict.fromkeys(FAMILIES.values())}
    told = [f"{subject}: {counts}" for subject, counts in groups.items() if counts]
    return "; ".join([_compared(report, stated, failing), *told])


def _compared(report: CheckReport, stated: bool, failing: Sequence[Finding]) -> str:
    """What came of the comparison with the function."""
    if not all(finding.code.startswith(FORM) for finding in failing):
        return "inconsistent"
    if not stated:
        return GEOMETRY_ONLY
    agreeing = dict(report.answers).get("agrees", 0)
    if not agreeing or len(report.answers) > 1:
        return "inconsistent"
    return f"all {agreeing} intended joints agree" if agreeing > 1 else "the intended joint agrees"


def _severities(findings: Sequence[Finding], subject: str) -> str:
    """ "1 error, 2 warnings": of the findings about this."""
    counts = Counter(finding.severity for finding in findings if _family(finding.code) == subject)
    return ", ".join(counted(counts[severity], severity) for severity in reversed(SEVERITIES) if counts[severity])


def _family(code: str) -> str:
    return next((subject for start, subject in FAMILIES.items() if code.startswith(start)), "other")


UNKNOWN = "results of unknown origin"
"""Of results that this user's kinform neither computed nor recorded."""

GEOMETRY_ONLY = "no function stated: geometry only"

FORM = ("KF10", "KF11", "KF2")
"""Rules about meshes and contacts, by how their codes begin."""

FAMILIES = {
    "KF44": "settings", "KF45": "lock", "KF42": "requirements", "KF43": "requirements", "KF4": "function",
    "KF3": "mobility", "KF5": "motion", "KF12": "masses", "KF13": "description", "KF2": "contacts", "KF1": "meshes",
    "": "other",
}  # fmt: skip
"""What rules are about, by how their codes begin, the first that fits."""


def answers_line(counts: Sequence[tuple[str, int]]) -> str:
    """ "5 agree, 1 not held, 2 undecided (25 %)": how many are undecided is told in any case."""
    told = dict(counts)
    every = sum(told.values())
    undecided = told.pop("undecided", 0)
    words = [f"{count} {'agree' if answer == 'agrees' else answer}" for answer, count in told.items()]
    share = f"{undecided} undecided ({100.0 * undecided / every:.0f} %)" if undecided else "none undecided"
    return ", ".join([*words, share])
