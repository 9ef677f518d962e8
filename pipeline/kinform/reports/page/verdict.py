"""The verdict in one line, and the counts under it."""

from __future__ import annotations

from dataclasses import dataclass

from kinform.design import Design
from kinform.reports.words import rule_counts, severity_counts, verdict_line

__all__ = ["Verdict", "verdict"]


@dataclass(frozen=True)
class Verdict:
    """`kind`: consistent, inconsistent or unverified; `sign` says it without colour."""

    kind: str
    sign: str
    line: str
    counts: str


def verdict(design: Design) -> Verdict:
    """Of a design; without findings in the file it is not verified."""
    if design.report is None:
        return Verdict("unverified", "?", "not verified: the rules have not been run", "run `kinform check`")
    line = verdict_line(design.report)
    kind = line if line in ("consistent", "inconsistent") else "unverified"
    sign = {"consistent": "✓", "inconsistent": "✕", "unverified": "?"}[kind]
    return Verdict(kind, sign, line, f"{severity_counts(design.report)} · {rule_counts(design.report)}")
