"""The verdict on a report: one object, which the terminal, the page, tools and files read.

| verdict | exit code | when |
|---|---|---|
| consistent | 0 | the function states something, and all of it was decided |
| no errors found | 0 | nothing is stated, or some of it was not decided, and nothing requested that it be |
| FAILED | 1 | there are findings at or above the least severity that fails |
| not verified | 2 | a rule could not decide, none ran, or the report is read strictly and leaves something open |
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Literal

from kinform.foundation.words import counted, few, listed
from kinform.frozen import dataclass
from kinform.model.coverage import Coverage, Statement, StatementKind
from kinform.model.findings import SEVERITIES, CheckReport, Finding, severity_of

VerdictKind = Literal["consistent", "no errors found", "inconsistent", "not verified"]
CODES: dict[VerdictKind, int] = {"consistent": 0, "no errors found": 0, "inconsistent": 1, "not verified": 2}
UNKNOWN = "results of unknown origin"
"""Of results that this user's kinform neither computed nor recorded."""
NAMED = 3
"""Names that a line of coverage has at most. Chosen, not measured."""

FAMILIES = {
    "KF44": "setting", "KF45": "lock", "KF42": "requirement", "KF43": "requirement", "KF4": "joint", "KF3": "mobility",
    "KF5": "motion", "KF12": "mass", "KF13": "description", "KF2": "contact", "KF1": "mesh", "": "other",
}  # fmt: skip
"""What rules are about, by how their codes begin, the first that fits."""
PLURALS: dict[StatementKind, str] = {
    "joint": "joints", "range": "ranges", "coupling": "couplings", "mobility": "mobilities",
    "requirement": "requirements", "limit": "limits",
}  # fmt: skip
AGAINST: dict[StatementKind, str] = {
    "joint": "contradicted", "range": "not reached", "coupling": "different", "mobility": "different",
    "requirement": "violated", "limit": "violated",
}  # fmt: skip
"""What is said of a statement that does not hold."""
LIMITS = {"torque": "effort"}
"""Kinds of requirements whose limits have another name in robot descriptions."""
INTENDED = ("joint", "range", "coupling", "mobility")
"""What KF901, KF903, KF904 and rules of joints are about; requirements and limits are of KF902."""


@dataclass(frozen=True)
class Verdict:
    """What a report says as a whole, by the least severity that fails."""

    kind: VerdictKind
    line: str
    """In one line: "no errors found (17 of 20 joints decided)"."""
    coverage: str
    """In one line, what the check covers and leaves open."""
    open: tuple[str, ...]
    """What leaves the design not verified for who is strict."""

    @property
    def code(self) -> int:
        """Exit code of the gate."""
        return CODES[self.kind]

    @property
    def word(self) -> str:
        """For programs: the kind, and why a design is not verified."""
        return self.line if self.kind == "not verified" else self.kind

    @property
    def sign(self) -> str:
        """The kind without colour."""
        return {"consistent": "✓", "no errors found": "–", "inconsistent": "✕", "not verified": "?"}[self.kind]


def verdict_of(report: CheckReport, fail_on: str = "error") -> Verdict:
    """The verdict; `fail_on` is the least severity that fails: note, warning or error, ValueError otherwise."""
    kind, line = _judged(report, severity_of(fail_on))
    if report.origin == "unknown" and UNKNOWN not in line:
        line += f" ({UNKNOWN})"
    return Verdict(kind, line, coverage_line(report), tuple(_open(report)))


def verdict(report: CheckReport, fail_on: str = "error") -> int:
    """Exit code of the gate: 0 no findings at or above `fail_on`, 1 findings, 2 not verified."""
    return verdict_of(report, fail_on).code


def in_strict_words(left_open: Sequence[str]) -> str:
    """The verdict of a report that is read strictly and leaves this open."""
    return f"not verified (strict): {'; '.join(left_open)}"


