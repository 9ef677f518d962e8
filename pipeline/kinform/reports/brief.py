"""What matters of a check, on one screen: the verdict, what weighs least, and the worst findings nearest the prompt.

A finding takes one line, names are shortened in their middle; `full` has every word. Rules that could not decide stand
between warnings and errors: without errors they are what keeps a design from being verified.
"""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import groupby
from typing import Literal, get_args

from kinform.consistency import verdict_of
from kinform.design import Design
from kinform.foundation.escapes import one_line
from kinform.foundation.words import counted, shortened, shortened_ends
from kinform.frozen import dataclass
from kinform.function.body_titles import body_titles
from kinform.model.findings import CheckReport, Finding
from kinform.reports.constants import QUIET_NOTES, WIDTH
from kinform.reports.phrases import answers_line, rule_counts, severity_counts

MOST_BRIEF = 7
"""Findings that are told line by line, the worst; with all that stands around them they fill a screen of 24 lines."""
LEAST_BRIEF = 5
"""Findings that are told line by line though what was found has to be cut; above, fewer are told, and whole."""
BRIEF_LINES = 21
"""Lines up to which single findings that do not fit beside their rule take a second one: a screen of 24, without the
two of the next commands and the prompt."""
COMPARED = ("KF3", "KF4")
"""Rules, by how their codes begin, that compare with what is stated: what was found says little without it."""
TOLD_NOTES = ("KF509",)
"""Rules whose notes stand on the first screen with all that was found: what was simulated at all."""
LEAST_NAME = 12
"""Characters of the name of a part to which names are shortened before what was found is: both its ends are still
recognised. Where less than that is left beside a rule, a finding goes below it. Chosen, not measured."""
MANY_JOINTS = 9
"""Derived joints from which a design without a complete function is told how it gets fewer: contact alone counts each
part that is screwed on; few mechanisms are meant to have so many. A choice."""
BRIEF_NAME = 28
"""Characters of the name of the ground: with the rest of its line it fits in 80."""


ItemKind = Literal["warning", "not decided", "error"]
_KINDS: tuple[ItemKind, ...] = get_args(ItemKind)
"""What is told line by line, the worst last."""


@dataclass(frozen=True)
class _Item:
    """A finding that is no note, or a rule that could not decide."""

    kind: ItemKind
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


