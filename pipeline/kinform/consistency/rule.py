"""What a rule is: what it is called, what it needs, how it decides."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Literal, Protocol

from kinform.consistency.context import Context, Need
from kinform.consistency.outcome import Outcome, decided
from kinform.frozen import dataclass
from kinform.model.findings import SEVERITIES, Finding, Severity, Witness, severity_of
from kinform.requirements.answer import triple

Findings = Iterable[Finding]
"""What is wrong; a check that gives no more than this has decided."""
Stability = Literal["stable", "preview"]
"""Findings of a stable rule change with a major version only; those of a rule in preview may change with any."""


class Declared(Protocol):
    """Anything that knows where the manifest declares it."""

    @property
    def file(self) -> str | None: ...
    @property
    def line(self) -> int | None: ...


@dataclass(frozen=True)
class Rule:
    """One rule: its code, a name that says what is wrong, its severity, its documentation, its check."""

    code: str
    name: str
    severity: Severity
    """Of its findings, where nothing speaks for another."""
    documentation: str | None
    """Docstring of the rule's module: what is checked, why it matters, what to do, an example."""
    check: Callable[[Context], Outcome | Findings]
    """Findings, or more that is to be said; runs where everything in `needs` is there."""
    needs: tuple[Need, ...] = ()
    """What the check reads, in the order in which it is asked for: the first that is not there is the outcome."""
    speaks_for: tuple[str, ...] = ()
    """Codes of rules that leave it to this one to say what they could not decide: where one of them is selected, so
    is this."""
    stability: Stability = "stable"
    also: tuple[Severity, ...] = ()
    """Other severities that its findings have, by their consequence."""

    @property
    def severities(self) -> str:
        """All of them in words, the worst first: "error, warning or note"."""
        every = sorted({self.severity, *self.also}, key=SEVERITIES.index, reverse=True)
        return " or ".join(filter(None, (", ".join(every[:-1]), every[-1])))

    def outcome(self, context: Context) -> Outcome:
        """What the rule says of a design: why something that it needs is not there, else what its check says."""
        for need in self.needs:
            lacking = context.lacks(need)
            if lacking is not None:
                return lacking
        answer = self.check(context)
        return answer if isinstance(answer, Outcome) else decided(answer)

    def at(self, severity: str) -> Rule:
        """The rule with findings of another severity."""
        return replace(self, severity=severity_of(severity))

    def finding(
        self,
        subject: Sequence[str],
        message: str,
        *,
        found: str | None = None,
        intended: str | None = None,
        place: Iterable[float] | None = None,
        declared: Declared | None = None,
        remedy: str | None = None,
        witness: Witness | None = None,
    ) -> Finding:
        """A finding of this rule; `place` (3,) m in the world, left out unless finite."""
        return Finding(
            code=self.code,
            rule=self.name,
            severity=self.severity,
            subject=tuple(subject),
            message=message,
            found=found,
            intended=intended,
            place=_finite(place),
            file=None if declared is None else declared.file,
            line=None if declared is None else declared.line,
            remedy=remedy,
            witness=witness,
        )


def _finite(place: Iterable[float] | None) -> tuple[float, float, float] | None:
    point = None if place is None else triple(place)
    return point if point is not None and all(map(math.isfinite, point)) else None