def _judged(report: CheckReport, fail_on: str) -> tuple[VerdictKind, str]:
    level = SEVERITIES.index(severity_of(fail_on))
    failing = [finding for finding in report.findings if SEVERITIES.index(finding.severity) >= level]
    if failing:
        return "inconsistent", f"FAILED: {'. '.join(filter(None, (_families(failing), _matching(report))))}"
    if report.ran == 0:
        return "not verified", "not verified: no rule ran"
    if report.inconclusive:
        return "not verified", f"not verified: {_undecided(report)}"
    if report.strict and (open_ := list(_open(report))):
        return "not verified", in_strict_words(open_)
    doubts = list(_not_verified(report))
    return ("no errors found", f"no errors found ({'; '.join(doubts)})") if doubts else ("consistent", "consistent")


def _families(findings: Sequence[Finding]) -> str:
    """ "1 mesh error, 2 joint errors": the worst severity first, in the order of the codes."""
    found = Counter((f.severity, _family(f.code)) for f in findings)
    return ", ".join(
        counted(found[severity, name], f"{name} {severity}")
        for severity in reversed(SEVERITIES)
        for name in reversed(list(dict.fromkeys(FAMILIES.values())))
        if found[severity, name]
    )


def _family(code: str) -> str:
    return next(name for start, name in FAMILIES.items() if code.startswith(start))


def _matching(report: CheckReport) -> str:
    """How many of the joints that are stated match; empty where there are none."""
    joints = [s for s in report.statements if s.kind == "joint" and s.outcome != "given"]
    if report.coverage is not None and not report.coverage.stated:
        return "Nothing declared to compare with"
    good = sum(joint.outcome == "agrees" for joint in joints)
    if len(joints) < 2:
        return ("The joint matches" if good else "The joint does not match") if joints else ""
    return f"All {good} joints match" if good == len(joints) else f"{good} of {len(joints)} joints match"


def _undecided(report: CheckReport) -> str:
    """ "1 of 3 joints and the range are undecided (KF402, KF904)"."""
    codes = few([rule.code for rule in report.rules if rule.outcome == "inconclusive"], NAMED)
    found = []
    for kind, some in _by_kind(report.statements):
        many = sum(s.outcome == "undecided" for s in some)
        if many:
            found.append(_share(many, len(some), kind))
    verb = "is" if len(found) == 1 and found[0].startswith(("the ", "1 ")) else "are"
    return f"{listed(found)} {verb} undecided ({codes})" if found else f"{codes} could not decide"


def _share(many: int, every: int, kind: StatementKind) -> str:
    """ "the mobility", "1 of 3 joints"."""
    return f"the {kind}" if every == 1 else f"{many} of {every} {PLURALS[kind]}"


def _by_kind(statements: Sequence[Statement]) -> Iterator[tuple[StatementKind, list[Statement]]]:
    """Statements that there is something to compare with, by kind."""
    for kind in PLURALS:
        some = [s for s in statements if s.kind == kind and s.outcome != "given"]
        if some:
            yield kind, some


def _not_verified(report: CheckReport) -> Iterator[str]:
    """Why a report without failures is not that of a consistent design."""
    if report.coverage is None:
        yield "checked by another version: coverage unknown"
        return
    if not report.coverage.stated:
        yield "nothing declared"
        return
    accepted = _accepted(report)
    if not any(_by_kind(report.statements)):
        yield "nothing to compare with"
    for kind, some in _by_kind(report.statements):
        decided, holding = sum(s.decided for s in some), sum(s.holds for s in some)
        waived = sum(not s.holds and s.name in accepted for s in some)
        if all(s.outcome == "not checked" for s in some):
            yield f"{counted(len(some), kind, PLURALS[kind])} not checked"
        elif decided < len(some):
            yield f"{kind} undecided" if len(some) == 1 else f"{decided} of {len(some)} {PLURALS[kind]} decided"
        if decided > holding:
            more = f", {waived} accepted" if waived else ""
            yield f"{_share(decided - holding, len(some), kind).removeprefix('the ')} {AGAINST[kind]}{more}"


