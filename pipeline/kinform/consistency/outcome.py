"""What a rule may answer of a design, and what may become of one requirement."""

from __future__ import annotations

from collections.abc import Iterable

from kinform.frozen import dataclass
from kinform.model.findings import Finding


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


def settled(findings: Iterable[Finding], doubt: str, reason: str = "") -> Outcome:
    """Inconclusive where there is a doubt, else decided, for this reason."""
    return inconclusive(doubt, findings) if doubt else decided(findings, reason)


def skipped(reason: str) -> Outcome:
    """The rule does not apply to this design."""
    return Outcome("skipped", (), reason)


@dataclass(frozen=True)
class Answer:
    """What became of one requirement. `message` ends the sentence "requirement 'name': …"."""

    state: str
    """met, violated or undecided."""
    message: str
    found: str | None = None
    intended: str | None = None
    place: tuple[float, float, float] | None = None
    remedy: str | None = None
    margin: Margin | None = None


@dataclass(frozen=True)
class Margin:
    """How far a value is inside of the nearest of its bounds, SI; negative beyond it."""

    value: float
    unit: str


def met(message: str, *, found: str | None = None, intended: str | None = None, margin: Margin | None = None) -> Answer:
    """The requirement holds; the message says how this is known."""
    return Answer("met", message, found, intended, margin=margin)


def violated(
    message: str, *, found: str, intended: str, remedy: str, place: Iterable[float] | None = None,
    margin: Margin | None = None,
) -> Answer:  # fmt: skip
    """The requirement does not hold."""
    return Answer("violated", message, found, intended, None if place is None else triple(place), remedy, margin)


def least(margins: Iterable[Margin | None]) -> Margin | None:
    """The least of several; None where one is not known, or they are of different units."""
    known = list(margins)
    units = {margin.unit if margin else None for margin in known}
    if len(units) != 1 or None in units:
        return None
    return min((margin for margin in known if margin), key=lambda margin: margin.value)


def undecided(message: str, remedy: str, *, found: str | None = None, intended: str | None = None) -> Answer:
    """What is missing, and what would decide it."""
    return Answer("undecided", message, found, intended, None, remedy)


def triple(point: Iterable[float]) -> tuple[float, float, float]:
    """Three coordinates as plain numbers."""
    x, y, z = (float(value) for value in point)
    return (x, y, z)
