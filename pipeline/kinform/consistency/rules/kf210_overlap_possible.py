"""Two parts share some space, and coarse facets may be all there is to it.

Facets stand off the surface that they stand for, those of a coarse socket or countersink by more the larger they are.
Solids that share no more than that may overlap or not: the surfaces that were meant are not known so well. An overlap
that is deeper is known (KF201).

Why it matters: an overlap by less than facets stand off is not seen.

What to do: export finer meshes of both parts where they meet, and check again.

Example: a ball of 64 segments in the socket of 12 that it fits.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import length, quoted


def check(context: Context) -> Findings:
    """Each pair of parts of which it is not known whether they overlap."""
    for overlap in context.contacts.possible_overlaps:
        depth = length(overlap.depth, context.units, 2)
        yield RULE.finding(
            overlap.parts,
            f"{quoted(overlap.parts)} share some space, up to {depth} deep, no more than coarse facets there may stand "
            "off the surfaces that are meant: whether these overlap is not known",
            found=f"{depth} deep",
            intended="no overlap",
            place=overlap.place,
            declared=context.assembly.part(overlap.parts[0]).source,
            remedy="Export finer meshes of both parts where they meet, and check again.",
        )


RULE = Rule("KF210", "overlap-possible", "note", __doc__, check, needs=("several parts", "contacts"))