def _accepted(report: CheckReport) -> set[str]:
    """Names of what findings are about that the manifest or a baseline accepts."""
    return {name for item in report.ignored for name in item.finding.subject}


def _open(report: CheckReport) -> Iterator[str]:
    """What a strict reader asks for."""
    if report.origin == "unknown":
        yield UNKNOWN
    undecided = [s.name for s in report.statements if s.kind == "joint" and s.outcome in ("undecided", "no contact")]
    accepted = _accepted(report)
    undecided = [name for name in undecided if name not in accepted]
    if undecided:
        yield f"{counted(len(undecided), 'joint')} undecided ({few(undecided, NAMED)})"
    if report.coverage is not None:
        yield from _left_open(report.coverage)


def _left_open(coverage: Coverage) -> Iterator[str]:
    """What geometry leaves open."""
    ways = coverage.interpretations
    if ways:
        yield f"{counted(len(ways), 'interpretation')} open ({few(ways, NAMED)})"
    if coverage.several:
        parts = few([f"'{name}'" for name in coverage.several], NAMED)
        yield f"{parts} may be several parts"
    if coverage.fused:
        yield f"{few(coverage.fused, NAMED)} fused by contact at rest alone"


def coverage_line(report: CheckReport) -> str:
    """ "6 of 6 joints, 12 of 14 contacts understood; 2 interpretations open; 2 effort limits not checked: no simulation
    requested"; empty where nothing is known of it."""
    return "" if report.coverage is None else "; ".join(_covered(report, report.coverage))


def _covered(report: CheckReport, coverage: Coverage) -> Iterator[str]:
    stated = [s for s in report.statements if s.kind == "joint" and s.outcome != "given"]
    known, many = sum(s.decided for s in stated), len(stated)
    if not stated:
        known, many = coverage.joints_understood, coverage.joints
    shares = [(known, many, "joint"), (coverage.contacts_understood, coverage.contacts, "contact")]
    understood = [f"{some} of {counted(every, what)}" for some, every, what in shares if every]
    if understood:
        yield f"{', '.join(understood)} understood"
    for outcome, words in (("not held", "not held by contact"), ("no contact", "without contact")):
        count = sum(s.outcome == outcome for s in stated)
        if count:
            yield f"{counted(count, 'joint')} {words}"
    yield from _left_open(coverage)
    yield from _not_checked(report.statements)
    yield from _settings(report, coverage)


def _not_checked(statements: Sequence[Statement]) -> Iterator[str]:
    """What no rule looked at, by reason; what was undecided."""
    reasons: dict[str, Counter[str]] = {}
    for s in statements:
        if s.outcome == "not checked":
            what = f"{LIMITS.get(s.of, s.of)} limit".strip() if s.kind == "limit" else s.kind
            reasons.setdefault(s.reason, Counter())[what] += 1
    for reason, found in reasons.items():
        yield f"{listed([_plural(many, what) for what, many in found.items()])} not checked: {reason}"
    for kind, some in _by_kind(statements):
        undecided = sum(s.outcome == "undecided" for s in some)
        if undecided and kind != "joint":
            yield f"{_share(undecided, len(some), kind)} undecided"


def _plural(many: int, what: str) -> str:
    return counted(many, what, "mobilities" if what == "mobility" else None)


def _settings(report: CheckReport, coverage: Coverage) -> Iterator[str]:
    """How `[check]` and a baseline narrow the rules."""
    if report.unselected:
        yield f"{counted(len(report.unselected), 'rule')} not selected: {few(report.unselected, NAMED)}"
    if report.ignored:
        yield f"{counted(len(report.ignored), 'finding')} ignored"
    if coverage.lowered:
        yield f"{few(coverage.lowered, NAMED)} lowered to note by [check.severity]"
