"""Form, behaviour and function side by side: a row for each thing that at least one of them speaks of.

What disagrees the findings say. A row agrees only where the function states something, the rules have run, none that
speaks of it was left undecided, and what was found is what was asked for.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from kinform.consistency import Comparison, compare_joint
from kinform.design import Design
from kinform.foundation import words
from kinform.model.findings import SEVERITIES
from kinform.model.function import IntendedJoint, Requirement
from kinform.model.kinematics import Joint, Kinematics
from kinform.reports.page.phrases import axis, contact, joint_sentence, requirement_words

__all__ = ["MARKS", "Row", "rows"]

MARKS = {
    "agrees": "✓", "disagrees": "✕", "doubtful": "▲", "not decided": "?", "not stated": "–", "not checked": "?",
}  # fmt: skip
"""What a row says, and its sign."""


@dataclass(frozen=True)
class Row:
    """One thing and what the three descriptions say of it; empty text: nothing."""

    name: str
    form: str
    behaviour: str
    function: str
    mark: str
    findings: tuple[int, ...]
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
        self.used: set[int] = set()
        rules = () if design.report is None else design.report.rules
        self.undecided = {rule.code for rule in rules if rule.outcome == "inconclusive"}

    def known(self) -> Iterator[Row]:
        """Rows that do not need a finding."""
        kinematics = self.design.kinematics
        wanted = sorted(self.design.assembly.function.joints, key=lambda joint: joint.name)
        if kinematics is not None:
            yield self._mobility(kinematics)
            compared = {
                j.name: compare_joint(self.design.assembly, self.design.contacts, kinematics, j) for j in wanted
            }
            matched = {c.joint.name for c in compared.values() if c.joint is not None}
            for joint in wanted:
                yield self._intended(joint, compared[joint.name])
            for found in kinematics.joints:
                if found.name not in matched:
                    yield self._other(found)
        else:
            for joint in wanted:
                yield self._row(joint.name, "", "not derived yet", self._stated(joint), (joint.name,), False)
        if self.design.simulation is not None and self.design.simulation.status != "not requested":
            yield self._motion()
        for requirement in sorted(self.design.assembly.function.requirements, key=lambda r: r.name):
            yield self._requirement(requirement)

    def rest(self) -> Iterator[Row]:
        """A row for each finding that no other row has."""
        for k, finding in enumerate(self.findings):
            if k not in self.used and (finding.severity != "note" or finding.code in self.undecided):
                of_form = finding.code < "KF300"
                said = finding.found or finding.message
                mark = {"error": "disagrees", "warning": "doubtful", "note": "not decided"}[finding.severity]
                name = ", ".join(finding.subject) or finding.rule
                yield Row(name, said if of_form else "", "" if of_form else said, finding.intended or "", mark, (k,))

    def _mobility(self, kinematics: Kinematics) -> Row:
        assembly, mobility = self.design.assembly, kinematics.mobility
        form = f"{words.counted(len(assembly.parts), 'part')}"
        if self.design.contacts is not None:
            form += f", {words.counted(len(self.design.contacts.patches), 'contact patch', 'contact patches')}"
        found = f"{words.counted(len(kinematics.bodies), 'body', 'bodies')}, mobility {mobility.effective}"
        idle = f" and {mobility.idle} idle" if mobility.idle else ""
        finite = "" if mobility.finite in (None, mobility.instantaneous) else f"; only {mobility.finite} finite"
        stated = assembly.function.mobility
        codes = ("KF301", "KF302", "KF303", "KF304", "KF305", "KF306")
        findings = [k for k, f in enumerate(self.findings) if f.code in codes]
        mark = None if stated is None else stated == mobility.effective
        function = "" if stated is None else f"mobility {stated}"
        return self._made("mobility of the whole", form, found + idle + finite, function, findings, mark, "KF301")

    def _intended(self, joint: IntendedJoint, found: Comparison) -> Row:
        patches = []
        if found.joint is not None and self.design.contacts is not None:
            patches = [self.design.contacts.patches[k] for k in found.joint.patches]
        names = {joint.name} | ({found.joint.name} if found.joint is not None else set())
        if found.state == "one body":
            behaviour = f"one body ({found.reason})" if found.reason else "one body"
        elif found.state == "absent":
            behaviour = "no contact, no joint"
        elif found.joint is not None:
            behaviour = joint_sentence(found.joint, self.units) + self._status(found.joint)
        else:
            behaviour = found.type + (f", through {', '.join(found.through)}" if found.through else "")
        form = contact(patches, self.units)
        settled = None if found.state in ("stated", "undecided") else found.right_type
        function = self._stated(joint)
        row = self._row(joint.name, form, behaviour, function, tuple(sorted(names)), settled)
        if row.mark == "agrees" and found.joint is not None and found.joint.status == "ambiguous":
            return Row(row.name, row.form, row.behaviour, row.function, "not decided", row.findings)
        return row

    def _other(self, joint: Joint) -> Row:
        patches = [self.design.contacts.patches[k] for k in joint.patches] if self.design.contacts is not None else []
        behaviour = joint_sentence(joint, self.units) + self._status(joint)
        row = self._row(joint.name, contact(patches, self.units), behaviour, "", (joint.name,), None)
        if row.mark == "not decided" and joint.status != "ambiguous":
            return Row(row.name, row.form, row.behaviour, row.function, "not stated", row.findings)
        return row

    def _requirement(self, wanted: Requirement) -> Row:
        """What is asked for, and what was found where it does not hold."""
        found = [f.found for f in self.findings if wanted.name in f.subject and f.severity != "note" and f.found]
        row = self._row(
            wanted.name, "", "; ".join(found), requirement_words(self.design.assembly, wanted), (wanted.name,), True
        )
        return replace(row, behaviour="met") if row.mark == "agrees" else row

    def _motion(self) -> Row:
        run = self.design.simulation
        assert run is not None
        drives = [
            f"{d.joint}: {d.kind}" + (f" ({d.law.type})" if d.law else "") for d in self.design.assembly.function.drives
        ]
        codes = ("KF409", "KF410", "KF501", "KF502", "KF503", "KF504")
        findings = [k for k, f in enumerate(self.findings) if f.code in codes or f.code[:3] == "KF5"]
        level = f"{run.level} simulation " if run.level else "simulation "
        text = f"{level}{run.status}" + (f": {run.reason}" if run.reason else "")
        known = None if self.design.mass is None else sum(part.mass is not None for part in self.design.mass.parts)
        form = "" if known is None else f"masses of {known} of {len(self.design.assembly.parts)} parts"
        mark = (run.status == "done") or None
        return self._made("motion", form, text, "; ".join(drives), findings, mark if drives else None, "KF501")

    def _row(
        self, name: str, form: str, behaviour: str, function: str, names: tuple[str, ...], right: bool | None
    ) -> Row:
        findings = [k for k, f in enumerate(self.findings) if set(f.subject) & set(names)]
        return self._made(name, form, behaviour, function, findings, right, None)

    def _made(
        self,
        name: str,
        form: str,
        behaviour: str,
        function: str,
        findings: list[int],
        right: bool | None,
        rule: str | None,
    ) -> Row:
        """`right`: what was found is what was asked for; None: there is nothing to compare, or no answer."""
        self.used.update(findings)
        serious = [k for k in findings if self.findings[k].severity != "note"]
        worst = max((SEVERITIES.index(self.findings[k].severity) for k in serious), default=0)
        open_rule = rule in self.undecided or any(self.findings[k].code in self.undecided for k in findings)
        if serious:
            mark = "disagrees" if SEVERITIES[worst] == "error" else "doubtful"
        elif self.design.report is None:
            mark = "not checked" if function else "not stated"
        elif open_rule:
            mark = "not decided"
        elif not function:
            mark = "not stated"
        else:
            mark = "agrees" if right else "not decided"
        return Row(name, form, behaviour, function, mark, tuple(findings))

    def _status(self, joint: Joint) -> str:
        return "" if joint.status == "determined" else f" ({joint.status})"

    def _stated(self, joint: IntendedJoint) -> str:
        text = joint.type
        if joint.axis is not None:
            text += f" {'along' if joint.type == 'prismatic' else 'normal to' if joint.type == 'planar' else 'about'} "
            text += axis(joint.axis) + (f" and {axis(joint.axis2)}" if joint.axis2 is not None else "")
        if joint.point is not None and joint.type not in ("prismatic", "planar", "fixed"):
            text += f" through {words.place(joint.point, self.units)}"
        if joint.range is not None:
            text += f", range {_limits(joint, self.units)}"
        return text


def _limits(joint: IntendedJoint, units: str) -> str:
    assert joint.range is not None
    slides = joint.type == "prismatic"

    def shown(value: float) -> str:
        if math.isinf(value):
            return "free"
        return words.length(value, units) if slides else words.angle(value, 4)

    return " to ".join(map(shown, joint.range))
