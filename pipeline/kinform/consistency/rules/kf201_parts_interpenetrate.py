"""Two parts occupy the same space, beyond the facets' own error and not as a fit of mating surfaces.

An error between parts that move relative to each other, a warning between parts of one body (threads, pressed or
screwed parts are often drawn so), a note where it is no deeper than the contact tolerance of the pair and the form
error of the facets, and where `[[assume]] ignore = true` covers the pair. In a robot description, of which the meshes
are for looking at, a warning; a note between parts of one link, and between links that a joint joins where the
overlap is at most 2 % of the smaller one.

Copies of a part in one place are an error wherever they are, inside a group or a sub-assembly too, unless their mass is
stated: it counts twice. Other overlaps inside a group are meant.

A shaft that is larger than its bore is a fit where it can be pressed: by up to 3 % of the diameter, beyond what the
facets leave open. More is an overlap like any other, and the message says by how much it is more.

Why it matters: the parts cannot be assembled as drawn, and what looks like a contact inside the overlap
may decide a joint wrongly.

What to do: move or reshape one of the parts. If the overlap is meant, join the parts in a `[[group]]`.

Example: a gimbal ring whose lug reaches 1.5 mm into the housing wall.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.questions.copies_in_place import copies_in_place
from kinform.consistency.rule import Findings, Rule
from kinform.contacts.presses import PRESS_SHARE, beyond_press, press_limit
from kinform.foundation.words import length, quoted, volume
from kinform.model.assembly import Part
from kinform.model.contacts import Interference
from kinform.model.findings import Finding
from kinform.model.names import PartName

AT_JOINT = 0.02
"""Share of the size of the smaller of two links that a joint joins, up to which they may overlap in a description:
bearings, flush horns, bevel gears drawn at their nominal size. Chosen, not measured."""


def check(context: Context) -> Findings:
    """Overlaps that are not mated fits."""
    overlaps = [overlap for overlap in context.contacts.interferences if not overlap.mated]
    overlaps.sort(key=lambda overlap: (-overlap.depth, overlap.parts))
    copies = {(first.name, second.name): second for first, second in copies_in_place(context.assembly)}
    others = [_finding(context, overlap) for overlap in overlaps if overlap.parts not in copies]
    return [_copies(parts, part) for parts, part in copies.items()] + others


def _copies(parts: tuple[PartName, PartName], copy: Part) -> Finding:
    return RULE.finding(
        parts,
        f"{quoted(parts)} are two copies of one shape in one place: its mass counts twice",
        found="two copies",
        intended="one part",
        place=copy.X_WP[:3, 3],
        declared=copy.source,
        remedy="Remove one of them, or move it to its place.",
    )


def _finding(context: Context, overlap: Interference) -> Finding:
    depth = length(overlap.depth, context.units, 3)
    measured = overlap.volume == overlap.volume
    size = f"{depth} deep" + (f", {volume(overlap.volume, context.units)}" if measured else "")
    relation, severity = _relation(context, overlap)
    return RULE.at(severity).finding(
        overlap.parts,
        f"{quoted(overlap.parts)} overlap by {size}{_press(context, overlap.parts)}{relation}",
        found=size if measured else f"{size}; volume unknown, a mesh is not closed",
        intended="no overlap",
        place=overlap.place,
        declared=context.assembly.part(overlap.parts[0]).source,
        remedy="Move or reshape one of the parts; if the overlap is meant, join them in a [[group]].",
    )


def _press(context: Context, parts: tuple[str, str]) -> str:
    """What is said of a shaft that is too large for its bore to be pressed into it; nothing where there is none."""
    tight = [patch for patch in context.contacts.patches if patch.parts == parts and beyond_press(patch)]
    if not tight:
        return ""
    patch = max(tight, key=lambda patch: -patch.gap - press_limit(patch))
    bore = 2.0 * min(patch.radii)
    more, bore_in_words = (length(value, context.units, 3) for value in (-2.0 * patch.gap, bore))
    most = length(2.0 * press_limit(patch), context.units, 2)
    return (
        f": a diameter that is {more} larger than the {bore_in_words} that it goes into, where at most {most} can be "
        f"pressed ({100.0 * PRESS_SHARE:g} % and what the facets leave open)"
    )


def _relation(context: Context, overlap: Interference) -> tuple[str, str]:
    """What holds the parts together, in words, and the severity that follows."""
    parts = overlap.parts
    assembly = context.assembly
    for assumption in assembly.assumptions:
        sides = [frozenset(assembly.parts_of(name)) for name in assumption.between]
        if assumption.ignore and any(parts[k] in sides[0] and parts[1 - k] in sides[1] for k in (0, 1)):
            return f"; contact between them is ignored: {assumption.reason}", "note"
    kinematics, slight = context.design.kinematics, overlap.depth <= _form(context, parts)
    if kinematics is not None and kinematics.body_of(parts[0]).name == kinematics.body_of(parts[1]).name:
        return "; they move as one body", "note" if slight or _links(context, parts) else "warning"
    if slight:
        return "; that is within the contact tolerance and the form error of the facets", "note"
    links = _links(context, parts)
    joined = {frozenset(joint.between) for d in assembly.descriptions for joint in d.joints}
    if links and frozenset(links) in joined and overlap.depth <= AT_JOINT * _size(context, links):
        return f"; a joint joins the links {quoted(links)}", "note"
    return f" (links {quoted(links)})" if links else "", "error"


def _form(context: Context, parts: tuple[PartName, PartName]) -> float:
    """m by which the parts may overlap in form: their contact tolerance, and what facets of their contact stand off the
    surfaces; 0 where a shaft is too large for its bore."""
    patches = [patch for patch in context.contacts.patches if patch.parts == parts]
    meshes = [mesh for name in parts if (mesh := context.assembly.part(name).mesh) is not None]
    if len(meshes) < len(parts) or any(map(beyond_press, patches)):
        return 0.0
    tolerance = context.assembly.tolerances.contact_of(meshes[0].size, meshes[1].size)
    return tolerance + max((patch.chord for patch in patches), default=0.0)


def _links(context: Context, parts: tuple[str, str]) -> tuple[str, ...]:
    """The described links that the parts are of; none unless both are of one."""
    of = {name: link.name for d in context.assembly.descriptions for link in d.links for name in link.parts}
    return tuple(of[name] for name in parts) if all(name in of for name in parts) else ()


def _size(context: Context, links: tuple[str, ...]) -> float:
    """m: of the smaller link, the diagonal of its largest part."""
    meshes = {part.name: part.mesh for part in context.assembly.parts}
    sizes = []
    for d in context.assembly.descriptions:
        for link in d.links:
            if link.name in links:
                known = [mesh for name in link.parts if (mesh := meshes.get(PartName(name))) is not None]
                sizes.append(max((mesh.diagonal for mesh in known), default=0.0))
    return min(sizes, default=0.0)


RULE = Rule("KF201", "parts-interpenetrate", "error", __doc__, check, needs=("contacts",), also=("warning", "note"))
