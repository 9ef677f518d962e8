"""`/findings`: what is inconsistent, and what became of each rule."""

from __future__ import annotations

import h5py

from kinform.model.findings import CheckReport, Finding, RuleOutcome
from kinform.results._table import integer, pair, read_records, real, text, texts, write_records

__all__ = ["read", "write"]

_FINDINGS = (
    text("code"), text("rule"), text("severity"), texts("subject"), text("message"), text("found"),
    text("intended"), pair("place", real, ("x", "y", "z"), "m"), text("file"), integer("line", optional=True),
    text("remedy"),
)  # fmt: skip
_RULES = (text("code"), text("rule"), text("outcome"), text("reason"))


def write(group: h5py.Group, report: CheckReport) -> None:
    """Write findings and rules."""
    write_records(group, "findings", _FINDINGS, report.findings)
    write_records(group, "rules", _RULES, report.rules)


def read(group: h5py.Group) -> CheckReport:
    """The report that `write` wrote."""
    return CheckReport(
        findings=read_records(group, "findings", _FINDINGS, Finding),
        rules=read_records(group, "rules", _RULES, RuleOutcome),
    )
