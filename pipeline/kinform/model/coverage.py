"""What a check covers: each thing that the function states with its outcome, and what is left open beside it."""

from __future__ import annotations

from typing import Literal, get_args

from kinform.frozen import dataclass

StatementKind = Literal["joint", "range", "coupling", "mobility", "requirement", "limit"]
STATEMENT_KINDS: tuple[StatementKind, ...] = get_args(StatementKind)
"""limit: of the speed or effort of a joint, asked about only where a simulation drives the joint."""
StatementOutcome = Literal[
    "agrees", "not held", "contradicts", "no contact", "met", "violated", "undecided", "not checked", "given"
]
"""Joints have the answers of geometry: agrees, not held, contradicts, no contact. not checked: no rule looked at it.
given: there is no geometry to compare it with."""
STATEMENT_OUTCOMES: tuple[StatementOutcome, ...] = get_args(StatementOutcome)


@dataclass(frozen=True)
class Statement:
    """Something that the function states, and what the rules made of it."""

    kind: StatementKind
    name: str
    """Of the joint, requirement or sub-assembly; of couplings all their joints; of the whole assembly its name."""
    outcome: StatementOutcome
    reason: str = ""
    """Why it is undecided or not checked."""
    of: str = ""
    """Kind of the requirement."""

    @property
    def decided(self) -> bool:
        """Whether rules have an answer, whichever it is."""
        return self.holds or self.outcome in ("contradicts", "violated")

    @property
    def holds(self) -> bool:
        """Whether what was found admits what is stated."""
        return self.outcome in ("agrees", "not held", "met")


@dataclass(frozen=True)
class Coverage:
    """What is known of the rest, and which settings narrow the rules."""

    stated: bool
    """Whether the function states anything."""
    joints: int = 0
    """Derived ones."""
    joints_understood: int = 0
    contacts: int = 0
    """Pairs of parts that touch or interpenetrate."""
    contacts_understood: int = 0
    interpretations: tuple[str, ...] = ()
    """Joints that are ambiguous, and that nobody declares."""
    several: tuple[str, ...] = ()
    """Parts whose meshes have several solids."""
    fused: tuple[str, ...] = ()
    """Pairs of parts that are one body by contact at rest, which lets them turn apart."""
    lowered: tuple[str, ...] = ()
    """Codes of rules whose findings `[check.severity]` makes notes."""
