"""How well the axis of a joint is known, and its place on it: by the fits of the patches that decide them.

Each patch says where its axis or centre is, with the uncertainty of the two surfaces that were fitted. The best of
those that have a say counts. A direction is said by axes along it, by planes across it, and by planes along it where
two of them meet in it. A place is said by surfaces of revolution about it and by balls.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.vectors import sine
from kinform.kinematics.joints.pair.constants import VAGUE_AXIS
from kinform.kinematics.joints.pair.evidence import COAXIAL, Item
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.model.arrays import Array

SAYS_DIRECTION = 0.1
"""Sine within which an axis is along, or a plane across, the joint's axis, and has a say about its direction. Chosen,
not measured."""
VAGUE_PLACE = 0.03
"""The same of its place, as a share of its radius: what a clearance may be. Chosen, not measured."""


PLACED = ("revolute", "cylindrical", "screw", "spherical", "universal")
"""Joints whose axis or centre has a place."""


def joint_uncertainty(items: Sequence[Item], form: JointForm) -> tuple[float, float]:
    """Standard uncertainty of the direction (rad) and of the place (m) of a joint that these patches decide.

    0 where the joint has no direction or no place, and where no patch says it: planes alone that make a hinge.
    """
    angles = [angle for item in items if (angle := _angle(item, form)) is not None]
    shifts = [_shift(item, form) for item in items] if form.type in PLACED else []
    direction = min(angles, default=0.0) if form.axis is not None else 0.0
    return direction, min((shift for shift in shifts if shift is not None), default=0.0)


def disagreement(items: Sequence[Item], form: JointForm) -> float:
    """rad: how far a joint's axis is from the patch that says its direction best, its own uncertainty included.

    Where patches disagree beyond what each is known to, as on coarse meshes, the axis is known no better than that.
    Nor is it where a pin is askew in the clearance of its bore: the axis is that of the pin, of the bore, or between.
    """
    out = []
    for item in items:
        angle = _angle(item, form)
        if angle is not None and form.axis is not None:
            cosine = abs(float(item.patch.axis @ form.axis))
            out.append(max(angle, 0.5 * item.patch.misalignment, min(sine(item.patch.axis, form.axis), cosine)))
    return min(out, default=0.0)


def displacement(items: Sequence[Item], form: JointForm) -> float:
    """m: how far the axis or centre of a joint is from those of the two surfaces, of the patch where they agree best,
    its own uncertainty included: the same of a pin that is off the middle of its bore."""
    if form.type not in PLACED:
        return 0.0
    out = [max(shift, 0.5 * i.patch.offset) for i in items if (shift := _shift(i, form)) is not None]
    return min(out, default=0.0)


def uncertainty_doubt(items: Sequence[Item], form: JointForm, length: float) -> str:
    """Why the axis or the place is known too badly for a joint, in words; empty where it is not.

    `length` (m) is the size of the contact, for a place that has no radius of its own.
    """
    direction, place = joint_uncertainty(items, form)
    if direction > VAGUE_AXIS:
        return (
            f"the axis is known to {np.degrees(direction):.2g}° only, by the fits of what decides it "
            f"(more than {np.degrees(VAGUE_AXIS):.2g}°)"
        )
    radius = max(
        (max(i.patch.radii) for i in items if i.patch.kind in ("cylinder", "sphere") and _says(i, form)), default=0.0
    )
    least = VAGUE_PLACE * (radius or length)
    if place > least:
        return (
            f"the place of the axis is known to {1e3 * place:.2g} mm only, by the fits of what decides it "
            f"(more than {100 * VAGUE_PLACE:.2g} % of its radius of {1e3 * (radius or length):.3g} mm)"
        )
    return ""


def _says(item: Item, form: JointForm) -> bool:
    """Has the patch a say about the place of the joint's axis or centre?"""
    return _shift(item, form) is not None


def _angle(item: Item, form: JointForm) -> float | None:
    """rad: how well the patch says the joint's direction; None where it says nothing about it."""
    if form.axis is None or not any(item.patch.axis.tolist()):
        return None
    along = sine(item.patch.axis, form.axis) < SAYS_DIRECTION
    if item.patch.kind in (*COAXIAL, "extrusion") and along:
        return item.patch.uncertainty[0]
    if item.patch.kind == "plane" and (along or (form.type == "prismatic" and _across(item, form.axis))):
        return item.patch.uncertainty[0]
    return None


def _across(item: Item, axis: Array) -> bool:
    return abs(float(item.patch.axis @ axis)) < SAYS_DIRECTION


def _shift(item: Item, form: JointForm) -> float | None:
    """m: how well the patch says the joint's place; None where it says nothing about it."""
    if form.point is None:
        return None
    if item.patch.kind == "sphere":
        return item.patch.uncertainty[1]
    if item.patch.kind not in COAXIAL or form.axis is None:
        return None
    along = sine(item.patch.axis, form.axis) < SAYS_DIRECTION
    return item.patch.uncertainty[1] if along else None
