"""Runs every rule on a design."""

from __future__ import annotations

from kinform.consistency._context import Context
from kinform.consistency.rules import RULES
from kinform.model.design import Design
from kinform.model.findings import CheckReport, Finding, RuleOutcome, verdict

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


def _order(finding: Finding) -> tuple[object, ...]:
    place = finding.place or (0.0, 0.0, 0.0)
    return (finding.code, finding.subject, finding.message, place, finding.file or "", finding.line or 0)
