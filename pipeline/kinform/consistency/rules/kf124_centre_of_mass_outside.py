"""A stated centre of mass lies outside of the geometry.

A body's centre of mass is inside of its convex hull, whatever it is made of. A finding where the stated one is outside
by more than 3 % of the size of the part or link; parts that are not drawn can explain as much.

Why it matters: gravity pulls at the wrong place, so holding torques are wrong, and so is what a controller learns.

What to do: correct the stated centre: it is in the frame of the link, in metres. `kinform export F.h5 --to urdf
--fix inertia` writes that of the geometry.

Example: the centre of a forearm in millimetres, as if they were metres, 80 m away.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinform.consistency.comparisons.as_written import place_in_link
from kinform.consistency.comparisons.gathering import Ranked, gathered
from kinform.consistency.context import Context
from kinform.consistency.rule import Findings, Rule
from kinform.foundation.words import length, place

CENTRE_OUTSIDE = 0.03
"""Share of the size by which a centre of mass may lie outside of the hull: pieces that are not drawn, rounding.
Chosen, not measured."""


def check(context: Context) -> Findings:
    """The centre of every stated mass beside the hull of its geometry."""
    return gathered(_outside(context), "link" if context.assembly.descriptions else "part")


def _outside(context: Context) -> Iterator[Ranked]:
    doubted = {name for doubt in context.doubts for name in doubt.subject}  # of another size than they are drawn
    for body in context.weighed:
        if body.hull is None or not np.isfinite(body.centre).all():
            continue
        if doubted & {body.name, *(part.name for part in body.parts)}:
            continue
        out = float(body.hull.outside(body.centre[None])[0])
        if out > CENTRE_OUTSIDE * body.size:
            middle = 0.5 * (body.points.min(axis=0) + body.points.max(axis=0))
            finding = RULE.finding(
                [body.name],
                f"the centre of mass of {body.what} lies {length(out, context.units)} outside of its geometry, which "
                f"is {length(body.size, context.units)} across",
                found=place(body.centre, context.units),
                intended=f"inside, around {place(middle, context.units)}",
                place=body.centre,
                declared=body.source,
                remedy="Correct the centre of mass: in the frame of the link, in metres, the middle of the geometry is "
                f"at {place_in_link(body.described, middle)}."
                if body.described is not None
                else "Correct `centre_of_mass`.",
            )
            yield Ranked("outside", out / body.size, finding)


RULE = Rule("KF124", "centre-of-mass-outside", "warning", __doc__, check, needs=("weighed shapes",))
