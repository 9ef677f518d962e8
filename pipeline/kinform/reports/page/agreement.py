"""Form, behaviour and function side by side: a row for each thing that at least one of them speaks of.

What disagrees the findings say. A row agrees only where the function states something, and the rules found it to hold:
`Statement` has the outcome, and nothing is judged here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal

from kinform.consistency import Comparison, compare_joints
from kinform.design import Design
from kinform.foundation import words
from kinform.frozen import dataclass
from kinform.function import joint_as_stated, range_as_stated, resolve_joint
from kinform.model.collisions import RangeEnd
from kinform.model.coverage import Statement, StatementKind, StatementOutcome
from kinform.model.findings import OutcomeName, Severity
from kinform.model.function import IntendedJoint, Requirement
from kinform.model.kinematics import Joint, Kinematics
from kinform.reports.page.phrases import axis_words, contact, joint_sentence, point_words
from kinform.requirements.words import requirement_words

MarkName = Literal["agrees", "disagrees", "doubtful", "not decided", "not stated", "not checked", "accepted"]
MARKS: dict[MarkName, str] = {
    "agrees": "✓", "disagrees": "✕", "doubtful": "▲", "not decided": "?", "not stated": "–", "not checked": "?",
    "accepted": "○",
}  # fmt: skip
"""What a row says, and its sign."""
MARK_OF: dict[Severity, MarkName] = {"error": "disagrees", "warning": "doubtful", "note": "not decided"}
"""The mark of a finding that no row is about."""
MARK_OF_OUTCOME: dict[StatementOutcome, MarkName] = {
    "agrees": "agrees", "met": "agrees", "not held": "not decided", "contradicts": "disagrees", "violated": "disagrees",
    "no contact": "not decided", "undecided": "not decided", "not checked": "not checked", "given": "not checked",
}  # fmt: skip
MARK_OF_RULE: dict[OutcomeName, MarkName] = {
    "passed": "agrees", "failed": "disagrees", "inconclusive": "not decided", "ignored": "accepted",
}  # fmt: skip
ORDER: tuple[MarkName, ...] = (
    "disagrees", "doubtful", "not decided", "not checked", "accepted", "agrees", "not stated",
)  # fmt: skip
"""What the page shows first; of several outcomes of one row the first counts."""


@dataclass(frozen=True)
class Row:
    """One thing and what the three descriptions say of it; empty text: nothing."""

    name: str
    form: str = ""
    behaviour: str = ""
    function: str = ""
    mark: MarkName = "not stated"
    findings: tuple[int, ...] = ()
    """Positions in the report."""

    @property
    def sign(self) -> str:
        """Of the mark."""
        return MARKS[self.mark]


def rows(design: Design) -> list[Row]:
    """Mobility, intended joints, other joints, motion, then what else the findings are about."""
    table = _Table(design)
    out = list(table.known())
    return out + list(table.rest())


class _Table:
    def __init__(self, design: Design):
        self.design = design
        self.units = design.assembly.units
        self.findings = () if design.report is None else design.report.findings
        self.members = [] if design.report is None else list(map(design.report.members_of, self.findings))
        """What each of them stands for."""
        self.used: set[int] = set()
        self.about: dict[str, list[int]] = {}
        """Findings about each name."""
        for k, finding in enumerate(self.findings):
            for name in dict.fromkeys(name for one in (finding, *self.members[k]) for name in one.subject):
                self.about.setdefault(name, []).append(k)
        rules = () if design.report is None else design.report.rules
        self.undecided = {rule.code for rule in rules if rule.outcome == "inconclusive"}
        self.outcomes = {rule.code: rule for rule in rules}
        statements = () if design.report is None else design.report.statements
        self.statements = {(s.kind, s.name): s for s in statements}
        self.accepted = (
            set() if design.report is None else {n for i in design.report.ignored for n in i.finding.subject}
        )

    def known(self) -> Iterator[Row]:
        """Rows that do not need a finding."""
        kinematics = self.design.kinematics
        wanted = sorted(self.design.assembly.function.joints, key=lambda joint: joint.name)
        if kinematics is not None:
            yield self._mobility(kinematics)
            every = compare_joints(self.design.assembly, self.design.contacts, kinematics, wanted)
            compared = {one.intended.name: one for one in every}
            matched = {c.joint.name for c in compared.values() if c.joint is not None}
            for joint in wanted:
                yield self._intended(joint, compared[joint.name])
            yield from (self._other(joint) for joint in kinematics.joints if joint.name not in matched)
        else:
            for joint in wanted:
                row = Row(joint.name, behaviour="not derived yet", function=self._stated(joint))
                yield self._judged_by_name(row, {joint.name})
        if self.design.simulation is not None and self.design.simulation.status != "not requested":
            yield self._motion()
        for requirement in sorted(self.design.assembly.function.requirements, key=lambda r: r.name):
            yield self._requirement(requirement)

    def rest(self) -> Iterator[Row]:
        """A row for each finding that no other row has."""
        for k, finding in enumerate(self.findings):
            if k not in self.used and (finding.severity != "note" or finding.code in self.undecided):
                of_form = finding.code < "KF300"
                behaviour = finding.found or finding.message
                mark = MARK_OF[finding.severity]
                name = ", ".join(finding.subject) or finding.rule
                form, behaviour = (behaviour, "") if of_form else ("", behaviour)
                yield Row(name, form, behaviour, finding.intended or "", mark, (k,))

    def _mobility(self, kinematics: Kinematics) -> Row:
        assembly, mobility = self.design.assembly, kinematics.mobility
        form = f"{words.counted(len(assembly.parts), 'part')}"
        if self.design.contacts is not None:
            form += f", {words.counted(len(self.design.contacts.patches), 'contact patch', 'contact patches')}"
        behaviour = f"{words.counted(len(kinematics.bodies), 'body', 'bodies')}, mobility {mobility.effective}"
        behaviour += f" and {mobility.idle} idle" if mobility.idle else ""
        low, high = mobility.ends
        if low < high:
            behaviour += f"; {low} with all contact kept, {high} without contact that only pushes"
        if mobility.finite not in (None, mobility.instantaneous):
            behaviour += f"; only {mobility.finite} finite"
        stated = assembly.function.mobility
        row = Row("mobility of the whole", form, behaviour, "" if stated is None else f"mobility {stated}")
        about = [k for k, members in enumerate(self.members) if any(one.code[:4] == "KF30" for one in members)]
        said = self._said(assembly.name, "mobility")
        return self._judged(row, about, [self._mark(one) for one in said])

    def _intended(self, joint: IntendedJoint, found: Comparison) -> Row:
        derived = found.joint
        if found.state == "one body":
            behaviour = f"one body ({found.reason})" if found.reason else "one body"
        elif found.state == "absent":
            behaviour = "no contact, no joint"
        elif found.afloat:
            behaviour = f"not known: {found.afloat}"
        elif derived is not None:
            behaviour = self._found(joint, derived)
        else:
            behaviour = found.type + (f", through {', '.join(found.through)}" if found.through else "")
        names = {joint.name} if derived is None else {joint.name, str(derived.name)}
        row = Row(joint.name, self._form(derived), behaviour, self._stated(joint))
        return self._judged_by_name(row, names, *self._said(joint.name, "joint", "range"))

    def _found(self, intended: IntendedJoint, derived: Joint) -> str:
        """ "revolute about -z, range -31° to 90°": the joint of an intended one in the designer's order and sense, and
        how far it goes where its range is stated."""
        assembly, kinematics, run = self.design.assembly, self.design.kinematics, self.design.simulation
        assert kinematics is not None
        resolution = resolve_joint(assembly, kinematics, intended.name)
        text = self._derived(joint_as_stated(resolution) or derived)
        if intended.range is None:
            return text
        ranges = () if run is None else run.ranges or ()
        item = next((item for item in ranges if item.joint == derived.name), None)
        if item is None:
            return f"{text}, range not looked for"
        if item.status == "unbounded":
            return f"{text}, range free"
        item = range_as_stated(item, resolution)
        return f"{text}, range {_end(intended, item.lower, self.units)} to {_end(intended, item.upper, self.units)}"

    def _other(self, joint: Joint) -> Row:
        row = self._judged_by_name(Row(joint.name, self._form(joint), self._derived(joint)), {joint.name})
        unstated = row.mark == "not decided" and joint.status != "ambiguous"
        return replace(row, mark="not stated") if unstated else row

    def _requirement(self, wanted: Requirement) -> Row:
        """What is asked for, what was found where it does not hold, and why it is not known."""
        values = [f.found for f in self.findings if wanted.name in f.subject and f.severity != "note" and f.found]
        said = self._said(wanted.name, "limit" if wanted.when_run else "requirement")
        told = [f"{one.outcome}: {one.reason}" if one.reason else one.outcome for one in said]
        row = Row(wanted.name, "", "; ".join(values or told), requirement_words(self.design.assembly, wanted))
        return self._judged_by_name(row, {wanted.name}, *said)

    def _motion(self) -> Row:
        design, run = self.design, self.design.simulation
        assert run is not None
        drives = [
            f"{d.joint}: {d.kind}" + (f" ({d.law.type})" if d.law else "") for d in design.assembly.function.drives
        ]
        level = f"{run.level} simulation " if run.level else "simulation "
        text = f"{level}{run.status}" + (f": {run.reason}" if run.reason else "")
        text += f"; not dynamic: {words.by_cause(run.not_dynamic)}" if run.not_dynamic else ""
        form = ""
        if design.mass is not None:
            weighed = sum(part.mass is not None for part in design.mass.parts)
            form = f"masses of {weighed} of {len(design.assembly.parts)} parts"
        about = [k for k, f in enumerate(self.findings) if f.code in ("KF409", "KF410") or f.code[:3] == "KF5"]
        rule = self.outcomes.get("KF501")
        mark: MarkName = "not checked"
        if rule is not None and drives and run.status == "done":
            mark = MARK_OF_RULE.get(rule.outcome, "not checked")
        return self._judged(Row("motion", form, text, "; ".join(drives)), about, [mark])

    def _said(self, name: str, *kinds: StatementKind) -> list[Statement]:
        """What the rules made of what the function states by this name."""
        return [self.statements[kind, name] for kind in kinds if (kind, name) in self.statements]

    def _judged_by_name(self, row: Row, names: set[str], *said: Statement) -> Row:
        """The row with the findings about any of the names."""
        about = sorted({k for name in names for k in self.about.get(name, ())})
        return self._judged(row, about, [self._mark(one) for one in said])

    def _judged(self, row: Row, findings: Sequence[int], marks: Sequence[MarkName]) -> Row:
        """The row with its findings, by their positions in the report, and its mark: that of the worst finding, else of
        what the rules say of what the function states."""
        self.used.update(findings)
        severities = {self.findings[k].severity for k in findings}
        mark: MarkName
        if severities - {"note"}:
            mark = "disagrees" if "error" in severities else "doubtful"
        elif self.design.report is None or (row.function and not marks):
            mark = "not checked" if row.function else "not stated"
        elif any(one.code in self.undecided for k in findings for one in self.members[k]):
            mark = "not decided"
        else:
            mark = min(marks, key=ORDER.index, default="not stated")
        return replace(row, mark=mark, findings=tuple(findings))

    def _mark(self, one: Statement) -> MarkName:
        """The mark of a statement by itself; of what does not hold, whose findings are ignored, that it is accepted."""
        return "accepted" if not one.holds and one.name in self.accepted else MARK_OF_OUTCOME[one.outcome]

    def _form(self, joint: Joint | None) -> str:
        """The contact behind a joint."""
        contacts = self.design.contacts
        return (
            ""
            if joint is None or contacts is None
            else contact([contacts.patches[k] for k in joint.patches], self.units)
        )

    def _derived(self, joint: Joint) -> str:
        return joint_sentence(joint, self.units) + ("" if joint.status == "determined" else f" ({joint.status})")

    def _stated(self, joint: IntendedJoint) -> str:
        text = (
            joint.type
            + axis_words(joint.type, joint.axis, joint.axis2)
            + point_words(joint.type, joint.point, self.units)
        )
        return text if joint.range is None else f"{text}, range {_limits(joint, self.units)}"


def _limits(joint: IntendedJoint, units: str) -> str:
    assert joint.range is not None
    return " to ".join(_limit(joint, value, units) for value in joint.range)


def _limit(joint: IntendedJoint, value: float, units: str) -> str:
    if math.isinf(value):
        return "free"
    return words.length(value, units) if joint.type == "prismatic" else words.angle(value, 4)


def _end(joint: IntendedJoint, end: RangeEnd, units: str) -> str:
    """One end of the range that was found."""
    if end.status == "unknown":
        return "not known"
    return "free" if end.value is None else _limit(joint, end.value, units)
