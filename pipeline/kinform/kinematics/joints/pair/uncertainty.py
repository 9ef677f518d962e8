"""How well the axis of a joint is known, and its place on it: by the fits of the patches that decide them.

Each patch says where its axis or centre is, with the uncertainty of the two surfaces that were fitted. The best of
those that have a say counts. A direction is said by axes along it, by planes across it, and by planes along it where
two of them meet in it. A place is said by surfaces of revolution about it and by balls.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import sqrt

import numpy as np

from kinform.foundation.algebra.vectors import sine
from kinform.foundation.rounding import TINY
from kinform.foundation.words import quoted
from kinform.kinematics.joints.pair.constants import VAGUE_AXIS
from kinform.kinematics.joints.pair.evidence import COAXIAL, Evidence, Item
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.kinematics.joints.pair.suspects import AtRest, Suspect, suspect
from kinform.model.arrays import Array

SAYS_DIRECTION = 0.1
"""Sine within which an axis is along, or a plane across, the joint's axis, and has a say about its direction. Chosen,
not measured."""
VAGUE_PLACE = 0.03
"""The same of its place, as a share of its radius: what a clearance may be. Chosen, not measured."""

WEYL_SIGMAS = 3.0
"""A constraint whose singular value is less than so many standard uncertainties of the directions of all rows may be
none: one of 2,000 random assemblies was wrong without this (two hexagons of 6 mm whose vertices scatter by 3 µm)."""


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


def vague_axes(pair: AtRest) -> Iterator[Suspect]:
    """What decides the joint, if its axis or place is known too badly."""
    form, items = pair.form, pair.evidence.items
    direction, place = joint_uncertainty(items, form)
    if direction > VAGUE_AXIS:
        saying = np.array([_angle(item, form) is not None for item in items])
        yield suspect(
            saying,
            "doubt",
            f"the axis is known to {np.degrees(direction):.2g}° only, by the fits of what decides it "
            f"(more than {np.degrees(VAGUE_AXIS):.2g}°)",
        )
    saying = np.array([_shift(item, form) is not None for item in items])
    rounds = [i for i in pair.evidence.chosen(saying) if i.patch.kind in ("cylinder", "sphere")]
    # the size of the contact, of a place that has no radius of its own
    radius = max((max(item.patch.radii) for item in rounds), default=0.0) or pair.evidence.frame.length
    if place > VAGUE_PLACE * radius:
        yield suspect(
            saying,
            "doubt",
            f"the place of the axis is known to {1e3 * place:.2g} mm only, by the fits of what decides it "
            f"(more than {100 * VAGUE_PLACE:.2g} % of its radius of {1e3 * radius:.3g} mm)",
        )


def unknown_contact(pair: AtRest) -> Iterator[Suspect]:
    """All contact, where none is of a known kind."""
    if not all(patch.unknown for patch in pair.patches):
        return
    least = min(pair.patches, key=lambda patch: patch.gap)
    words = (
        f"{quoted(least.parts)} come within {1e3 * max(least.gap, 0.0):.2g} mm of each other, in a way that is no "
        "contact that kinform knows: what it holds is not known"
    )
    yield Suspect(tuple(range(len(pair.patches))), "doubt", words)


def weak_rows(pair: AtRest) -> Iterator[Suspect]:
    """All contact, where a constraint is too weak to be one for certain."""
    tolerances, every = pair.tolerances, tuple(range(len(pair.patches)))
    if pair.count == 6:
        return
    value, spread = pair.values[pair.count], _spread(pair.evidence)
    if value < tolerances.held:
        words = (
            "a motion is neither clearly held nor clearly free: lengthen the surface that locates it, or export a "
            f"finer mesh (singular value {value:.2g}, between {tolerances.free:g} and {tolerances.held:g})"
        )
        yield Suspect(every, "doubt", words)
    if value < WEYL_SIGMAS * spread:
        words = (
            f"a motion is held by less than the {np.degrees(spread):.2g}° to which the directions of the surfaces are "
            f"known: export a finer mesh (singular value {value:.2g})"
        )
        yield Suspect(every, "doubt", words)


def _spread(evidence: Evidence) -> float:
    """rad: how well the directions of the surfaces are known, the mean of all by their weights, but for those that are
    known so little that they do not decide alone in any case.

    By so much, and no more, do singular values change when the rows turn (H. Weyl, Math. Ann. 71, 1912).
    """
    shares = np.add.reduceat(evidence.share, evidence.start[:-1]).tolist()
    turns = [item.patch.mismatch[0] for item in evidence.items]
    known = [(share, turn) for share, turn in zip(shares, turns, strict=True) if turn <= VAGUE_AXIS]
    return sqrt(sum(share * turn**2 for share, turn in known) / max(sum(share for share, _ in known), TINY))


def unknown_facets(pair: AtRest) -> Iterator[Suspect]:
    """Points, lines and facets of no known surface, and where bodies are one those that are unknown on one side."""
    if not pair.touching and not pair.firm.all():
        kinds = sorted({item.patch.kind for item in pair.evidence.chosen(~pair.firm)})
        words = (
            f"contact along {', '.join(kinds)} without a mating surface decides: give it surfaces that fit each other, "
            f"or state the joint ({pair.count} of 6 freedoms are left with it)"
        )
        yield suspect(~pair.firm, "drop", words)


def scattered_facets(pair: AtRest) -> Iterator[Suspect]:
    """These, and surfaces whose directions are vague."""
    vague = pair.vague[pair.firm & ~pair.sure]
    if not pair.touching and len(vague):
        words = (
            f"surfaces decide whose direction is known no better than to {np.degrees(vague.min()):.2g}°, as the "
            f"vertices of the mesh scatter: export a finer mesh ({pair.count} of 6 freedoms are left with them)"
        )
        yield suspect(~pair.sure, "drop", words)


def near_axes(pair: AtRest) -> Iterator[Suspect]:
    """Axes and centres, of bodies that are fixed: they may be so only because these miss each other by a little."""
    wide = np.array([patch.kind in (*COAXIAL, "sphere") and not patch.one_sided for patch in pair.patches])
    if not pair.count and wide.any():
        yield suspect(wide, "widen", "axes that miss each other by little hold the bodies")


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
