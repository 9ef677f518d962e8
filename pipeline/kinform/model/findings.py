"""Findings: what is inconsistent, where, by how much, and what to do."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["SEVERITIES", "CheckReport", "Finding", "Ignored", "RuleOutcome"]

SEVERITIES = ("note", "warning", "error")


@dataclass(frozen=True)
class Finding:
    """One inconsistency."""

    code: str
    rule: str
    """Name of the rule in words with hyphens: "joint-wrong-type"."""
    severity: str
    subject: tuple[str, ...]
    """Parts, joint or requirement, by name."""
    message: str
    found: str | None = None
    """With unit."""
    intended: str | None = None
    place: tuple[float, float, float] | None = None
    """m, world."""
    file: str | None = None
    line: int | None = None
    remedy: str | None = None


@dataclass(frozen=True)
class Ignored:
    """A finding that is accepted: by `[check]` in the manifest, with its reason, or by a baseline."""

    finding: Finding
    by: str
    """manifest or baseline."""
    reason: str = ""


@dataclass(frozen=True)
class RuleOutcome:
    """What became of one rule: passed, failed, inconclusive, skipped (does not apply, or not selected), or
    ignored (all that it found, or that it could not decide, is accepted)."""

    code: str
    rule: str
    outcome: str
    reason: str = ""


@dataclass(frozen=True)
class CheckReport:
    """All findings (sorted by code, subject), and all rules with their outcome (sorted by code)."""

    findings: tuple[Finding, ...]
    rules: tuple[RuleOutcome, ...]
    ignored: tuple[Ignored, ...] = ()
    """Findings that are accepted, in the order of findings; they decide nothing."""

    @property
    def ran(self) -> int:
        """How many rules were decided: passed, failed or inconclusive."""
        return sum(rule.outcome not in ("skipped", "ignored") for rule in self.rules)

    @property
    def inconclusive(self) -> int:
        """How many rules could not be decided."""
        return sum(rule.outcome == "inconclusive" for rule in self.rules)
