"""Findings: what is inconsistent, where, by how much, and what to do."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import field
from functools import cached_property
from typing import Annotated, Any, Literal, Protocol, get_args

import numpy as np

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


class Place(Protocol):
    """Somewhere in a file."""

    @property
    def file(self) -> str | None: ...
    @property
    def line(self) -> int | None: ...


_TWIST = ("twist_wx", "twist_wy", "twist_wz", "twist_vx", "twist_vy", "twist_vz")
_BACK, _AHEAD = (tuple(f"{sense}_{axis}" for axis in "xyz") for sense in ("back", "ahead"))
_MOVED = tuple(f"moved_{name.removeprefix('twist_')}" for name in _TWIST)
WitnessKind = Literal["geometric", "textual", "computed"]
"""geometric: where parts are. textual: what a file states. computed: inputs, equation and residual."""
Equation = Literal[
    "angle of directions", "balanced pushes", "centre off a point", "closing of loops", "coordinate step",
    "density of the hull", "distance of lines", "distance of points", "edge uses", "effort of motion",
    "end of a guide", "facet faces inwards", "fit of surfaces", "freedoms of a graph", "freedoms of twists",
    "hull of a mass", "imbalance about a line", "impossible inertia", "inertia about a line", "inertia beyond reach",
    "lead of a twist", "loss by friction", "mass of shapes", "motion that opens", "path and motion",
    "rate of positions", "ratio of rates", "ratio of sizes", "reach of a chain", "record of a run",
    "share of a curve", "sum of rates", "time of a run", "volume of a file", "work of weights",
]  # fmt: skip
"""What a computed witness may be recomputed by, each in one way that is not the finder's (`kinform.replays`)."""


PUSHES_MOST = 1e4
"""Pushes over the wrench that they leave, above which they balance up to rounding."""


@dataclass(frozen=True)
class Witness:
    """The proof of a finding: what another method can repeat without the one that found it. World frame, SI, radians.

    Fields that a class does not need are None. geometric: two sides, sets of parts, at a pose: `gap` apart, or deep in
    each other; or a motion of the second side that both senses of a step, or nothing on its way, show to be blocked, or
    free. textual: what a file states in a line, or lacks. computed: a residual beyond its limit.
    """

    kind: WitnessKind
    twist: Annotated[tuple[float, float, float, float, float, float], "1", columns(*_TWIST)] | None = None
    """(ω; v at the origin) of the second body relative to the first: of a unit turn, or of a unit slide."""
    step: Annotated[tuple[float, float], "rad or m", columns("step_back", "step_ahead")] | None = None
    """Of a free motion: where it begins and ends."""
    depth: Annotated[tuple[float, float], "m", columns("depth_back", "depth_ahead")] | None = None
    """How deep the parts are in each other at the end of each step."""
    place_back: Annotated[tuple[float, float, float], "m", columns(*_BACK)] | None = None
    """Where, at the pose at the end of the step."""
    place_ahead: Annotated[tuple[float, float, float], "m", columns(*_AHEAD)] | None = None
    parts_back: Annotated[tuple[str, str], columns("back_part_a", "back_part_b")] | None = None
    """The part that rests, and the one that moves."""
    parts_ahead: Annotated[tuple[str, str], columns("ahead_part_a", "ahead_part_b")] | None = None
    source_file: str | None = None
    """Of a textual one."""
    source_line: int | None = None
    first: tuple[str, ...] | None = None
    """Parts that rest; of a computed one: those whose meshes it is about."""
    second: tuple[str, ...] | None = None
    """Parts that move."""
    moved: Annotated[tuple[float, float, float, float, float, float], "rad, m", columns(*_MOVED)] | None = None
    """Twist of the displacement that takes the second side from its place as modelled; None: it is there."""
    gap: Annotated[float, "m"] | None = None
    """Least distance of the sides; negative: how deep they are in each other."""
    volume: Annotated[float, "m³"] | None = None
    """That the sides share."""
    states: tuple[str, ...] | None = None
    """Texts that stand in the element, table or line that begins at the line, in this order."""
    lacks: tuple[str, ...] | None = None
    """Keys that do not stand there."""
    missing: str | None = None
    """A file that is not there."""
    equation: str | None = None
    """One of `Equation`."""
    inputs: dict[str, tuple[float, ...]] | None = field(default=None, hash=False)
    residual: Annotated[float, ""] | None = None
    """In the unit of the equation."""
    limit: Annotated[float, ""] | None = None
    """What the residual exceeds."""


def between(
    first: Iterable[str], second: Iterable[str], gap: float, *, moved: Iterable[float] | None = None,
    volume: float | None = None,
) -> Witness | None:  # fmt: skip
    """That two sides are a gap apart (m; negative: deep in each other); None unless that is known."""
    if not math.isfinite(gap):
        return None
    a, b, c, d, e, f = (0.0,) * 6 if moved is None else (float(x) + 0.0 for x in moved)
    shared = volume if volume is not None and math.isfinite(volume) else None
    return Witness(
        "geometric", first=tuple(map(str, first)), second=tuple(map(str, second)), gap=float(gap), volume=shared,
        moved=None if moved is None else (a, b, c, d, e, f),
    )  # fmt: skip


def free_way(
    first: Iterable[str], second: Iterable[str], direction: Iterable[float], travel: float,
    after: Iterable[float] | None = None,
) -> Witness | None:  # fmt: skip
    """That the second side, first slid by `after`, goes along a unit direction so far (m) and meets nothing."""
    x, y, z = (float(value) + 0.0 for value in direction)
    a, b, c = (0.0,) * 3 if after is None else (float(value) + 0.0 for value in after)
    if not all(map(math.isfinite, (x, y, z, a, b, c, travel))):
        return None
    return Witness(
        "geometric", twist=(0.0, 0.0, 0.0, x, y, z), step=(0.0, float(travel)), first=tuple(map(str, first)),
        second=tuple(map(str, second)), moved=None if after is None else (0.0, 0.0, 0.0, a, b, c), volume=0.0,
    )  # fmt: skip


def stated(declared: Place, *states: str, lacks: Iterable[str] = (), missing: str | None = None) -> Witness | None:
    """That a file states texts at a line, lacks keys there, or names a file that is not there; None without a line."""
    if declared.file is None or declared.line is None:
        return None
    return Witness(
        "textual", source_file=declared.file, source_line=declared.line, states=states or None,
        lacks=tuple(lacks) or None, missing=missing,
    )  # fmt: skip


def computed(
    equation: Equation, residual: float, limit: float, *, parts: Iterable[str] = (), **inputs: Any
) -> Witness | None:
    """That a residual exceeds its limit; None where a number of it is not finite."""
    numbers = {name: tuple(map(float, np.ravel(value))) for name, value in inputs.items()}
    if not all(map(math.isfinite, [residual, limit, *(x for values in numbers.values() for x in values)])):
        return None
    return Witness(
        "computed", first=tuple(map(str, parts)) or None, equation=equation, inputs=numbers, residual=float(residual),
        limit=float(limit),
    )  # fmt: skip


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
    statements: tuple[Statement, ...] = ()
    """Everything that the function states, with its outcome: by kind, then in the order of the function."""
    coverage: Coverage | None = None
    """None: an older version checked it."""
    members: tuple[Finding, ...] = ()
    """In the order of findings: what the findings that state causes stand for."""
    origin: Origin = "recorded"
    """No part of results files: it is another on another machine."""
    strict: bool = False
    """Whether whoever reads it takes as not verified what `Verdict.open` lists. No part of results files."""

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
