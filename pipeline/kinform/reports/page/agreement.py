"""Form, behaviour and function side by side: a row for each thing that at least one of them speaks of.

What disagrees the findings say. A row agrees only where the function states something, the rules have run, none that
speaks of it was left undecided, and what was found is what was asked for.
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
from kinform.function import resolve_joint
from kinform.model.collisions import RangeEnd
from kinform.model.findings import Severity
from kinform.model.function import IntendedJoint, Requirement
from kinform.model.kinematics import Joint, Kinematics
from kinform.reports.page.phrases import axis_words, contact, joint_sentence, point_words
from kinform.requirements.words import requirement_words

MarkName = Literal["agrees", "disagrees", "doubtful", "not decided", "not stated", "not checked"]
MARKS: dict[MarkName, str] = {
    "agrees": "✓", "disagrees": "✕", "doubtful": "▲", "not decided": "?", "not stated": "–", "not checked": "?",
}  # fmt: skip
"""What a row says, and its sign."""
MARK_OF: dict[Severity, MarkName] = {"error": "disagrees", "warning": "doubtful", "note": "not decided"}
"""The mark of a finding that no row is about."""
ORDER: tuple[MarkName, ...] = ("disagrees", "doubtful", "not decided", "not checked", "agrees", "not stated")
"""What the page shows first."""


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
                yield self._judged_by_name(row, {joint.name}, False)
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
        right = None if stated is None else mobility.admits(stated)
        about = [k for k, members in enumerate(self.members) if any(one.code[:4] == "KF30" for one in members)]
        return self._judged(row, about, right, "KF301")

    def _intended(self, joint: IntendedJoint, found: Comparison) -> Row:
        derived = found.joint
        if found.state == "one body":
            behaviour = f"one body ({found.reason})" if found.reason else "one body"
        elif found.state == "absent":
            behaviour = "no contact, no joint"
        elif found.afloat:
            behaviour = f"not known: {found.afloat}"
        elif derived is not None:
            behaviour = self._derived(derived) + self._range_found(joint)
        else:
            behaviour = found.type + (f", through {', '.join(found.through)}" if found.through else "")
        right = None if found.state in ("stated", "undecided") else found.right_type
        names = {joint.name} if derived is None else {joint.name, str(derived.name)}
        row = Row(joint.name, self._form(derived), behaviour, self._stated(joint))
        row = self._judged_by_name(row, names, right)
        ambiguous = row.mark == "agrees" and derived is not None and derived.status == "ambiguous"
        return replace(row, mark="not decided") if ambiguous else row

    def _range_found(self, intended: IntendedJoint) -> str:
        """ ", range -31° to 90°": how far an intended joint goes, in the designer's sign, where its range is stated."""
        assembly, kinematics = self.design.assembly, self.design.kinematics
        if intended.range is None or kinematics is None:
            return ""
        resolution = resolve_joint(assembly, kinematics, intended.name)
        run = self.design.simulation
        ranges = () if run is None else run.ranges or ()
        name = None if resolution.joint is None else resolution.joint.name
        item = next((item for item in ranges if item.joint == name), None)
        if item is None:
            return ", range not looked for"
        if item.status == "unbounded":
            return ", range free"
        ends = [_end(intended, resolution.sign, end, self.units) for end in (item.lower, item.upper)]
        return ", range " + " to ".join(ends if resolution.sign > 0 else ends[::-1])

    def _other(self, joint: Joint) -> Row:
        row = self._judged_by_name(Row(joint.name, self._form(joint), self._derived(joint)), {joint.name}, None)
        unstated = row.mark == "not decided" and joint.status != "ambiguous"
        return replace(row, mark="not stated") if unstated else row

    def _requirement(self, wanted: Requirement) -> Row:
        """What is asked for, and what was found where it does not hold."""
        values = [f.found for f in self.findings if wanted.name in f.subject and f.severity != "note" and f.found]
        row = Row(wanted.name, "", "; ".join(values), requirement_words(self.design.assembly, wanted))
        row = self._judged_by_name(row, {wanted.name}, True)
        return replace(row, behaviour="met") if row.mark == "agrees" else row

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
        right = True if drives and run.status == "done" else None
        about = [k for k, f in enumerate(self.findings) if f.code in ("KF409", "KF410") or f.code[:3] == "KF5"]
        return self._judged(Row("motion", form, text, "; ".join(drives)), about, right, "KF501")

    def _judged_by_name(self, row: Row, names: set[str], right: bool | None) -> Row:
        """The row with the findings about any of the names."""
        about = sorted({k for name in names for k in self.about.get(name, ())})
        return self._judged(row, about, right)

    def _judged(self, row: Row, findings: Sequence[int], right: bool | None, rule: str = "") -> Row:
        """The row with its findings, by their positions in the report, and its mark.

        `right`: what was found is what was asked for; None: there is nothing to compare, or no answer. `rule` is the
        code of the rule that decides.
        """
        self.used.update(findings)
        severities = {self.findings[k].severity for k in findings}
        undecided = rule in self.undecided or any(
            one.code in self.undecided for k in findings for one in self.members[k]
        )
        mark: MarkName
        if severities - {"note"}:
            mark = "disagrees" if "error" in severities else "doubtful"
        elif self.design.report is None:
            mark = "not checked" if row.function else "not stated"
        elif undecided:
            mark = "not decided"
        elif not row.function:
            mark = "not stated"
        else:
            mark = "agrees" if right else "not decided"
        return replace(row, mark=mark, findings=tuple(findings))

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


def _end(joint: IntendedJoint, sign: int, end: RangeEnd, units: str) -> str:
    """One end of the range that was found, in the designer's sign."""
    if end.status == "unknown":
        return "not known"
    return "free" if end.value is None else _limit(joint, sign * end.value, units)
