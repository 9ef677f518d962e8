"""Contact at points and along lines: what the bodies do at this instant, and lines that hold more than their normals
say.

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
from kinform.kinematics.joints.pair.evidence import Evidence
from kinform.model.arrays import Array
from kinform.model.contacts import Patch

ON_RADIUS = 0.02
"""Relative: points this near to the radius of a surface from an axis are on a surface about that axis. A facet of a
cylinder of 16 sides is 2 % inside its radius (1 - cos(π/16))."""


TOUCHING = ("point", "line")
"""Kinds of higher pairs: alone they are no joint, and leave what they leave at this instant."""
HIGHER = (*TOUCHING, "freeform", "other")
"""Kinds of patches whose normals turn, or whose place moves, as soon as the bodies do."""


def meets(patches: Sequence[Patch]) -> bool:
    """Whether all contact is along points and lines, beside nothing but planes across the lines, or balls about a place
    on them: a cam that rubs, a roller between flanges."""
    lines = [patch for patch in patches if patch.kind == "line"]
    if any(patch.kind in TOUCHING and patch.one_sided for patch in patches):
        return False  # nobody knows where facets touch next
    return any(patch.kind in TOUCHING for patch in patches) and all(
        patch.kind in TOUCHING or (bool(lines) and all(beside_flange(line, patch) for line in lines))
        for patch in patches
    )


def momentary(evidence: Evidence, basis: Array) -> bool:
    """Whether points and lines alone leave a turn that takes the surfaces off each other: that of two gears about
    their pitch line, while a roller in a groove turns about its own axis."""
    if not meets([item.patch for item in evidence.items]):
        return False
    form = evidence.form(basis)
    if form.type not in ("revolute", "cylindrical", "screw", "spherical") or form.point is None:
        return False
    for item in evidence.items:
        if item.patch.kind not in TOUCHING:
            continue
        arm = item.points - form.point
        if form.axis is not None:
            arm = arm - np.outer(arm @ form.axis, form.axis)
        away = np.linalg.norm(arm, axis=1)
        if all(
            (np.abs(away - radius) > ON_RADIUS * max(radius, ON_RADIUS * evidence.frame.length)).any()
            for radius in item.patch.radii
        ):
            return True
    return False


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
