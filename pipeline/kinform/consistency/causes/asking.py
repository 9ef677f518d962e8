"""What rules find of a design in which parts stand elsewhere, or have another size: the proof of a cause.

Contacts of pairs that did not change are taken over; joints are derived anew, and the rules that need no more than
both are asked again. Masses and motions are not computed: what rules say of these stays as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace

from kinform.consistency.context import Context
from kinform.consistency.control import Applied
from kinform.design import Design
from kinform.errors import KinformError
from kinform.frozen import dataclass
from kinform.model.assembly import Part
from kinform.model.findings import SEVERITIES, Finding
from kinform.model.surfaces import MeshSurfaces

ASKED = frozenset(
    "KF110 KF123 KF124 KF201 KF202 KF203 KF204 KF205 KF206 KF209 KF210 KF301 KF401 KF402 KF403 KF404 KF405 KF406 KF407 "
    "KF414 KF417 KF901".split()
)
"""Rules that need no more than contacts and joints, and whose findings a wrong place or size makes."""
SPOILT = frozenset({"KF201", "KF203", "KF204", "KF401", "KF402", "KF403", "KF404", "KF414"})
"""Those of them that are asked in any case: what a wrong motion would make worse."""
OF_JOINTS = frozenset({"KF401", "KF402", "KF403", "KF404", "KF405", "KF414"})
"""What is wrong with a stated joint: while one of them is found of it, none is resolved."""
Again = Callable[[Design, Collection[str]], Mapping[str, Applied]]
"""What these rules say of a design, under `[check]`."""
Key = tuple[str, tuple[str, ...]]


@dataclass(frozen=True, eq=False)
class Asked:
    """A design that was changed, and what became of findings."""

    design: Design
    findings: tuple[Finding, ...]
    """That are left, of the rules that were asked and of all others."""
    resolved: tuple[Finding, ...]

    @property
    def weight(self) -> tuple[int, ...]:
        """How many are resolved of each severity, the worst first."""
        return tuple(sum(f.severity == s for f in self.resolved) for s in reversed(SEVERITIES))


def is_serious(finding: Finding) -> bool:
    """Whether it is more than a note."""
    return finding.severity != "note"


def changed(context: Context, parts: Iterable[Part], surfaces: Mapping[str, MeshSurfaces]) -> Design:
    """The design with other parts of the same names, and its contacts; nothing later is known of it."""
    instead = {part.name: part for part in parts}
    every = tuple(instead.get(part.name, part) for part in context.assembly.parts)
    return _with_contacts(context, every, surfaces, instead.keys())


def without(context: Context, names: Collection[str]) -> Design:
    """The same without some parts, which nothing else names."""
    left = tuple(part for part in context.assembly.parts if part.name not in names)
    return _with_contacts(context, left, {}, names)


def _with_contacts(
    context: Context, parts: tuple[Part, ...], surfaces: Mapping[str, MeshSurfaces], other: Collection[str]
) -> Design:
    from kinform.contacts import find  # most designs need no second look

    design, known = context.design, context.design.contacts
    assert known is not None
    assembly = replace(context.assembly, parts=parts)
    every = {**design.surfaces, **surfaces}
    same = frozenset(pair for pair in known.candidates if not set(pair) & set(other))
    return replace(
        design, assembly=assembly, surfaces=every, contacts=find(assembly, every, reuse=known, reuse_pairs=same),
        kinematics=None, mass=None, behaviour=None, simulation=None, report=None,
    )  # fmt: skip


def overlapping(design: Design) -> set[tuple[str, str]]:
    """Pairs that overlap and are no fits."""
    found = design.contacts.interferences if design.contacts is not None else ()
    return {overlap.parts for overlap in found if not overlap.mated}


def asked(design: Design, before: Sequence[Finding], again: Again) -> Asked | None:
    """What is left of findings in a design whose contacts are known; None where something becomes worse, or nothing
    better."""
    from kinform.kinematics import derive

    assert design.contacts is not None
    try:
        kinematics = derive(design.assembly, design.surfaces, design.contacts)
    except KinformError:
        return None
    design = replace(design, kinematics=kinematics)
    codes = SPOILT | ({finding.code for finding in before} & ASKED)
    answers = again(design, codes)
    after = [finding for applied in answers.values() for finding in applied.findings]
    known = {_key(finding): SEVERITIES.index(finding.severity) for finding in before}
    doubted = {finding.subject for finding in before if finding.code in OF_JOINTS}
    for finding in after:
        worse = SEVERITIES.index(finding.severity) > known.get(_key(finding), -1)
        spoils = finding.code in SPOILT and finding.subject not in doubted
        if worse and (is_serious(finding) or spoils):
            return None
    left = {_key(finding) for finding in after}
    joints = {finding.subject for finding in after if finding.code in OF_JOINTS}
    decided = {code for code, applied in answers.items() if applied.outcome.outcome in ("passed", "failed", "ignored")}
    resolved = tuple(
        finding
        for finding in before
        if finding.code in decided
        and _key(finding) not in left
        and not (finding.code in OF_JOINTS and finding.subject in joints)
    )
    if not resolved:
        return None
    gone = {id(finding) for finding in resolved}
    return Asked(design, tuple(finding for finding in before if id(finding) not in gone), resolved)


def _key(finding: Finding) -> Key:
    return finding.code, finding.subject
