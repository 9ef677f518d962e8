"""Two parts come as near each other as parts that touch do, and no contact that is known says how.

Contact is found by pairings of surfaces that are known: planes, cylinders, cones, balls, tori, threads, rims and edges
on them. An elliptical rim in a bore, a straight edge on a barrel, a roller along the inside of a ring, or corners that
meet are none of these. The meshes say how near the parts come all the same. What such a contact holds is not known:
where nothing else joins the two bodies, their joint is ambiguous (KF901), and neither is free.

A warning between bodies with no other contact; a note where contact that is known decides their joint, or the function
states it. Within one body there is nothing to say.

Why it matters: a part that is taken to be free, or a joint that is taken to be held by what is known alone, may be held
by this as well.

What to do: look at the place. Give the parts a gap if they should not touch; give the contact surfaces that fit each
other, or state the joint by `[[assume]]`.

Example: the rim of an oval peg in a round hole.
"""

from __future__ import annotations

from collections.abc import Iterator

from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import quoted
from kinform.model.contacts import Patch
from kinform.model.findings import Finding
from kinform.model.names import PartName


def check(context: Context) -> Findings:
    """Each pair of parts of different bodies that touches so."""
    decided = _decided(context)
    for patch in context.contacts.patches:
        if patch.unknown:
            yield from _finding(context, patch, decided)


def _decided(context: Context) -> set[frozenset[str | None]]:
    """Pairs of bodies whose joint does not hang on such contact."""
    known = {_bodies(context, patch.parts) for patch in context.contacts.patches if not patch.unknown}
    return known | {_bodies(context, (j.between[0], j.between[1])) for j in context.function.joints}


def _bodies(context: Context, names: tuple[PartName, PartName] | tuple[str, str]) -> frozenset[str | None]:
    if context.design.kinematics is None:
        return frozenset(str(name) for name in names)
    return frozenset(context.body(name) for name in names)


def _finding(context: Context, patch: Patch, decided: set[frozenset[str | None]]) -> Iterator[Finding]:
    bodies = _bodies(context, patch.parts)
    if len(bodies) == 1:
        return
    near = f"{1e3 * max(patch.gap, 0.0):.2g} mm"
    rule = RULE.at("note") if bodies in decided else RULE
    yield rule.finding(
        patch.parts,
        f"{quoted(patch.parts)} come within {near} of each other, in a way that is no contact that kinform knows: what "
        "it holds is not known",
        found=f"{near} apart; facets stand off their surfaces by {1e3 * patch.chord:.2g} mm",
        intended="surfaces that mate, or a gap",
        place=patch.point,
        declared=context.assembly.part(patch.parts[0]).source,
        remedy="Give the parts a gap, or surfaces that fit each other, or state their joint by [[assume]].",
    )


RULE = Rule("KF209", "contact-unknown", "warning", __doc__, check, needs=("several parts", "contacts"), also=("note",))
