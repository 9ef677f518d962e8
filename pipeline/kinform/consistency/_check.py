"""Runs every rule on a design, and turns a report into an exit code."""

from __future__ import annotations

from kinform.consistency._context import Context
from kinform.consistency.rules import RULES
from kinform.model.design import Design
from kinform.model.findings import SEVERITIES, CheckReport, Finding, RuleOutcome

__all__ = ["check", "verdict"]


def check(design: Design) -> CheckReport:
    """Findings (sorted by code, subject, message) and the outcome of every rule, of what is known so far.

    Stages that a rule needs and that have not been run leave the rule inconclusive, never passed.
    """
    context = Context(design)
    outcomes = [(rule, rule.check(context)) for rule in RULES]
    findings = [finding for _, outcome in outcomes for finding in outcome.findings]
    return CheckReport(
        findings=tuple(sorted(findings, key=_order)),
        rules=tuple(RuleOutcome(rule.code, rule.name, out.name, out.reason) for rule, out in outcomes),
    )


def verdict(report: CheckReport, fail_on: str = "error") -> int:
    """Exit code of the gate: 0 verified, 1 findings at or above `fail_on`, 2 not verified.

    Not verified: no rule ran, or one was inconclusive. Where 1 and 2 both apply, 1. `fail_on`: note,
    warning or error; ValueError otherwise.
    """
    if fail_on not in SEVERITIES:
        raise ValueError(f"unknown severity {fail_on!r}: expected one of {', '.join(SEVERITIES)}")
    level = SEVERITIES.index(fail_on)
    if any(SEVERITIES.index(finding.severity) >= level for finding in report.findings):
        return 1
    return 2 if report.ran == 0 or report.inconclusive else 0


def _order(finding: Finding) -> tuple[object, ...]:
    place = finding.place or (0.0, 0.0, 0.0)
    return (finding.code, finding.subject, finding.message, place, finding.file or "", finding.line or 0)
