"""What matters of a check, on one screen: the verdict, what weighs least, and the worst findings nearest the prompt.

A finding takes one line, names are shortened in their middle; `full` has every word. Rules that could not decide stand
between warnings and errors: without errors they are what keeps a design from being verified.
"""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from kinform.design import Design
from kinform.foundation.words import counted, one_line, shortened, shortened_ends
from kinform.model.findings import CheckReport
from kinform.reports import constants
from kinform.reports.phrases import answers_line, rule_counts, severity_counts, verdict_line

_KINDS = ("warning", "not decided", "error")
"""What is told line by line, the worst last."""


@dataclass(frozen=True)
class _Item:
    """A finding that is no note, or a rule that could not decide."""

    kind: str
    code: str
    rule: str
    subject: tuple[str, ...]
    text: str
    more: str | None
    """What was intended."""
    remedy: str | None

    @property
    def head(self) -> str:
        """As in "error: KF201 parts-interpenetrate"."""
        return f"{self.kind}: {self.code} {self.rule}"


def render(report: CheckReport, design: Design, fail_on: str = "error", *, width: int = constants.WIDTH) -> str:
    """Verdict and counts; a line for each group of notes; what was skipped or assumed; the worst findings, the worst
    last. No line is longer than `width`, unless it has one word that is."""
    name = shortened(one_line(design.assembly.name), width // 2)
    lines = textwrap.wrap(f"{name}: {verdict_line(report, fail_on)}", width, subsequent_indent="  ")
    lines += textwrap.wrap(f"{severity_counts(report)}; {rule_counts(report)}", width, subsequent_indent="  ")
    lines += _notes(report, width)
    lines += _assumed(report, design, width)
    if report.answers:
        lines += textwrap.wrap(f"intended joints: {answers_line(report.answers)}", width, subsequent_indent="  ")
    chosen, rest = _worst(_items(report))
    if rest:
        told = []
        for kind, others in groupby(reversed(rest), lambda item: item.kind):
            codes = Counter(item.code for item in others)
            told.append(f"{kind}: " + ", ".join(f"{many} {code}" for code, many in sorted(codes.items())))
        lines += textwrap.wrap(f"and {len(rest)} more (-v shows all): {'; '.join(told)}", width, subsequent_indent="  ")
    return "\n".join([*lines, *_groups(chosen, width, constants.BRIEF_LINES - len(lines))]) + "\n"


def _items(report: CheckReport) -> list[_Item]:
    """All that is told line by line, by kind, the worst first, then by code."""
    found = [
        _Item(f.severity, f.code, f.rule, f.subject, one_line(f.found or f.message), f.intended, f.remedy)
        for f in report.findings
        if f.severity != "note"
    ]
    undecided = [
        _Item("not decided", r.code, r.rule, (), one_line(r.reason), None, None)
        for r in report.rules
        if r.outcome == "inconclusive"
    ]
    return sorted(found + undecided, key=lambda item: -_KINDS.index(item.kind))


def _worst(items: Sequence[_Item]) -> tuple[list[_Item], list[_Item]]:
    """The findings that are shown, the worst last, and the others. Of each kind every rule has its turn: many findings
    of one do not hide the only one of another."""
    turns: Counter[str] = Counter()
    ranked = []
    for place, item in enumerate(items):
        ranked.append((-_KINDS.index(item.kind), turns[item.head], place))
        turns[item.head] += 1
    shown = {place for _, _, place in sorted(ranked)[: constants.MOST_BRIEF]}
    chosen = [item for place, item in enumerate(items) if place in shown]
    chosen.sort(key=lambda item: _KINDS.index(item.kind))
    return chosen, [item for place, item in enumerate(items) if place not in shown]


def _groups(chosen: Sequence[_Item], width: int, room: int) -> list[str]:
    """One line a finding, below the rule that they have in common; a single one stands beside it where it fits. Of the
    `room` lines those that are left are spent on what would be cut, and on the remedy of the worst; the worst first."""
    groups = [list(group) for _, group in groupby(chosen, lambda item: item.head)]
    spare = room - sum(len(group) + (len(group) > 1) for group in groups)
    blocks: list[list[str]] = []
    for group in reversed(groups):
        left = width - len(group[0].head) - 2
        beside = f"{group[0].head}: {_line(group[0], left)}"
        if len(group) == 1 and left >= constants.LEAST_BESIDE and ("…" not in beside or spare < 1):
            blocks.append([beside])
            continue
        spare -= len(group) == 1
        lines = [group[0].head]
        for item in group:
            whole = _wrapped(f"{_subject(item)}{_told(item)}", width)
            short = ["  " + _line(item, width - 2)]
            taken = whole if len(whole) - 1 <= spare else short
            spare -= len(taken) - 1
            lines += taken
        blocks.append(lines)
    if chosen and chosen[-1].remedy:
        remedy = _wrapped(f"remedy: {one_line(chosen[-1].remedy)}", width)
        if len(remedy) <= spare:
            blocks[0] += remedy
    return [line for block in reversed(blocks) for line in block]


def _wrapped(text: str, width: int) -> list[str]:
    return textwrap.wrap(text, width, initial_indent="  ", subsequent_indent="    ", break_on_hyphens=False)


def _subject(item: _Item) -> str:
    return ", ".join(map(one_line, item.subject)) + ": " if item.subject else ""


def _told(item: _Item) -> str:
    """What was found, and where the function is what it is compared with, what is intended."""
    stated = item.more is not None and item.code.startswith(constants.COMPARED)
    return f"{item.text}; intended: {one_line(item.more or '')}" if stated else item.text


def _line(item: _Item, room: int) -> str:
    """ "housing, shaft: 0.66 mm deep": the subject, and what was found."""
    text = _told(item)
    if not item.subject:
        return _cut(text, room)
    name = _names(item.subject, max(room - len(text) - 2, room // 2))
    return f"{name}: {_cut(text, room - len(name) - 2)}"


def _names(subject: Sequence[str], room: int) -> str:
    """The names with commas, each shortened to its share of the room where all do not fit."""
    names = [one_line(name) for name in subject]
    share = (room - 2 * (len(names) - 1)) // len(names)
    whole = ", ".join(names)
    return whole if len(whole) <= room else _cut(", ".join(shortened_ends(name, share) for name in names), room)


def _cut(text: str, room: int) -> str:
    return text if len(text) <= room else text[: max(room - 1, 1)].rstrip(" ,;:(") + "…"


def _notes(report: CheckReport, width: int) -> list[str]:
    """A line for each rule that has notes: how many, and about what."""
    notes = sorted((f for f in report.findings if f.severity == "note"), key=lambda f: f.code)
    lines = []
    for (code, rule), group in groupby(notes, lambda f: (f.code, f.rule)):
        subjects = list(dict.fromkeys(one_line(", ".join(f.subject)) for f in group))
        head = f"note: {code} {rule}: "
        many = f" and {len(subjects) - 1} more" if len(subjects) > 1 else ""
        lines.append(head + _names([subjects[0]], max(width - len(head) - len(many), 8)) + many)
    return lines


def _assumed(report: CheckReport, design: Design, width: int) -> list[str]:
    """One line for all that was skipped, assumed or read otherwise than it is stated."""
    told = list(_assumptions(report, design))
    return textwrap.wrap("; ".join(told), width, subsequent_indent="  ", break_on_hyphens=False) if told else []


def _assumptions(report: CheckReport, design: Design) -> Iterable[str]:
    skipped = sum(rule.outcome == "skipped" for rule in report.rules)
    why = " (-v says why)" if design.assembly.function.stated else " (no [function] is stated)"
    if skipped:
        yield f"skipped: {counted(skipped, 'rule')}{why}"
    if design.assembly.ground is None and design.kinematics is not None:
        ground = next((str(body.name) for body in design.kinematics.bodies if body.ground), None)
        if ground is not None:
            yield f"assumed ground: {shortened(one_line(ground), constants.BRIEF_NAME)}"
    if design.assembly.notes:
        yield f"{counted(len(design.assembly.notes), 'remark')} on what was read (-v)"
