"""Mating surfaces overlap within the contact tolerance: a press fit, or a nominal size on both sides.

Why it matters: it is how a press fit looks. Between parts that shall move it is a fit without clearance.

What to do: nothing where parts are pressed together. Where they shall move, give the pair a clearance.

Example: a dowel of 5.02 mm in a hole of 5 mm overlaps by 0.01 mm.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import length, quoted


def check(context: Context) -> Findings:
    """Overlaps that lie at mating surfaces."""
    for overlap in context.contacts.interferences:
        if overlap.mated:
            yield RULE.finding(
                overlap.parts,
                f"{quoted(overlap.parts)} overlap by {length(overlap.depth, context.units, 3)} where they mate",
                found=length(overlap.depth, context.units, 3),
                intended="a clearance, unless a press fit is meant",
                place=overlap.place,
                declared=context.assembly.part(overlap.parts[0]).source,
                remedy="Nothing for a press fit; give parts that shall move a clearance.",
            )


RULE = Rule("KF202", "parts-overlap-at-fit", "note", __doc__, check, needs=("contacts",))
