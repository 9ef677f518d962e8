"""Collision geometry of two links overlaps in the pose of the description, where no joint joins the links.

Looked for where the visual geometry is judged; with `--geometry collision` it is KF201. Links that fixed joints join
are one body; bodies that one joint joins are left out, as simulators do, and pairs that `<exclude>` of MJCF names.
Primitives and closed meshes are cut as they are; others as their convex hulls, which is a note. Overlaps of less than
2 % of the smaller piece are not counted.

Why it matters: with self-collision on, a simulator pushes the links apart at the first step, and a planner finds no
way that starts there.

What to do: shrink the pieces, move the start of the joints, or exclude the pair (`<disable_collisions>` of an SRDF,
`<exclude>` of MJCF).

Example: the box around a forearm that is drawn folded back reaches into the box around the base.
"""

from __future__ import annotations

from kinform.consistency.comparisons.gathering import Ranked, gathered
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided
from kinform.consistency.rule import Rule
from kinform.foundation.words import length, volume
from kinform.model.assembly import Source
from kinform.model.descriptions import Description, StartOverlap


def check(context: Context) -> Outcome:
    """Every overlap, the deepest first."""
    found = ((d, overlap) for d in context.assembly.descriptions for overlap in d.overlaps)
    return decided(gathered((_ranked(context, d, overlap) for d, overlap in found), "pair"))


def _ranked(context: Context, description: Description, overlap: StartOverlap) -> Ranked:
    first, second = overlap.links
    deep = f"{length(overlap.depth, context.units)} deep"
    file = next((link.file for link in description.links if link.name == second), description.file)
    finding = RULE.at("note" if overlap.hulls else "warning").finding(
        overlap.links,
        f"the collision geometry of '{first}' (line {overlap.lines[0]}) and '{second}' overlaps at the start: {deep}, "
        f"{volume(overlap.volume, context.units)}{', as convex hulls' if overlap.hulls else ''}",
        found=f"{deep} at the start",
        intended="no overlap of links that no joint joins",
        place=overlap.place,
        declared=Source(file, overlap.lines[1]),
        remedy="Shrink the collision geometry, start from another pose, or exclude the pair from collisions.",
    )
    return Ranked("overlap", overlap.depth, finding)


RULE = Rule(
    "KF133",
    "collisions-at-start",
    "warning",
    __doc__,
    check,
    needs=("descriptions", "collision geometry"),
    also=("note",),
)
