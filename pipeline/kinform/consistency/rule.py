"""What a rule is, and what it may answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from kinform.model.findings import SEVERITIES, Finding

if TYPE_CHECKING:
    from kinform.consistency.context import Context

__all__ = ["Declared", "Outcome", "Rule", "decided", "inconclusive", "skipped"]


class Declared(Protocol):
    """Anything that knows where the manifest declares it."""

    @property
    def file(self) -> str | None: ...
    @property
    def line(self) -> int | None: ...


@dataclass(frozen=True)
class Outcome:
    """Answer of one rule: `kind` is decided, inconclusive or skipped.

    An inconclusive rule may carry findings too: about what it could decide, and notes that say what
    it could not.
    """

    kind: str
    findings: tuple[Finding, ...] = ()
    reason: str = ""

    @property
    def name(self) -> str:
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


def skipped(reason: str) -> Outcome:
    """The rule does not apply to this design."""
    return Outcome("skipped", (), reason)


@dataclass(frozen=True)
class Rule:
    """One rule: its code, a name that says what is wrong, its severity, its documentation, its check."""

    code: str
    name: str
    severity: str
    """Of its findings, where nothing speaks for another."""
    documentation: str | None
    """Docstring of the rule's module: what is checked, why it matters, what to do, an example."""
    check: Callable[[Context], Outcome]

    def finding(
        self,
        subject: Sequence[str],
        message: str,
        *,
        severity: str | None = None,
        found: str | None = None,
        intended: str | None = None,
        place: Iterable[float] | None = None,
        declared: Declared | None = None,
        line: int | None = None,
        remedy: str | None = None,
    ) -> Finding:
        """A finding of this rule; `place` (3,) m in the world, left out unless finite."""
        level = severity or self.severity
        if level not in SEVERITIES:
            raise ValueError(f"unknown severity {level!r}: expected one of {', '.join(SEVERITIES)}")
        return Finding(
            code=self.code,
            rule=self.name,
            severity=level,
            subject=tuple(subject),
            message=message,
            found=found,
            intended=intended,
            place=_finite(place),
            file=declared.file if declared is not None else None,
            line=line if line is not None else declared.line if declared is not None else None,
            remedy=remedy,
        )


def _finite(place: Iterable[float] | None) -> tuple[float, float, float] | None:
    if place is None:
        return None
    x, y, z = (float(value) for value in place)
    return (x, y, z) if all(math.isfinite(value) for value in (x, y, z)) else None
