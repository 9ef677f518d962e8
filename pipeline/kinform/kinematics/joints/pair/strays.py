"""Touches that may be none: contact on one side only, so small or so far from zero gap that it may not be meant; and
lines that hold more than their rows say."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinform.foundation.words import quoted
from kinform.kinematics.joints.pair.evidence import GAP_BANDS, Evidence
from kinform.kinematics.joints.pair.suspects import AtRest, Suspect, suspect
from kinform.kinematics.joints.pair.touches import held_by_bends
from kinform.model.arrays import Array

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


def points_apart(pair: AtRest) -> Iterator[Suspect]:
    """Points on one side that are all that touches, if none of them touches, as well as that is known.

    A ball rests on its plate. Where two curved surfaces pass each other with a gap, or are drawn into each other,
    nothing tells that they are meant to meet just there. Lines are not asked: flanks of teeth have play.
    """
    patches = pair.patches
    if not pair.touching or not all(patch.kind == "point" for patch in patches) or not _on_one_side(pair.evidence):
        return
    if any(patch.fit not in ("clearance", "interference") for patch in patches):
        return
    gap = min((patch.gap for patch in patches), key=abs)
    what = "pass each other with a gap of" if gap > 0.0 else "are drawn into each other by"
    words = (
        f"they {what} {1e3 * abs(gap):.2g} mm at a point on one side only: "
        "whether they are meant to touch there is not known"
    )
    yield Suspect(tuple(range(len(patches))), "doubt", words)


def strays(pair: AtRest) -> Iterator[Suspect]:
    """All of the contact, if it is on one side, and so small, or so far apart, that it may not be meant."""
    evidence, patches = pair.evidence, pair.patches
    if pair.touching or evidence.size == 0.0 or not _on_one_side(evidence):
        return
    area = sum(patch.area for patch in patches)
    least = max(WIDE_GAP * evidence.contact, PASSING_GAP * evidence.size)
    apart = all(patch.gap > least for patch in patches)
    least_area = STRAY_AREA_APART if apart else STRAY_AREA
    if area >= least_area * evidence.size**2 or evidence.frame.length > WIDE_CONTACT * evidence.size:
        return
    what = "they pass each other without touching" if apart else "they touch"
    words = f"{what} over {1e6 * area:.3g} mm² on one side only: too little to tell a joint from a stray touch"
    yield Suspect(tuple(range(len(patches))), "doubt", words)


def _on_one_side(evidence: Evidence) -> bool:
    """Do all normals lean the way of their weighted mean?"""
    normals = evidence.rows[:, 3:]
    return bool((normals @ (evidence.share @ normals) > 0.0).all())


def bends(pair: AtRest) -> Iterator[Suspect]:
    """Lines along which a roller lies in its ring, where it turns about their normals at the first instant alone."""
    lines = np.array([patch.bends for patch in pair.patches])
    held = held_by_bends(pair.patches, pair.basis)
    if held is not pair.basis:
        parts = quoted(next(patch for patch in pair.patches if patch.bends).parts)
        words = (
            f"{pair.count} of 6 freedoms are left at the first instant, and {held.shape[1]} over a distance: about the "
            f"normal of the line in which {parts} touch, the ends of the one go into the other"
        )
        yield suspect(lines, "bend", words)


def without_bends(pair: AtRest, of: Suspect, free: Array, freed: Array) -> Array | None:
    """The freedoms that such a roller has over a distance."""
    return held_by_bends(pair.patches, free)
