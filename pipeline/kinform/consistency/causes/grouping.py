"""Findings by cause: what a report states is one finding for each cause, and its members are kept beside it.

A cause has the code of its worst member, its severity, its place and its witness; so an ignore, a severity or a
baseline means what it meant. `[check]` is applied before: what is ignored is no member.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from kinform.consistency.causes.asking import Again, asked, is_serious, without
from kinform.consistency.causes.displaced import Displaced, displaced
from kinform.consistency.causes.layouts import layout
from kinform.consistency.causes.remedies import numbers, placing, vector_words
from kinform.consistency.causes.repeated import repeated
from kinform.consistency.causes.scaled import Scaled, scaled
from kinform.consistency.comparisons.gathering import ALIKE_MOST
from kinform.consistency.context import Context
from kinform.consistency.questions.copies_in_place import copies_in_place
from kinform.foundation.units import METRES_PER_UNIT
from kinform.foundation.words import counted, few, number, quoted
from kinform.model.findings import SEVERITIES, Cause, CauseKind, Finding
from kinform.requirements.answer import triple

MOST_MOVED = 3
"""Parts in wrong places that are looked for, one after the other. A choice."""
MOST_FINDINGS = 2000
"""Findings about which motions and scales are tried, at most. A choice."""
FEW_WARNINGS = 6
"""Warnings of one rule on a robot description that stand alone: the sides of three joints. Of more, nobody reads the
last."""
OF_CONTACT = ("KF20", "KF21", "KF3", "KF40", "KF414", "KF417", "KF90")
"""What follows from contacts, by how codes begin."""

OF_PLACES = ("KF110", "KF124", "KF201", "KF203", "KF401")
"""What parts in wrong places, or of wrong sizes, make: without any of these no motion and no factor is looked for, as
that takes seconds. An axis beside the stated one alone (KF404) is a matter of what is stated."""
PROVED = ("frame", "displaced", "scaled")
"""Causes that are at least a warning."""

Grouped = tuple[list[Finding], list[Finding]]
"""Findings that stand, one for each cause, and the members of those that state causes."""


def by_cause(context: Context, findings: Sequence[Finding], again: Again) -> Grouped:
    """The findings, one for each cause that is proved, and their members."""
    told, members = list[Finding](), list[Finding]()
    left = list(findings)

    def put(stated: Finding, of: Sequence[Finding]) -> None:
        nonlocal left
        gone = {id(finding) for finding in of}
        left = [finding for finding in left if id(finding) not in gone]
        told.append(stated)
        members.extend(replace(finding, cause=stated.cause) for finding in of)

    judged = context.lacks("contacts") is None or any(finding.code == "KF110" for finding in left)
    if judged and (any(map(is_serious, left)) or context.assembly.descriptions):
        _geometric(context, left, again, put, lambda: left)
    for group in repeated(context, left):
        put(_repeated(group), group)
    if context.assembly.check.profile == "description":
        for many in _many(left):
            put(_rest(many), many)
    return [*told, *left], members


Put = Callable[[Finding, Sequence[Finding]], None]


def _geometric(
    context: Context, findings: Sequence[Finding], again: Again, put: Put, left: Callable[[], list[Finding]]
) -> None:
    """Causes that places and sizes of parts are."""
    whole = layout(context) if context.lacks("contacts") is None else None
    if whole is not None:
        members = [finding for finding in findings if finding.code.startswith(OF_CONTACT)]
        if len(members) > 1 and any(map(is_serious, members)):
            put(_stated(members, whole.kind, whole.parts, whole.message, whole.found, whole.remedy), members)
            return
    _duplicated(context, again, put, left)
    if len(left()) > MOST_FINDINGS or not context.design.surfaces or context.design.contacts is None:
        return
    if not any(finding.code in OF_PLACES for finding in left()):
        return
    found = scaled(context, left(), again)
    if found is not None:
        put(_scaled(context, found), found.asked.resolved)
        context = Context(found.asked.design, context.judges)
    for _ in range(MOST_MOVED):
        moved = displaced(context, left(), again)
        if moved is None:
            return
        put(_displaced(context, moved), moved.asked.resolved)
        context = Context(moved.asked.design, context.judges)


def _duplicated(context: Context, again: Again, put: Put, left: Callable[[], list[Finding]]) -> None:
    """Copies in one place, with what is found because of them."""
    pairs = {(str(first.name), str(second.name)) for first, second in copies_in_place(context.assembly)}
    found = [finding for finding in left() if finding.code == "KF201" and finding.subject in pairs]
    if not found:
        return
    extra = {finding.subject[1] for finding in found}
    members: Sequence[Finding] = found
    if not extra & _named(context):
        after = asked(without(context, extra), left(), again)
        if after is not None:
            about = [f for f in after.resolved if f in found or extra & set(f.subject) or _of_bodies(context, f, extra)]
            members = about if set(map(id, found)) <= set(map(id, about)) else found
    names = tuple(dict.fromkeys(name for finding in found for name in finding.subject))
    if len(found) == 1:
        message, told = found[0].message, found[0].found or ""
    else:
        pairs_told = [f"'{a}' and '{b}'" for a, b in (finding.subject for finding in found[:4])]
        more = f" and {len(found) - 4} more" if len(found) > 4 else ""
        message = (
            f"{counted(len(found), 'part')} are there twice in one place: {', '.join(pairs_told)}{more}; their mass "
            "counts twice"
        )
        told = f"{counted(len(found), 'part')} twice in one place"
    remedy = (
        f"Remove {quoted(sorted(extra))}, or move {'it to its place' if len(extra) == 1 else 'them to their places'}."
    )
    put(_stated(members, "duplicated", names, message, told, remedy), members)


def _named(context: Context) -> set[str]:
    """Parts that something else of the assembly names."""
    assembly = context.assembly
    names = {str(part) for group in assembly.groups for part in group.parts}
    names |= {name for joint in assembly.function.joints for name in joint.between}
    names |= {name for assumption in assembly.assumptions for name in assumption.between}
    names |= {part for description in assembly.descriptions for link in description.links for part in link.parts}
    function = assembly.function
    names |= {getattr(load, "part", "") for load in function.loads}
    return names | ({assembly.ground} if assembly.ground else set())


def _of_bodies(context: Context, finding: Finding, names: set[str]) -> bool:
    """Whether it is about a joint or body of one of these parts."""
    from kinform.consistency.causes.movable import parts_of

    return any(names & set(parts_of(context, word)) for word in finding.subject)


def _displaced(context: Context, found: Displaced) -> Finding:
    """A motion as a finding."""
    motion, resolved = found.motion, found.asked.resolved
    moved, gone = motion.moved, counted(len(resolved), "finding")
    vanish = "this finding vanishes" if len(resolved) == 1 else f"all {gone} vanish"
    what = f"link '{moved.name}'" if moved.branch or motion.frame else f"'{moved.name}'"
    if motion.whole:
        many = counted(len(moved.parts), "mesh", "meshes")
        message = (
            f"{many} are in the frame of link '{motion.frame}', not of their own links: read in that frame, {vanish}"
        )
        links = sorted(
            {link.name for d in context.assembly.descriptions for link in d.links if set(link.parts) & moved.parts}
        )
        remedy = f"Export the meshes of {quoted(links)} in the frames of their links."
        subject = tuple(links)
        return _stated(resolved, "frame", subject, message, f"{many} in the frame of '{motion.frame}'", remedy)
    if len(moved.parts) > 1 and not motion.frame:
        what += f" with {counted(len(moved.parts), 'part')}"
    first = context.assembly.part(min(moved.parts))
    shift = (motion.X @ first.X_WP)[:3, 3] - first.X_WP[:3, 3]
    vector, off = vector_words(shift, context.units), vector_words(-shift, context.units)
    remedy = placing(context, moved, motion.X)
    if found.alternative is not None:
        remedy += f" Or: {placing(context, found.alternative.moved, found.alternative.X)}"
    if motion.frame:
        message = (
            f"the mesh of {what} is in the frame of link '{motion.frame}': it is displaced by {off}, as the frame of "
            f"the link is from there; read in that frame, {vanish}"
        )
        found_words = f"mesh in the frame of '{motion.frame}', displaced by {off}"
        remedy += " Or export the mesh in the frame of its link."
        kind: CauseKind = "frame"
    else:
        worst = max(resolved, key=lambda finding: SEVERITIES.index(finding.severity))
        message = f"{what} is displaced: moved by {vector}, it fits, and {vanish}; the worst of them: {worst.message}"
        found_words = f"displaced; moved by {vector}, {vanish}"
        kind = "displaced"
    return _stated(resolved, kind, (moved.name,), message, found_words, remedy, shift=shift)


def _scaled(context: Context, found: Scaled) -> Finding:
    """A factor as a finding."""
    resolved, factor = found.asked.resolved, found.factor
    vanish = "this finding vanishes" if len(resolved) == 1 else f"all {counted(len(resolved), 'finding')} vanish"
    times = f"{number(1.0 / factor)} times too large" if factor < 1.0 else f"{number(factor)} times too small"
    applied = f"divided by {number(1.0 / factor, 6)}" if factor < 1.0 else f"multiplied by {number(factor, 6)}"
    if found.whole:
        what, verb = f"the meshes of all {len(found.parts)} parts", "are"
    else:
        what, verb = quoted(found.parts), "is"
    parts = [context.assembly.part(name) for name in found.parts]
    scale = " ".join(numbers(np.asarray(parts[0].scale) * factor, 1.0))
    if context.assembly.descriptions:
        remedy = f'Write scale="{scale}" in <mesh>.'
    else:
        unit = next(
            (u for u, m in METRES_PER_UNIT.items() if abs(m / METRES_PER_UNIT[parts[0].units] / factor - 1) < 1e-6),
            None,
        )
        remedy = f'Write `units = "{unit}"` at the part.' if unit else f"Export the mesh again, {applied}."
    message = f"{what} {verb} {times}: {applied}, {vanish}"
    told = f"{times}; {applied}, {vanish}"
    return _stated(resolved, "scaled", found.parts, message, told, remedy, scale=factor)


def _repeated(group: Sequence[Finding]) -> Finding:
    """Findings about the same shapes as one: the worst, which is the first, and how many."""
    first = group[0]
    others = [finding for finding in group if (finding.code, finding.severity) == (first.code, first.severity)][1:]
    names = [" and ".join(f"'{name}'" for name in finding.subject) for finding in others[:3]]
    more = f" and {len(others) - 3} more" if len(others) > 3 else ""
    message = f"{first.message}; {len(others) + 1} times, of the same shapes: likewise {', '.join(names)}{more}"
    told = f"{len(others) + 1} times: {first.found}" if first.found else f"{len(others) + 1} times"
    return _stated(group, "repeated", first.subject, message, told, first.remedy)


def _many(findings: Sequence[Finding]) -> Iterator[list[Finding]]:
    """Of many warnings of one rule all but the first, which are the worst."""
    warnings: dict[str, list[Finding]] = {}
    for finding in findings:
        if finding.severity == "warning":
            warnings.setdefault(finding.code, []).append(finding)
    yield from (found[ALIKE_MOST:] for found in warnings.values() if len(found) > FEW_WARNINGS)


def _rest(group: Sequence[Finding]) -> Finding:
    """Warnings of one rule on a description that nobody reads one by one."""
    about = [" and ".join(f"'{name}'" for name in finding.subject[:2]) for finding in group]
    message = f"{len(group)} more of this rule, none worse: {few(about)}"
    names = tuple(dict.fromkeys(name for finding in group for name in finding.subject))
    return replace(
        _stated(group, "alike", names, message, f"{len(group)} more, none worse", group[0].remedy), place=None
    )


def _stated(
    members: Sequence[Finding],
    kind: CauseKind,
    subject: Sequence[str],
    message: str,
    found: str,
    remedy: str | None,
    shift: Iterable[float] | None = None,
    scale: float | None = None,
) -> Finding:
    """The finding that states a cause: the worst of its members in other words."""
    worst = max(members, key=lambda finding: SEVERITIES.index(finding.severity))
    key = f"{kind} {worst.code} {', '.join(subject)}"
    vector = None if shift is None else triple(shift)
    cause = Cause(kind, key, vector, scale)
    # of notes alone: what is proved to be in a wrong place or size is more than that
    severity = "warning" if worst.severity == "note" and kind in PROVED else worst.severity
    intended = worst.intended if kind == "repeated" else None
    return replace(
        worst,
        severity=severity,
        subject=tuple(subject),
        message=message,
        found=found,
        intended=intended,
        remedy=remedy,
        cause=cause,
    )
