"""Two parts occupy the same space, beyond the facets' own error and not as a fit of mating surfaces.

An error between parts that move relative to each other, a warning between parts of one body (threads,
pressed or screwed parts are often drawn so), a note where `[[assume]] ignore = true` covers the pair.

Why it matters: the parts cannot be assembled as drawn, and what looks like a contact inside the overlap
may decide a joint wrongly.

What to do: move or reshape one of the parts. If the overlap is meant, join the parts in a `[[group]]`.

Example: a gimbal ring whose lug reaches 1.5 mm into the housing wall.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import length, quoted, volume
from kinform.model.contacts import Interference
from kinform.model.findings import Finding


def check(context: Context) -> Findings:
    """Overlaps that are not mated fits."""
    return [_finding(context, overlap) for overlap in context.contacts.interferences if not overlap.mated]


def _finding(context: Context, overlap: Interference) -> Finding:
    depth = length(overlap.depth, context.units, 3)
    measured = overlap.volume == overlap.volume
    size = f"{depth} deep" + (f", {volume(overlap.volume, context.units)}" if measured else "")
    relation, severity = _relation(context, overlap.parts)
    return RULE.at(severity).finding(
        overlap.parts,
        f"{quoted(overlap.parts)} overlap by {size}{relation}",
        found=size if measured else f"{size}; volume unknown, a mesh is not closed",
        intended="no overlap",
        place=overlap.place,
        declared=context.assembly.part(overlap.parts[0]).source,
        remedy="Move or reshape one of the parts; if the overlap is meant, join them in a [[group]].",
    )


def _relation(context: Context, parts: tuple[str, str]) -> tuple[str, str]:
    """What holds the parts together, in words, and the severity that follows."""
    assembly = context.assembly
    for assumption in assembly.assumptions:
        sides = [frozenset(assembly.parts_of(name)) for name in assumption.between]
        if assumption.ignore and any(parts[k] in sides[0] and parts[1 - k] in sides[1] for k in (0, 1)):
            return f"; contact between them is ignored: {assumption.reason}", "note"
    kinematics = context.design.kinematics
    if kinematics is not None and kinematics.body_of(parts[0]).name == kinematics.body_of(parts[1]).name:
        return "; they move as one body", "warning"
    return "", "error"


RULE = Rule("KF201", "parts-interpenetrate", "error", __doc__, check, needs=("contacts",))
