"""What the page says of a design: the verdict; findings with their rules' words, joints with their evidence,
assumptions, rules."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from kinform import consistency
from kinform.consistency import explain
from kinform.design import Design
from kinform.foundation import words
from kinform.frozen import dataclass
from kinform.function import range_as_stated, resolve_joint
from kinform.model.collisions import JointRange, RangeEnd
from kinform.model.findings import SEVERITIES, RuleOutcome, Severity
from kinform.model.kinematics import Joint
from kinform.reports.page.phrases import assumption, joint_sentence, patch_words
from kinform.reports.page.subjects import as_stated, wanted_names
from kinform.reports.phrases import rule_counts, severity_counts, where
from kinform.reports.proofs import proof

MOST_LISTED_PATCHES = 14
"""Patches that a joint lists; the rest are counted. Chosen, not measured."""


VerdictKind = Literal["consistent", "inconsistent", "unverified"]
KINDS: dict[str, VerdictKind] = {"consistent": "consistent", "inconsistent": "inconsistent"}
"""How the page sets a kind of verdict; all others as unverified."""
SIGNS: dict[Severity, str] = {"error": "✕", "warning": "▲", "note": "●"}


@dataclass(frozen=True)
class Verdict:
    """`sign` says the kind without colour."""

    kind: VerdictKind
    sign: str
    line: str
    counts: str
    coverage: str = ""


@dataclass(frozen=True)
class FindingFacts:
    """One finding, worst first."""

    index: int
    """Position in the report."""
    code: str
    rule: str
    severity: Severity
    sign: str
    subject: str
    message: str
    facts: tuple[tuple[str, str], ...]
    """(what, value): found, intended, place, where it is declared."""
    remedy: str
    why: str
    """Why it matters, in the words of the rule."""


@dataclass(frozen=True)
class JointFacts:
    """One joint with what speaks for it."""

    index: int
    name: str
    wanted: str
    """Name of the intended joint, or empty."""
    sentence: str
    status: str
    reason: str
    facts: tuple[tuple[str, str], ...]
    patches: tuple[str, ...]
    more: int
    """Patches that are not listed."""
    blockers: tuple[str, ...]


@dataclass(frozen=True)
class Assumed:
    """Something that was taken as given: by whom, about what, and what."""

    by: str
    about: str
    what: str


def verdict_of(design: Design) -> Verdict:
    """Of a design; without findings in the file it is not verified."""
    if design.report is None:
        return Verdict("unverified", "?", "not verified: the rules have not been run", "run `kinform check`")
    found = consistency.verdict_of(design.report)
    kind = KINDS.get(found.kind, "unverified")
    counts = f"{severity_counts(design.report)} · {rule_counts(design.report)}"
    return Verdict(kind, found.sign, found.line, counts, found.coverage)


def findings(design: Design) -> list[FindingFacts]:
    """All findings, errors first, in the order of the report."""
    report = design.report
    if report is None:
        return []
    units = design.assembly.units
    out = []
    for index, finding in enumerate(report.findings):
        place = None if finding.place is None else words.place(finding.place, units)
        values = (
            ("found", finding.found), ("intended", finding.intended), ("place", place),
            ("declared at", where(finding) or None), ("proof", proof(finding, units)),
        )  # fmt: skip
        out.append(
            FindingFacts(
                index=index,
                code=finding.code,
                rule=finding.rule.replace("-", " "),
                severity=finding.severity,
                sign=SIGNS[finding.severity],
                subject=", ".join(finding.subject),
                message=finding.message,
                facts=tuple((name, value) for name, value in values if value is not None),
                remedy=finding.remedy or "",
                why=_why(finding.code),
            )
        )
    return sorted(out, key=lambda f: -SEVERITIES.index(f.severity))


def _why(code: str) -> str:
    """The paragraph of the rule that says why it matters."""
    paragraphs = [" ".join(text.split()) for text in explain(code).split("\n\n")]
    return next((text for text in paragraphs if text.startswith("Why it matters")), "").partition(": ")[2]


def joints(design: Design) -> list[JointFacts]:
    """All joints in their order."""
    kinematics = design.ranged
    if kinematics is None:
        return []
    wanted, run = wanted_names(design), design.simulation
    ranges = {str(item.joint): item for item in (run.ranges if run is not None else None) or ()}
    return [
        _joint(design, k, joint, wanted.get(joint.name, []), ranges.get(joint.name))
        for k, joint in enumerate(kinematics.joints)
    ]


def _joint(design: Design, index: int, joint: Joint, wanted: list[str], computed: JointRange | None) -> JointFacts:
    """A joint with its contact, what its singular values say, its range, and what holds it or is in its way; in the
    order and sense of the first of its names in the function."""
    seen = as_stated(design, joint, wanted)
    units = design.assembly.units
    patches = () if design.contacts is None else design.contacts.patches
    carried = sorted(
        (patches[k] for k in joint.patches if k < len(patches)), key=lambda p: (-p.area, p.parts, p.surfaces)
    )
    listed = tuple(f"{' and '.join(p.parts)}: {patch_words(p, units)}" for p in carried[:MOST_LISTED_PATCHES])
    facts = [("between", " and ".join(seen.bodies)), ("evidence", ", ".join(joint.evidence) or "none")]
    values = [float(v) for v in joint.singular_values if math.isfinite(v)]
    tolerances = design.assembly.tolerances
    if any(values) and joint.patches:
        free, rest = [v for v in values if v < tolerances.free], [v for v in values if v >= tolerances.free]
        text = f"{words.counted(len(free), 'freedom')} below {tolerances.free:g}"
        facts.append(("singular values", text + (f"; the smallest other is {rest[0]:.3g}" if rest else "")))
    if joint.freedoms:
        facts += _ranges(design, wanted, computed)
    if joint.held is not None:
        leaving = "; ".join(way.words for way in joint.releases[:4])
        facts.append(("held by contact", "yes" if joint.held else f"no: {leaving}" if leaving else "no"))
    elif joint.held_reason:
        facts.append(("held by contact", f"not known: {joint.held_reason}"))
    blockers = tuple(
        f"{' and '.join(b.parts)}: {words.area(b.area, units)} ({100 * b.share:.2g} % of the contact) "
        f"forbids {b.forbids}"
        for b in joint.blockers
    )
    return JointFacts(
        index=index, name=joint.name, wanted=", ".join(wanted), sentence=joint_sentence(seen, units),
        status=joint.status, reason=joint.reason, facts=tuple(facts), patches=listed,
        more=max(0, len(carried) - MOST_LISTED_PATCHES), blockers=blockers,
    )  # fmt: skip


def _ranges(design: Design, wanted: Sequence[str], computed: JointRange | None) -> list[tuple[str, str]]:
    """How far a joint goes in the sense of each of its names in the function; once where they agree."""
    kinematics = design.kinematics
    if computed is None or kinematics is None or not wanted:
        return [("range", _range(design, computed))]
    named = [resolve_joint(design.assembly, kinematics, name) for name in wanted]
    told = [(f"range of {one.name}", _range(design, range_as_stated(computed, one))) for one in named]
    return told if len({text for _, text in told}) > 1 else [("range", told[0][1])]


def _range(design: Design, computed: JointRange | None) -> str:
    """How far a joint goes to both sides, and what stops it there."""
    if computed is None:
        return "not looked for"
    if computed.status == "unbounded":
        return "unbounded: nothing stops it"
    ends = (("lower", computed.lower), ("upper", computed.upper))
    said = [f"{side}: {_end(computed.slides, end, design.assembly.units)}" for side, end in ends]
    if computed.status == "found" and computed.left_out:
        pairs = ", ".join(" and ".join(pair) for pair in computed.left_out[:3])
        more = len(computed.left_out) - 3
        said.append(f"without {pairs}{f' and {more} more' if more > 0 else ''}, which overlap, or roll")
    return "; ".join(said)


def _end(slides: bool, end: RangeEnd, units: str) -> str:
    if end.status == "unknown":
        return f"not known, {end.reason}" if end.reason else "not known"
    if end.value is None or not math.isfinite(end.value):
        return "nothing stops it"
    value = words.length(end.value, units) if slides else words.angle(end.value, 4)
    stopped = f"{' and '.join(end.parts)} meet" if end.parts else end.reason
    return f"{value} ({stopped})" if stopped else value


def assumptions(design: Design) -> list[Assumed]:
    """Everything that is not derived from the meshes: stated by the user, or chosen by kinform."""
    assembly, you, we = design.assembly, "you", "kinform"
    out = [Assumed(you, " and ".join(a.between), f"{assumption(a)}: {a.reason}") for a in assembly.assumptions]
    out += [Assumed(you, f"group {g.name}", "are one body: " + ", ".join(g.parts)) for g in assembly.groups]
    out += [
        Assumed(you, part.name, f"mass {words.mass(part.override.mass)} in place of that of the geometry")
        for part in assembly.parts
        if part.override is not None
    ]
    out += [
        Assumed(you, part.name, "surfaces only, not a solid") for part in assembly.parts if not part.solid and part.mesh
    ]
    out += [Assumed(we, "reading", note) for note in assembly.notes]
    if design.kinematics is not None:
        if assembly.ground is None:
            ground = next((body.name for body in design.kinematics.bodies if body.ground), None)
            if ground is not None:
                out.append(Assumed(we, "ground", f"{ground}: no ground is stated"))
        for joint in design.kinematics.joints:
            if joint.status == "inferred":
                out.append(Assumed(we, joint.name, f"inferred from {', '.join(joint.evidence)}: {joint.reason}"))
    if design.simulation is not None:
        out += [Assumed(we, "simulation", text) for text in design.simulation.assumptions]
    if design.mass is not None:
        out += [Assumed(we, p.name, f"no mass: {p.reason}") for p in design.mass.parts if p.mass is None and p.reason]
    return out


def rules(design: Design) -> list[RuleOutcome]:
    """All rules, their names in words: what is undecided first, then what failed, was ignored, passed, was skipped."""
    order = ("inconclusive", "failed", "ignored", "passed", "skipped")
    outcomes = [] if design.report is None else design.report.rules
    spelt = [replace(rule, rule=rule.rule.replace("-", " ")) for rule in outcomes]
    return sorted(spelt, key=lambda rule: order.index(rule.outcome))
