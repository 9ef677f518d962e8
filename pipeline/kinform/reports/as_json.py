"""For programs: findings and rules as JSON, lengths in metres."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from typing import Any

from kinform.design import Design
from kinform.foundation.escapes import json_text
from kinform.model.findings import SEVERITIES, CheckReport
from kinform.reports.phrases import verdict_word

SCHEMA = "kinform/findings/1"


def render(report: CheckReport, design: Design, fail_on: str = "error", run: Mapping[str, Any] | None = None) -> str:
    """The document as text; with the account of a `run`, where it was one."""
    whole = document(report, design, fail_on) | ({} if run is None else {"run": dict(run)})
    return json_text(json.dumps(whole, indent=1, ensure_ascii=False)) + "\n"


def of_design(design: Design) -> dict[str, Any]:
    """The object for the findings of a design that has been checked."""
    assert design.report is not None
    return document(design.report, design)


def document(report: CheckReport, design: Design, fail_on: str = "error") -> dict[str, Any]:
    """An object with the schema, the verdict, counts, findings, those that are accepted, and rules."""
    counts = {s: sum(f.severity == s for f in report.findings) for s in reversed(SEVERITIES)}
    outcomes = ("passed", "failed", "inconclusive", "skipped", "ignored")
    return {
        "schema": SCHEMA,
        "assembly": design.assembly.name,
        "verdict": verdict_word(report, fail_on),
        **({} if report.origin == "recorded" else {"origin": "unknown"}),
        "counts": counts | {o: sum(r.outcome == o for r in report.rules) for o in outcomes},
        "findings": [
            dataclasses.asdict(f)
            | {"members": [] if f.cause is None else [dataclasses.asdict(m) for m in report.members_of(f)]}
            for f in report.findings
        ],
        "ignored": [
            dataclasses.asdict(item.finding) | {"ignored_by": item.by, "reason": item.reason} for item in report.ignored
        ],
        "unselected": list(report.unselected),
        "rules": [dataclasses.asdict(r) for r in report.rules],
    }
