"""Parts that one motion puts right: moved by a vector, or their meshes read in the frame of another link.

A vector is proposed where surfaces of the parts would mate after it (`mates`), or where a description has it: the pose
of a link's frame. It is a cause only where rules that are asked again, of the parts in their new places, find less and
nothing worse.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from kinform.consistency.causes.asking import Again, Asked, asked, changed, is_serious, overlapping
from kinform.consistency.causes.mates import mates_of, vectors
from kinform.consistency.causes.movable import Movable, grounded, movables, parts_of
from kinform.consistency.causes.remedies import pose_in_file, pose_of, rounded
from kinform.consistency.context import Context
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part
from kinform.model.descriptions import DescribedLink
from kinform.model.findings import Finding

CONTACTS_TRIED = 16
"""Motions of which contacts are looked for, at most, in search of one cause, ..."""
JOINTS_TRIED = 8
"""... and of which joints are derived: those after which no more pairs overlap; ..."""
PARTS_TRIED = 300
"""... fewer of many parts: so many parts in all of designs whose joints are derived, and five times as many of those
whose contacts are looked for. Joints of 100 parts take a second or more."""
GAP = 0.5
"""Share of the smallest part that is moved: gaps of descriptions, whose pins and bearings are in no mesh, are smaller.
Chosen, not measured."""
MISPLACED = ("KF201", "KF203", "KF401", "KF404")
"""What a part in a wrong place makes: it is in another, or does not touch what it belongs to, or is beside it. Contact
alone that is not meant says nothing of the place, as it goes wherever the part goes."""
LEAST_RESOLVED = 2
"""Findings that a vector has to resolve of which single surfaces decide some: one overlap vanishes in many places."""
SURFACES = 4_000_000
"""Pairs of surfaces that are compared for one set of parts, at most: half a second. Of more, none are."""


@dataclass(frozen=True, eq=False)
class Motion:
    """A hypothesis: these parts, moved so, are right."""

    moved: Movable
    X: Array
    """(4, 4) in the world."""
    frame: str = ""
    """The link in whose frame the meshes are; "" where they are only moved."""
    confirmed: bool = True
    """No single surface decides some of it."""
    whole: bool = False
    """All links have their meshes in that frame."""


@dataclass(frozen=True, eq=False)
class Displaced:
    """A motion that is proved, and what it resolves."""

    motion: Motion
    asked: Asked
    alternative: Motion | None = None
    """Another that resolves as much: the joint of a link moved instead of its mesh, the other side of a gap."""


def displaced(context: Context, findings: Sequence[Finding], again: Again) -> Displaced | None:
    """The motion that resolves most, if any does; of several the least."""
    sets = movables(context, findings)
    if not sets:
        return None
    tried, proved = 0, list[tuple[Motion, Asked]]()
    before, many = overlapping(context.design), len(context.assembly.parts)
    if many > PARTS_TRIED:
        return None
    most, most_joints = min(CONTACTS_TRIED, 5 * PARTS_TRIED // many), min(JOINTS_TRIED, PARTS_TRIED // many)
    for count, motion in enumerate(_hypotheses(context, sets, findings)):
        if count >= most or tried >= most_joints or (proved and not motion.confirmed):
            break
        design = changed(context, _moved(context, motion), {})
        if not overlapping(design) <= before:
            continue
        tried += 1
        found = asked(replace(design, assembly=_with_joints(design.assembly, motion)), findings, again)
        if found is not None and explains(motion, found.resolved) and not _unfit(context, motion, found):
            proved.append((motion, found))
    if not proved:
        return None
    ground = grounded(context)
    # the best first, rather what is not on the ground; sorting keeps the order in which they were proposed
    proved.sort(key=lambda item: (*(-count for count in item[1].weight), not ground.isdisjoint(item[0].moved.parts)))
    (best, found), others = proved[0], proved[1:]
    alternative = next((m for m, a in others if a.weight == found.weight and m.moved != best.moved), None)
    return Displaced(best, found, alternative)


def explains(motion: Motion, resolved: Sequence[Finding]) -> bool:
    """Whether what is resolved tells that the parts are in a wrong place, and not only that they are not elsewhere."""
    enough = motion.confirmed or len(resolved) >= LEAST_RESOLVED
    return bool(motion.frame) or (enough and any(one.code in MISPLACED for one in resolved))


def _unfit(context: Context, motion: Motion, found: Asked) -> bool:
    """Whether the parts still overlap others in their new places: they are in a wrong place there too."""
    left = (finding for finding in found.findings if finding.code == "KF201" and is_serious(finding))
    return not motion.whole and any(not motion.moved.parts.isdisjoint(finding.subject) for finding in left)


def _far(context: Context, motion: Motion) -> bool:
    """Whether it is farther than a gap that a part which is in no mesh would fill."""
    meshes = [mesh for name in motion.moved.parts if (mesh := context.assembly.part(name).mesh) is not None]
    return float(np.linalg.norm(motion.X[:3, 3])) > GAP * min((mesh.diagonal for mesh in meshes), default=np.inf)


def _hypotheses(context: Context, sets: Sequence[Movable], findings: Sequence[Finding]) -> Iterator[Motion]:
    """Frames that a description has, then vectors that surfaces agree on, the ones first after which most mate. Of
    parts that only notes are about, vectors that are longer than gaps are."""
    words = (word for finding in findings if is_serious(finding) for word in finding.subject)
    doubted = {part for word in words for part in parts_of(context, word)}
    yield from _frames(context, sets)
    ranked: list[tuple[bool, float, float, int, Motion]] = []
    for place, one in enumerate(sets):
        for vector, gain, confirmed in _vectors(context, one):
            X = np.eye(4)
            X[:3, 3] = rounded(vector)
            if not one.parts.isdisjoint(doubted) or _far(context, Motion(one, X)):
                ranked.append(
                    (not confirmed, -gain, float(np.linalg.norm(vector)), place, Motion(one, X, confirmed=confirmed))
                )
    ranked.sort(key=lambda item: item[:4])
    yield from (motion for *_, motion in ranked)


def _vectors(context: Context, one: Movable) -> list[tuple[Array, float, bool]]:
    """Translations of these parts after which more of their surfaces mate, no farther than they are large."""
    inside, outside = list[Part](), list[Part]()
    for part in context.assembly.parts:
        if part.mesh is not None:
            (inside if part.name in one.parts else outside).append(part)
    if not inside:
        return []
    low, high = _box(inside)
    longest = float(np.linalg.norm(high - low))
    near = [part for part in outside if _near(part, low - longest, high + longest)]
    if not near or surface_count(context, inside) * surface_count(context, near) > SURFACES:
        return []
    return vectors(mates_of(inside, near, context.design.surfaces), longest)


def surface_count(context: Context, parts: Sequence[Part]) -> int:
    """How many surfaces the meshes of parts have."""
    digests = [part.mesh.digest for part in parts if part.mesh is not None]
    return sum(len(context.design.surfaces[digest].surfaces) for digest in digests)


def _box(parts: Sequence[Part]) -> tuple[Array, Array]:
    boxes = np.array([part.mesh.placed_box(part.X_WP) for part in parts if part.mesh is not None])
    return boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)


def _near(part: Part, low: Array, high: Array) -> bool:
    assert part.mesh is not None
    lowest, highest = part.mesh.placed_box(part.X_WP)
    return bool((lowest <= high).all() and (highest >= low).all())


def _frames(context: Context, sets: Sequence[Movable]) -> Iterator[Motion]:
    """Links whose meshes may be in the frame of the first link, or of their parent; all links at once first."""
    for description in context.assembly.descriptions:
        links = {link.name: link for link in description.links}
        if not links:
            continue
        root = description.links[0]
        off = {name: X for name, link in links.items() if (X := _into(context, link, root)) is not None}
        named = [links[one.name] for one in sets if not one.branch and one.parts == frozenset(_parts(links, one.name))]
        if len(off) > 1 and len([link for link in named if link.name in off]) > 1:
            every = frozenset(part for name in off for part in links[name].parts)
            yield Motion(Movable(root.name, every), np.eye(4), root.name, whole=True)
        parents = {joint.between[1]: joint.between[0] for joint in description.joints}
        for link in named:
            for name in dict.fromkeys((root.name, parents.get(link.name, root.name))):
                X = _into(context, link, links[name]) if name in links else None
                if X is not None:
                    yield Motion(Movable(link.name, frozenset(link.parts)), X, name)


def _parts(links: dict[str, DescribedLink], name: str) -> tuple[str, ...]:
    return links[name].parts if name in links else ()


def _into(context: Context, link: DescribedLink, other: DescribedLink) -> Array | None:
    """The motion (4, 4) that puts the mesh files of a link into the frame of another; None where they are there, or are
    not taken as in the frame of their link."""
    parts = [context.assembly.part(name) for name in link.parts]
    if link is other or not parts or any(part.mesh is None for part in parts):
        return None
    poses = [pose_in_file(part) for part in parts]
    size = max(part.mesh.diagonal for part in parts if part.mesh is not None)
    if not all(np.allclose(X, pose_of(link), atol=1e-3 * size) for X in poses):
        return None
    motion = pose_of(other) @ np.linalg.inv(pose_of(link))
    return None if np.allclose(motion, np.eye(4), atol=1e-3 * size) else np.asarray(motion)


def _moved(context: Context, motion: Motion) -> list[Part]:
    """The parts in their new places."""
    parts = [context.assembly.part(name) for name in sorted(motion.moved.parts)]
    if not motion.whole:
        return [replace(part, X_WP=motion.X @ part.X_WP) for part in parts]
    root = next(link for d in context.assembly.descriptions for link in d.links if link.name == motion.frame)
    return [replace(part, X_WP=pose_of(root) @ np.linalg.inv(pose_in_file(part)) @ part.X_WP) for part in parts]


def _with_joints(assembly: Assembly, motion: Motion) -> Assembly:
    """The assembly with the stated joints of a branch, and its stated masses, moved with it."""
    if not motion.moved.branch:
        return assembly
    shift, inside = motion.X[:3, 3], motion.moved.parts
    joints = tuple(
        replace(joint, point=joint.point + shift)
        if joint.point is not None and inside.issuperset(assembly.parts_of(joint.between[1]))
        else joint
        for joint in assembly.function.joints
    )
    groups = tuple(
        replace(group, override=replace(group.override, centre_of_mass=group.override.centre_of_mass + shift))
        if group.override is not None and inside.issuperset(group.parts)
        else group
        for group in assembly.groups
    )
    return replace(assembly, function=replace(assembly.function, joints=joints), groups=groups)
