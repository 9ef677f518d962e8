"""Touches that may be none: contact on one side only, so small or so far from zero gap that it may not be meant; and
lines that hold more than their normals say.

A roller that lies in a ring turns about the normal of the line in which they touch, by the rows of that line. It does
not: its ends would go into the ring. To second order it is held, so that it has one freedom less over a distance than
at the first instant.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross, norm, sine
from kinform.foundation.rounding import SINGLE
from kinform.kinematics.constants import SAME_DIRECTION
from kinform.kinematics.joints.pair.evidence import GAP_BANDS, Evidence
from kinform.model.arrays import Array
from kinform.model.contacts import Patch

WIDE_GAP = GAP_BANDS[1][0]
"""Gaps beyond this share have the least weight."""
PASSING_GAP = 2e-3
"""Gaps below this share of the size of the smaller body are as good as none. Chosen, not measured."""
STRAY_AREA = 5e-4
"""Share of the squared size of the smaller body below which a one-directional contact that touches may be a stray.
Chosen, not measured."""
STRAY_AREA_APART = 2e-2
"""The same where it does not touch. Chosen, not measured."""
WIDE_CONTACT = 0.15
"""Contact whose box is larger than this share of the smaller body is not one stray touch: feet, rims. Chosen, not
measured."""


TOUCHING = ("point", "line")
"""Kinds of higher pairs: alone they are no joint, and leave what they leave at this instant."""


def apart_doubt(evidence: Evidence) -> str:
    """Are points on one side all that touches, and do none of them touch, as well as that is known?

    A ball rests on its plate. Where two curved surfaces pass each other with a gap, or are drawn into each other,
    nothing tells that they are meant to meet just there. Lines are not asked: flanks of teeth have play.
    """
    patches = [item.patch for item in evidence.items]
    if not all(patch.kind == "point" for patch in patches) or not _on_one_side(evidence):
        return ""
    if any(patch.fit not in ("clearance", "interference") for patch in patches):
        return ""
    gap = min((patch.gap for patch in patches), key=abs)
    what = "pass each other with a gap of" if gap > 0.0 else "are drawn into each other by"
    return (
        f"they {what} {1e3 * abs(gap):.2g} mm at a point on one side only: "
        "whether they are meant to touch there is not known"
    )


def stray_doubt(evidence: Evidence) -> str:
    """Is all of the contact on one side, and so small, or so far apart, that it may not be meant?"""
    if evidence.size == 0.0 or not _on_one_side(evidence):
        return ""
    area = sum(item.patch.area for item in evidence.items)
    least = max(WIDE_GAP * evidence.contact, PASSING_GAP * evidence.size)
    apart = all(item.patch.gap > least for item in evidence.items)
    least_area = STRAY_AREA_APART if apart else STRAY_AREA
    if area >= least_area * evidence.size**2 or evidence.frame.length > WIDE_CONTACT * evidence.size:
        return ""
    what = "they pass each other without touching" if apart else "they touch"
    return f"{what} over {1e6 * area:.3g} mm² on one side only: too little to tell a joint from a stray touch"


def _on_one_side(evidence: Evidence) -> bool:
    """Do all normals lean the way of their weighted mean?"""
    normals = evidence.rows[:, 3:]
    return bool((normals @ (evidence.share @ normals) > 0.0).all())


def beside_flange(line: Patch, other: Patch) -> bool:
    """Whether a patch beside a line of contact is of a flange, which leaves the line what it is: a plane across it, or
    a ball about a place on it, as at the ends of rollers."""
    if other.kind == "plane":
        return sine(other.axis, line.axis) < SAME_DIRECTION
    arm = other.point - line.point
    aside = norm(cross(arm, line.axis))
    return other.kind == "sphere" and not other.one_sided and aside < SAME_DIRECTION * norm(arm)


def ends_at_line(patches: Sequence[Patch]) -> bool:
    """Whether all contact is of planes and of lines across which these lie, as of a roller between flanges; or of a
    disc on a plate that lies against a post, which only ends its way there."""
    lines = [patch for patch in patches if patch.kind == "line" and not patch.one_sided]
    planes = [patch for patch in patches if patch.kind == "plane"]
    if not lines or not planes or len(lines) + len(planes) < len(patches):
        return False
    return all(beside_flange(line, plane) for line in lines for plane in planes)


def held_by_bends(patches: Sequence[Patch], basis: Array) -> Array:
    """(6, m) those of the freedoms (6, k), turns first, that do not turn a roller about the normal of a straight line
    in which it lies in its ring; `basis` itself where none does."""
    lines = [patch for patch in patches if patch.kind == "line" and patch.bends and not patch.one_sided]
    if not lines or not basis.shape[1]:
        return basis
    _, values, right = np.linalg.svd(np.array([patch.normals[0] for patch in lines]) @ basis[:3])
    rank = int(np.count_nonzero(values > SINGLE))
    return np.asarray(basis @ right[rank:].T) if rank else basis
