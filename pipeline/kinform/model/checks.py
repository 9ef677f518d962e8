"""`[check]`: how the designer wants the rules to be applied."""

from __future__ import annotations

from typing import Annotated, Literal

from kinform.frozen import dataclass
from kinform.model.findings import Severity
from kinform.model.quantities import columns

Profile = Literal["design", "description"]
"""Which severities findings have: `consistency.profiles`."""


@dataclass(frozen=True)
class Ignore:
    """Findings that the designer accepts, and why. `code` is that of a rule, or its name."""

    code: str
    subject: str | None
    """A name in the finding's subject (part, joint, requirement); None: the whole rule."""
    reason: str
    file: str
    line: int | None


@dataclass(frozen=True)
class CheckSettings:
    """Which rules run, how severe their findings are, and what is ignored. Rules by code or name."""

    select: tuple[str, ...] = ()
    """Codes, names, or the beginnings of codes ("KF2"); empty: all."""
    severity: tuple[Annotated[tuple[str, Severity], columns("rule", "severity")], ...] = ()
    """(rule, severity of its findings), sorted."""
    ignore: tuple[Ignore, ...] = ()
    file: str | None = None
    line: int | None = None
    profile: Profile = "design"
