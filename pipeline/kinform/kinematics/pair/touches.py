"""Touches that may be none: contact on one side only, so small or so far from zero gap that it may not be meant."""

from __future__ import annotations

from kinform.kinematics import constants
from kinform.kinematics.pair.evidence import Evidence

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
    least = max(constants.WIDE_GAP * evidence.contact, constants.PASSING_GAP * evidence.size)
    apart = all(item.patch.gap > least for item in evidence.items)
    least_area = constants.STRAY_AREA_APART if apart else constants.STRAY_AREA
    if area >= least_area * evidence.size**2 or evidence.frame.length > constants.WIDE_CONTACT * evidence.size:
        return ""
    what = "they pass each other without touching" if apart else "they touch"
    return f"{what} over {1e6 * area:.3g} mm² on one side only: too little to tell a joint from a stray touch"


def _on_one_side(evidence: Evidence) -> bool:
    """Do all normals lean the way of their weighted mean?"""
    normals = evidence.rows[:, 3:]
    return bool((normals @ (evidence.share @ normals) > 0.0).all())
