"""What may have been moved as a whole: a part, a link, a group, a sub-assembly, a body, a branch of a description."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from kinform.consistency.causes.asking import OF_JOINTS, is_serious
from kinform.consistency.context import Context
from kinform.frozen import dataclass
from kinform.model.descriptions import DescribedLink, Description
from kinform.model.findings import Finding

SETS = 8
"""Sets of parts that are tried, at most: the ones that most findings are about."""


@dataclass(frozen=True)
class Movable:
    """Parts that keep their places to each other."""

    name: str
    """Of the part, link, group, sub-assembly or body; of a branch, of its first link."""
    parts: frozenset[str]
    branch: bool = False
    """A link with all that hangs on it."""


def parts_of(context: Context, name: str) -> tuple[str, ...]:
    """The parts that a word of a subject stands for: those of a part, group, body, or of both sides of a joint."""
    assembly = context.assembly
    if name in assembly.named_parts:
        return (name,)
    if name in assembly.named_groups:
        return tuple(map(str, assembly.named_groups[name].parts))
    stated = next((joint for joint in context.function.joints if joint.name == name), None)
    if stated is not None:
        return tuple(str(part) for side in stated.between for part in assembly.parts_of(side))
    kinematics = context.design.kinematics
    if kinematics is None:
        return ()
    joint = kinematics.named_joints.get(name)
    sides = (name,) if joint is None else joint.bodies
    bodies = [body for side in sides if (body := kinematics.named_bodies.get(side)) is not None]
    return tuple(str(part) for body in bodies for part in body.parts)


def movables(context: Context, findings: Sequence[Finding]) -> list[Movable]:
    """What the findings are about, as sets of parts that may be moved, the ones that most are about first; at most
    half of all parts, or a branch."""
    of_links = bool(context.assembly.descriptions)
    counts: Counter[Movable] = Counter()
    for finding in findings:
        if not is_serious(finding) and not (of_links and finding.code in OF_JOINTS | {"KF203", "KF201"}):
            continue
        about = {part for name in finding.subject for part in parts_of(context, name)}
        tried = {one for part in about for one in _around(context, part)}
        if finding.code == "KF203" and len(about) > 1:
            tried.add(Movable(finding.subject[0], frozenset(about)))
        for one in tried:
            if not about <= one.parts or len(about) == 1 or one.parts <= about:
                counts[one] += 1 + 10 * is_serious(finding)
    ground = grounded(context)
    half = max(1, len(context.assembly.parts) // 2)
    # of the same parts the first name: a link of one part has its name
    sets: dict[tuple[frozenset[str], bool], Movable] = {}
    for one in sorted(counts, key=lambda one: (one.branch, one.name)):
        if len(one.parts) <= half or (one.branch and one.parts.isdisjoint(ground)):
            sets.setdefault((one.parts, one.branch), one)
    ordered = sorted(sets.values(), key=lambda s: (-counts[s], not s.parts.isdisjoint(ground), len(s.parts), s.name))
    return ordered[:SETS]


def grounded(context: Context) -> frozenset[str]:
    """The parts at rest."""
    kinematics = context.design.kinematics
    if kinematics is None:
        return frozenset()
    return frozenset(str(part) for body in kinematics.bodies if body.ground for part in body.parts)


def _around(context: Context, part: str) -> Iterator[Movable]:
    """The sets that a part is of."""
    assembly = context.assembly
    yield Movable(part, frozenset({part}))
    for group in assembly.groups:
        if part in group.parts:
            yield Movable(group.name, frozenset(map(str, group.parts)))
    prefix = part
    while "/" in prefix:
        prefix = prefix.rpartition("/")[0]
        yield Movable(prefix, frozenset(str(p.name) for p in assembly.parts if p.name.startswith(prefix + "/")))
    kinematics = context.design.kinematics
    body = None if kinematics is None else next((b for b in kinematics.bodies if part in b.parts), None)
    if body is not None and len(body.parts) > 1:
        yield Movable(body.name, frozenset(map(str, body.parts)))
    for description in assembly.descriptions:
        for link in description.links:
            if part in link.parts:
                yield Movable(link.name, frozenset(link.parts))
                yield Movable(link.name, frozenset(_branch(description, link)), branch=True)


def _branch(description: Description, link: DescribedLink) -> Iterable[str]:
    """The parts of a link and of all links that hang on it."""
    below = {link.name}
    grown = True
    while grown:
        more = {joint.between[1] for joint in description.joints if joint.between[0] in below} - below
        below |= more
        grown = bool(more)
    return [part for one in description.links if one.name in below for part in one.parts]
