"""What a rule may answer of a design."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from kinform.frozen import dataclass
from kinform.model.findings import Finding, OutcomeName


@dataclass(frozen=True)
class Outcome:
    """Answer of one rule.

    An inconclusive rule may carry findings too: about what it could decide, and notes that say what
    it could not.
    """

    kind: Literal["decided", "inconclusive", "skipped"]
    findings: tuple[Finding, ...] = ()
    reason: str = ""

    @property
    def name(self) -> OutcomeName:
        """passed, failed, inconclusive or skipped; notes alone do not fail a rule."""
        if self.kind != "decided":
            return self.kind
        return "failed" if any(f.severity != "note" for f in self.findings) else "passed"


def decided(findings: Iterable[Finding] = (), reason: str = "") -> Outcome:
    """The rule ran to its end; no finding of more than a note: passed."""
    return Outcome("decided", tuple(findings), reason)


def inconclusive(reason: str, findings: Iterable[Finding] = ()) -> Outcome:
    """Something that the rule is about could not be decided."""
    return Outcome("inconclusive", tuple(findings), reason)


def settled(findings: Iterable[Finding], doubt: str, reason: str = "") -> Outcome:
    """Inconclusive where there is a doubt, else decided, for this reason."""
    return inconclusive(doubt, findings) if doubt else decided(findings, reason)


def skipped(reason: str) -> Outcome:
    """The rule does not apply to this design."""
    return Outcome("skipped", (), reason)
