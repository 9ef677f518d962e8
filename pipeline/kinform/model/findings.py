"""Findings: what is inconsistent, where, by how much, and what to do."""

from __future__ import annotations

from typing import Annotated, Literal, get_args

from kinform.frozen import dataclass
from kinform.model.coverage import Coverage, Statement
from kinform.model.quantities import columns

Severity = Literal["note", "warning", "error"]
SEVERITIES: tuple[Severity, ...] = get_args(Severity)
"""From the least to the worst."""
OutcomeName = Literal["passed", "failed", "inconclusive", "skipped", "ignored"]
OUTCOMES: tuple[OutcomeName, ...] = get_args(OutcomeName)

Origin = Literal["recorded", "unknown"]
"""Where results come from that findings rest on: this user's kinform computed them, or recorded the file that they were
read from; or it did not."""


_TWIST = ("twist_wx", "twist_wy", "twist_wz", "twist_vx", "twist_vy", "twist_vz")
_BACK, _AHEAD = (tuple(f"{sense}_{axis}" for axis in "xyz") for sense in ("back", "ahead"))
WitnessKind = Literal["geometric", "textual", "computed"]
"""geometric: parts interpenetrate at a pose. textual: what a file states. computed: inputs, equation and residual."""


@dataclass(frozen=True)
class Witness:
    """The proof of a finding. World frame, SI and radians.

    geometric: a motion of one body relative to another is blocked. Steps back and ahead along the twist, from the pose
    of the meshes, drive the named parts into each other. textual: another place in the files contradicts the finding's.
    """

    kind: WitnessKind
    twist: Annotated[tuple[float, float, float, float, float, float], "1", columns(*_TWIST)] | None = None
    """(ω; v at the origin) of the second body relative to the first: of a unit turn, or of a unit slide."""
    step: Annotated[tuple[float, float], "rad or m", columns("step_back", "step_ahead")] | None = None
    depth: Annotated[tuple[float, float], "m", columns("depth_back", "depth_ahead")] | None = None
    """How deep the parts are in each other at the end of each step."""
    place_back: Annotated[tuple[float, float, float], "m", columns(*_BACK)] | None = None
    """Where, at the pose at the end of the step."""
    place_ahead: Annotated[tuple[float, float, float], "m", columns(*_AHEAD)] | None = None
    parts_back: Annotated[tuple[str, str], columns("back_part_a", "back_part_b")] | None = None
    """Sorted."""
    parts_ahead: Annotated[tuple[str, str], columns("ahead_part_a", "ahead_part_b")] | None = None
    source_file: str | None = None
    """Of a textual one: the other place."""
    source_line: int | None = None


@dataclass(frozen=True)
class Finding:
    """One inconsistency."""

    code: str
    rule: str
    """Name of the rule in words with hyphens: "joint-wrong-type"."""
    severity: Severity
    subject: tuple[str, ...]
    """Parts, joint or requirement, by name."""
    message: str
    found: str | None = None
    """With unit."""
    intended: str | None = None
    place: Annotated[tuple[float, float, float], "m", columns("x", "y", "z")] | None = None
    """m, world."""
    file: str | None = None
    line: int | None = None
    remedy: str | None = None
    witness: Witness | None = None
    """What proves it; None of results that an earlier version wrote, and of rules that give none yet."""


@dataclass(frozen=True)
class Ignored:
    """A finding that is accepted: by `[check]` in the manifest, with its reason, or by a baseline."""

    finding: Finding
    by: Literal["manifest", "baseline"]
    reason: str = ""


NOT_SELECTED = "not selected by [check]"
"""The reason of rules that `[check] select` leaves out."""


@dataclass(frozen=True)
class RuleOutcome:
    """What became of one rule: passed, failed, inconclusive, skipped (does not apply, or not selected), or
    ignored (all that it found, or that it could not decide, is accepted)."""

    code: str
    rule: str
    outcome: OutcomeName
    reason: str = ""


@dataclass(frozen=True)
class CheckReport:
    """All findings (sorted by code, subject), and all rules with their outcome (sorted by code)."""

    findings: tuple[Finding, ...]
    rules: tuple[RuleOutcome, ...]
    ignored: tuple[Ignored, ...] = ()
    """Findings that are accepted, in the order of findings; they decide nothing."""
    gone: tuple[Annotated[tuple[str, tuple[str, ...]], columns("code", "subject")], ...] | None = None
    """Codes and subjects of a baseline that are not found any more; None where no baseline was compared."""
    answers: tuple[Annotated[tuple[str, int], columns("answer", "joints")], ...] = ()
    """How many intended joints geometry gives each answer to; empty where there are none, or nothing was derived."""
    statements: tuple[Statement, ...] = ()
    """Everything that the function states, with its outcome: by kind, then in the order of the function."""
    coverage: Coverage | None = None
    """None: an older version checked it."""
    origin: Origin = "recorded"
    """No part of results files: it is another on another machine."""
    strict: bool = False
    """Whether whoever reads it takes as not verified what `Verdict.open` lists. No part of results files."""

    @property
    def ran(self) -> int:
        """How many rules were decided: passed, failed or inconclusive."""
        return sum(rule.outcome not in ("skipped", "ignored") for rule in self.rules)

    @property
    def unselected(self) -> tuple[str, ...]:
        """Codes of the rules that `[check] select` leaves out."""
        return tuple(rule.code for rule in self.rules if rule.outcome == "skipped" and rule.reason == NOT_SELECTED)

    @property
    def inconclusive(self) -> int:
        """How many rules could not be decided."""
        return sum(rule.outcome == "inconclusive" for rule in self.rules)


def severity_of(word: str) -> Severity:
    """The severity of that name; ValueError where there is none."""
    for severity in SEVERITIES:
        if severity == word:
            return severity
    raise ValueError(f"unknown severity {word!r}: expected one of {', '.join(SEVERITIES)}")
