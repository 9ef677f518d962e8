"""Findings: what is inconsistent, where, by how much, and what to do."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated, Literal, get_args

from kinform.frozen import dataclass
from kinform.model.quantities import columns

Severity = Literal["note", "warning", "error"]
SEVERITIES: tuple[Severity, ...] = get_args(Severity)
"""From the least to the worst."""
OutcomeName = Literal["passed", "failed", "inconclusive", "skipped", "ignored"]
OUTCOMES: tuple[OutcomeName, ...] = get_args(OutcomeName)

Origin = Literal["recorded", "unknown", "refused"]
"""Where results come from that findings rest on: this user's kinform computed them, or recorded the file that they were
read from; it did not, and they count; it did not, and nothing is verified by them."""


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


CauseKind = Literal["repeated", "duplicated", "displaced", "frame", "scaled", "unplaced", "laid out", "alike"]
"""repeated: the same shapes again and again. duplicated: copies in one place. displaced: parts that one motion puts
right. frame: a mesh in the frame of another link. scaled: a mesh of another unit. unplaced: every part at its own
origin. laid out: parts beside each other that do not touch. alike: no cause that is known, but more of one rule than
anybody reads."""


@dataclass(frozen=True)
class Cause:
    """What several findings follow from: one finding states it, and the others are its members."""

    kind: CauseKind
    key: str
    """Shared by the finding that states the cause and by its members, and by no others of the report."""
    shift: Annotated[tuple[float, float, float], "m", columns("shift_x", "shift_y", "shift_z")] | None = None
    """World: moved by this, the parts fit. Of a mesh that has to be turned too, of the origin of its part frame."""
    scale: Annotated[float, "1"] | None = None
    """Multiplied by this, the mesh fits."""


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
    cause: (
        Annotated[
            Cause, columns("cause", "cause_key", "cause_shift_x", "cause_shift_y", "cause_shift_z", "cause_scale")
        ]
        | None
    ) = None
    """What it states the cause of, or follows from; None where it stands alone."""


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
    """One of each cause; as severe as the worst of its members."""
    rules: tuple[RuleOutcome, ...]
    ignored: tuple[Ignored, ...] = ()
    """Findings that are accepted, in the order of findings; they decide nothing."""
    gone: tuple[Annotated[tuple[str, tuple[str, ...]], columns("code", "subject")], ...] | None = None
    """Codes and subjects of a baseline that are not found any more; None where no baseline was compared."""
    answers: tuple[Annotated[tuple[str, int], columns("answer", "joints")], ...] = ()
    """How many intended joints geometry gives each answer to; empty where there are none, or nothing was derived."""
    members: tuple[Finding, ...] = ()
    """In the order of findings: what the findings that state causes stand for."""
    origin: Origin = "recorded"
    """No part of results files: it is another on another machine."""

    def members_of(self, finding: Finding) -> tuple[Finding, ...]:
        """The findings that a finding stands for: of one that states no cause, itself."""
        if finding.cause is None:
            return (finding,)
        return self._members.get(finding.cause.key, (finding,))

    @property
    def singles(self) -> tuple[Finding, ...]:
        """Every finding of a rule: those that state causes replaced by what they stand for."""
        return tuple(single for finding in self.findings for single in self.members_of(finding))

    @cached_property
    def _members(self) -> dict[str, tuple[Finding, ...]]:
        found: dict[str, list[Finding]] = {}
        for member in self.members:
            if member.cause is not None:
                found.setdefault(member.cause.key, []).append(member)
        return {key: tuple(members) for key, members in found.items()}

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


def verdict(report: CheckReport, fail_on: str = "error") -> int:
    """Exit code of the gate: 0 verified, 1 findings at or above `fail_on`, 2 not verified.

    Not verified: no rule ran, one was inconclusive, or results of unknown origin are refused. Where 1 and 2 both apply,
    1. `fail_on`: note, warning or error; ValueError otherwise.
    """
    level = SEVERITIES.index(severity_of(fail_on))
    if any(SEVERITIES.index(finding.severity) >= level for finding in report.findings):
        return 1
    return 2 if report.ran == 0 or report.inconclusive or report.origin == "refused" else 0
