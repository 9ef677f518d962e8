"""`/findings`: what is inconsistent, and what became of each rule."""

from __future__ import annotations

from typing import Any

import h5py

from kinform.model.findings import CheckReport, Finding, Ignored, RuleOutcome
from kinform.results.table import integer, pair, read_records, read_rows, real, text, texts, write_records, write_rows

__all__ = ["read", "write"]

_FINDINGS = (
    text("code"), text("rule"), text("severity"), texts("subject"), text("message"), text("found"),
    text("intended"), pair("place", real, ("x", "y", "z"), "m"), text("file"), integer("line", optional=True),
    text("remedy"),
)  # fmt: skip
_IGNORED = (*_FINDINGS, text("by"), text("reason"))
_GONE = (text("code"), texts("subject"))
_RULES = (text("code"), text("rule"), text("outcome"), text("reason"))


def write(group: h5py.Group, report: CheckReport) -> None:
    """Write findings and rules."""
    write_records(group, "findings", _FINDINGS, report.findings)
    write_records(group, "rules", _RULES, report.rules)
    accepted = [vars(item.finding) | {"by": item.by, "reason": item.reason} for item in report.ignored]
    write_rows(group, "ignored", _IGNORED, accepted)
    if report.gone is not None:
        write_rows(group, "gone", _GONE, [{"code": code, "subject": subject} for code, subject in report.gone])


def read(group: h5py.Group) -> CheckReport:
    """The report that `write` wrote."""
    return CheckReport(
        findings=read_records(group, "findings", _FINDINGS, Finding),
        rules=read_records(group, "rules", _RULES, RuleOutcome),
        ignored=tuple(map(_ignored, read_rows(group, "ignored", _IGNORED))) if "ignored" in group else (),
        gone=tuple((row["code"], row["subject"]) for row in read_rows(group, "gone", _GONE))
        if "gone" in group
        else None,
    )


def _ignored(row: dict[str, Any]) -> Ignored:
    by, reason = row.pop("by"), row.pop("reason")
    return Ignored(Finding(**row), by, reason)