def render(report: CheckReport, design: Design, fail_on: str = "error", *, width: int = WIDTH) -> str:
    """Verdict and counts; a line for each group of notes; what was skipped or assumed; the worst findings, the worst
    last. No line is longer than `width`, unless it has one word that is."""
    name = shortened(one_line(design.assembly.name), width // 2)
    verdict = verdict_of(report, fail_on)
    heads = (f"{name}: {one_line(verdict.line)}", one_line(verdict.coverage), _counted(report))
    lines = [line for head in heads for line in textwrap.wrap(head, width, subsequent_indent="  ")]
    lines += _notes(report, width)
    lines += _assumed(report, design, width)
    lines += _many_joints(design, width)
    if report.answers:
        lines += textwrap.wrap(f"intended joints: {answers_line(report.answers)}", width, subsequent_indent="  ")
    items = _items(report)
    for most in range(MOST_BRIEF, LEAST_BRIEF - 1, -1):
        chosen, rest = _worst(items, most)
        more = _more(rest, width)
        told, whole = _groups(chosen, width, BRIEF_LINES - len(lines) - len(more))
        if whole:
            break
    return "\n".join([*lines, *more, *told]) + "\n"


def _counted(report: CheckReport) -> str:
    return f"{severity_counts(report)}; {rule_counts(report)}"


def _more(rest: Sequence[_Item], width: int) -> list[str]:
    """How many are not told line by line, by kind and rule."""
    if not rest:
        return []
    told = []
    for kind, others in groupby(reversed(rest), lambda item: item.kind):
        codes = Counter(item.code for item in others)
        told.append(f"{kind}: " + ", ".join(f"{many} {code}" for code, many in sorted(codes.items())))
    return textwrap.wrap(f"and {len(rest)} more (-v shows all): {'; '.join(told)}", width, subsequent_indent="  ")


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


def _worst(items: Sequence[_Item], most: int) -> tuple[list[_Item], list[_Item]]:
    """At most so many findings to be shown, the worst last, and the others. Of each kind every rule has its turn: many
    findings of one do not hide the only one of another."""
    turns: Counter[str] = Counter()
    ranked = []
    for place, item in enumerate(items):
        ranked.append((-_KINDS.index(item.kind), turns[item.head], place))
        turns[item.head] += 1
    shown = {place for _, _, place in sorted(ranked)[:most]}
    chosen = [item for place, item in enumerate(items) if place in shown]
    chosen.sort(key=lambda item: _KINDS.index(item.kind))
    return chosen, [item for place, item in enumerate(items) if place not in shown]


def _groups(chosen: Sequence[_Item], width: int, room: int) -> tuple[list[str], bool]:
    """One line a finding, below the rule that they have in common; a single one stands beside it where it fits. Lines
    of the `room` that are left are spent, for the worst first, on what would be cut, then on whole names, then on the
    remedy of the worst. Also whether all that was found is told whole."""
    groups = [list(group) for _, group in groupby(chosen, lambda item: item.head)]
    blocks = [_Block(group, width) for group in groups]
    spare = room - sum(block.lines for block in blocks)
    for level in (1, 2):
        for block in reversed(blocks):
            spare = block.raise_to(level, spare)
    remedy = _wrapped(f"remedy: {one_line(chosen[-1].remedy)}", width) if chosen and chosen[-1].remedy else []
    lines = [line for block in blocks for line in block.text()] + (remedy if len(remedy) <= spare else [])
    return lines, all(block.whole for block in blocks)


class _Block:
    """The findings of one rule. Each has three forms, no shorter than the one before: in one line, cut where it must
    be; with what was found whole, and names shortened; all whole."""

    def __init__(self, group: Sequence[_Item], width: int):
        if len(group) == 1:
            self._head: list[str] = []
            self._forms = [_single(group[0], width)]
        else:
            self._head = [group[0].head]
            self._forms = [_below(item, width) for item in group]
        self._level = [0] * len(group)

    @property
    def lines(self) -> int:
        """How many it takes now."""
        return len(self.text())

    @property
    def whole(self) -> bool:
        """Whether nothing that was found is cut."""
        return min(self._level) > 0

    def text(self) -> list[str]:
        """Its lines."""
        forms = zip(self._forms, self._level, strict=True)
        return [*self._head, *(line for form, level in forms for line in form[level])]

    def raise_to(self, level: int, spare: int) -> int:
        """Give its findings this form as far as there are lines to spare; returns how many are left."""
        for k, form in enumerate(self._forms):
            more = len(form[level]) - len(form[self._level[k]])
            if self._level[k] == level - 1 and more <= spare:
                self._level[k] = level
                spare -= more
        return spare


def _below(item: _Item, width: int) -> list[list[str]]:
    """The forms of a finding that stands below its rule."""
    whole = _wrapped(f"{_subject(item)}{_told(item)}", width)
    short = _uncut(item, width - 2)
    return [["  " + _line(item, width - 2)], whole if short is None else ["  " + short], whole]


def _single(item: _Item, width: int) -> list[list[str]]:
    """The forms of the only finding of its rule: beside it where there is room."""
    below = [[item.head, *form] for form in _below(item, width)]
    left = width - len(item.head) - 2
    if left < LEAST_NAME:
        return below
    uncut = _uncut(item, left)
    whole = f"{item.head}: {_subject(item)}{_told(item)}"
    return [
        [f"{item.head}: {_line(item, left)}"],
        below[1] if uncut is None else [f"{item.head}: {uncut}"],
        [whole] if len(whole) <= width else below[2],
    ]


def _wrapped(text: str, width: int) -> list[str]:
    return textwrap.wrap(text, width, initial_indent="  ", subsequent_indent="    ", break_on_hyphens=False)


def _subject(item: _Item) -> str:
    return ", ".join(map(one_line, item.subject)) + ": " if item.subject else ""


def _told(item: _Item) -> str:
    """What was found, and where the function is what it is compared with, what is intended."""
    stated = item.more is not None and item.code.startswith(COMPARED)
    return f"{item.text}; intended: {one_line(item.more or '')}" if stated else item.text


def _line(item: _Item, room: int) -> str:
    """ "housing, shaft: 0.66 mm deep": the subject, and what was found, in one line."""
    text = _told(item)
    if not item.subject:
        return _cut(text, room)
    name = _names(item.subject, max(room - len(text) - 2, room // 2))
    return f"{name}: {_cut(text, room - len(name) - 2)}"


def _uncut(item: _Item, room: int) -> str | None:
    """The same with all that was found; None where the names would not be recognised any more."""
    text = _told(item)
    left = room - len(text) - 2
    bodies = [body for name in item.subject for body in one_line(name).split("~")]
    least = sum(min(len(body), LEAST_NAME) for body in bodies) + 2 * len(bodies) - 2
    if not item.subject:
        return text if len(text) <= room else None
    return f"{_names(item.subject, left)}: {text}" if left >= least else None


def _names(subject: Sequence[str], room: int) -> str:
    """The names with commas, in full where they fit; else the longest are shortened, all to the same length."""
    names = [one_line(name) for name in subject]
    left, share = room - 2 * (len(names) - 1), room
    for k, name in enumerate(sorted(names, key=len)):
        share = left // (len(names) - k)
        if len(name) > share:
            break
        left -= len(name)
    return _cut(", ".join(shortened_ends(name, max(share, 3)) for name in names), room)


def _cut(text: str, room: int) -> str:
    """The text up to the last word that fits."""
    if len(text) <= room:
        return text
    kept = text[: max(room - 1, 1)]
    if not text[len(kept)].isspace() and " " in kept[len(kept) // 2 :]:
        kept = kept.rpartition(" ")[0]
    return kept.rstrip(" ,;:(") + "…"


def _notes(report: CheckReport, width: int) -> list[str]:
    """A line for each rule that has notes: how many, and about what; what the verdict stands on is told in full."""
    undecided = {rule.code for rule in report.rules if rule.outcome == "inconclusive"}
    notes = sorted(
        (f for f in report.findings if f.severity == "note" and f.code not in QUIET_NOTES), key=lambda f: f.code
    )
    lines = []
    for (code, rule), group in groupby(notes, lambda f: (f.code, f.rule)):
        if code in TOLD_NOTES:
            if code not in undecided:
                lines += _in_full(next(group), width)
            continue
        subjects = list(dict.fromkeys(one_line(", ".join(f.subject)) for f in group))
        head = f"note: {code} {rule}: "
        many = f" and {len(subjects) - 1} more" if len(subjects) > 1 else ""
        lines.append(head + _names([subjects[0]], max(width - len(head) - len(many), 8)) + many)
    return lines


def _in_full(note: Finding, width: int) -> list[str]:
    """A note with all of what was found."""
    text = f"note: {note.code} {note.rule}: {one_line(note.found or note.message)}"
    return textwrap.wrap(text, width, subsequent_indent="  ", break_on_hyphens=False)


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
        titles = body_titles(design.assembly, design.kinematics)
        ground = next((titles.get(b.name, str(b.name)) for b in design.kinematics.bodies if b.ground), None)
        if ground is not None:
            yield f"assumed ground: {shortened(one_line(ground), BRIEF_NAME)} (`ground` in [assembly])"
    if design.assembly.notes:
        yield f"{counted(len(design.assembly.notes), 'remark')} on what was read (-v)"


def _many_joints(design: Design, width: int) -> list[str]:
    """Where contact alone tells the joints, and there are many: how to have those that are meant."""
    function, kinematics = design.assembly.function, design.kinematics
    if kinematics is None or function.complete or len(kinematics.joints) < MANY_JOINTS:
        return []
    many = f"{counted(len(kinematics.joints), 'joint')} between {counted(len(design.assembly.parts), 'part')}"
    advice = "if too many, take over those that `kinform init` proposes, with `complete = true`"
    return textwrap.wrap(f"{many}: {advice}", width, subsequent_indent="  ", break_on_hyphens=False)
