"""For programs: findings and rules as JSON, lengths in metres."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from typing import Any

from kinform.consistency import verdict_of
from kinform.design import Design
from kinform.foundation.escapes import json_text
from kinform.model.findings import SEVERITIES, CheckReport, Finding

SCHEMA = "kinform/findings/1"


def render(report: CheckReport, design: Design, fail_on: str = "error", run: Mapping[str, Any] | None = None) -> str:
    """The document as text; with the account of a `run`, where it was one."""
    whole = document(report, design, fail_on) | ({} if run is None else {"run": dict(run)})
    return json_text(json.dumps(whole, indent=1, ensure_ascii=False)) + "\n"


def _finding(finding: Finding) -> dict[str, Any]:
    """All of its fields; of its witness those that its class has."""
    fields = dataclasses.asdict(finding)
    if finding.witness is not None:
        fields["witness"] = {key: value for key, value in fields["witness"].items() if value is not None}
    return fields


def _members(report: CheckReport, finding: Finding) -> list[dict[str, Any]]:
    """What a finding stands for; empty where it states no cause."""
    return [] if finding.cause is None else [_finding(one) for one in report.members_of(finding)]


def of_design(design: Design) -> dict[str, Any]:
    """The object for the findings of a design that has been checked."""
    assert design.report is not None
    return document(design.report, design)


def document(report: CheckReport, design: Design, fail_on: str = "error") -> dict[str, Any]:
    """An object with the schema, the verdict, counts, findings, those that are accepted, and rules."""
    verdict = verdict_of(report, fail_on)
    counts = {s: sum(f.severity == s for f in report.findings) for s in reversed(SEVERITIES)}
    outcomes = ("passed", "failed", "inconclusive", "skipped", "ignored")
    return {
        "schema": SCHEMA,
        "assembly": design.assembly.name,
        "verdict": verdict.word,
        "verdict_line": verdict.line,
        "exit_code": verdict.code,
        **({} if report.origin == "recorded" else {"origin": "unknown"}),
        "counts": counts | {o: sum(r.outcome == o for r in report.rules) for o in outcomes},
        "findings": [_finding(f) | {"members": _members(report, f)} for f in report.findings],
        "ignored": [_finding(item.finding) | {"ignored_by": item.by, "reason": item.reason} for item in report.ignored],
        "unselected": list(report.unselected),
        "rules": [dataclasses.asdict(r) for r in report.rules],
        "statements": [dataclasses.asdict(s) for s in report.statements],
        "coverage": {"line": verdict.coverage, "open": list(verdict.open)}
        | ({} if report.coverage is None else dataclasses.asdict(report.coverage)),
    }
