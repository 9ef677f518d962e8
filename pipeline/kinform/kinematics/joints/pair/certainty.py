"""How sure the answer of a decision is: what in the evidence makes it doubtful, in words.

A doubtful answer is `ambiguous`, never silently one or the other. The doubts: a singular value between free and held;
contact of no known kind; facets of no known surface, lines and points that alone hold something (where they touch next
is not known); scraps of surfaces that alone do (`scraps`); axes that nearly agree, which a designer means as one;
touches too small or too far apart to be meant; an axis that the fits hardly know (`uncertainty`); and faces that may be
end stops (`one_sided`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import sqrt

import numpy as np

from kinform.foundation.algebra.vectors import cross, perpendicular, sine
from kinform.foundation.rounding import SINGLE, TINY
from kinform.foundation.words import counted, quoted
from kinform.frozen import dataclass
from kinform.kinematics.joints.pair.constants import VAGUE_AXIS
from kinform.kinematics.joints.pair.evidence import COAXIAL, Evidence, Item
from kinform.kinematics.joints.pair.freedoms import freedoms, freedoms_beyond
from kinform.kinematics.joints.pair.in_step import Steps
from kinform.kinematics.joints.pair.lower_pairs import JointForm
from kinform.kinematics.joints.pair.motion_cone import MotionCone
from kinform.kinematics.joints.pair.one_sided import (
    ALONG_AXIS,
    ROLES,
    OtherReading,
    faces_in_words,
    one_sense,
    seat_reading,
    stop_reading,
)
from kinform.kinematics.joints.pair.preserved import preserved_motions
from kinform.kinematics.joints.pair.scraps import narrow, scraps
from kinform.kinematics.joints.pair.slots import pin_reading
from kinform.kinematics.joints.pair.touches import TOUCHING, apart_doubt, beside_flange, held_by_bends, stray_doubt
from kinform.kinematics.joints.pair.uncertainty import uncertainty_doubt
from kinform.model.arrays import Array, Flags
from kinform.model.contacts import Patch
from kinform.model.kinematics import JointStatus, ReadingCause
from kinform.model.tolerances import Tolerances

MISSED_AXES = 0.5
"""Axes that miss each other by less than this share of the contact tolerance are meant to be one. Chosen, not
measured."""
TILTED_AXES = 4.0
"""So are axes within this many times the alignment. Chosen, not measured."""
ON_RADIUS = 0.02
"""Relative: points this near to the radius of a surface from an axis are on a surface about that axis. A facet of a
cylinder of 16 sides is 2 % inside its radius (1 - cos(π/16))."""
THREAD_AXES = 4
"""Axes about which threads are suspected. Chosen, not measured."""
THREAD_SECTORS = 8
"""Parts of a turn of which all but one must have contact where a thread is suspected. Chosen, not measured."""
FILLED_SECTOR = 0.02
"""Share of the weight from which on such a part has contact. Chosen, not measured."""
THREAD_SLOPE = 0.01
"""Mean square of the normals along the axis below which nothing leans. Chosen, not measured."""
THREAD_LEAN = 5e-3
"""Advance a radian, in radii, of what leans like a thread. Chosen, not measured."""
THREAD_FIT = 0.75
"""Share of the squared speeds that a screw may leave where facets lean like a thread. Chosen, not measured."""
WEYL_SIGMAS = 3.0
"""A constraint whose singular value is less than so many standard uncertainties of the directions of all rows may be
none: one of 2,000 random assemblies was wrong without this (two hexagons of 6 mm whose vertices scatter by 3 µm)."""


HIGHER = (*TOUCHING, "freeform", "other")
"""Kinds of patches whose normals turn, or whose place moves, as soon as the bodies do."""


@dataclass(frozen=True, eq=False)
class Certainty:
    """How sure an answer is, why, and what else it may be."""

    status: JointStatus
    reason: str
    other: OtherReading | None = None


def certainty(
    evidence: Evidence,
    twists: Array,
    preserved: Flags,
    basis: Array,
    values: Array,
    tolerances: Tolerances,
    cone: MotionCone,
) -> Steps[Certainty]:
    """How sure the freedoms `basis` (6, k) are, with singular values (6,), found among `twists` (6, n) of which
    `preserved` (items, n) says what each patch preserves."""
    count = basis.shape[1]
    if all(item.patch.unknown for item in evidence.items):
        least = min((item.patch for item in evidence.items), key=lambda patch: patch.gap)
        return Certainty(
            "ambiguous",
            f"{quoted(least.parts)} come within {1e3 * max(least.gap, 0.0):.2g} mm of each other, in a way that is no "
            "contact that kinform knows: what it holds is not known",
        )
    if count < 6 and values[count] < tolerances.held:
        return Certainty(
            "ambiguous",
            "a motion is neither clearly held nor clearly free: lengthen the surface that locates it, or export a "
            f"finer mesh (singular value {values[count]:.2g}, between {tolerances.free:g} and {tolerances.held:g})",
        )
    spread = _spread(evidence)
    if count < 6 and values[count] < WEYL_SIGMAS * spread:
        return Certainty(
            "ambiguous",
            f"a motion is held by less than the {np.degrees(spread):.2g}° to which the directions of the surfaces are "
            f"known: export a finer mesh (singular value {values[count]:.2g})",
        )
    form = evidence.form(basis)
    touching = momentary(evidence, basis) or (form.type == "general" and meets([item.patch for item in evidence.items]))
    doubt, seat, pin = "", None, None
    if touching:
        doubt = apart_doubt(evidence)
    else:
        firm, vague = _known(evidence, count), _vagueness(evidence, count)
        sure = firm & (vague <= VAGUE_AXIS)
        seat = yield from seat_reading(evidence, twists, preserved, basis, sure, tolerances)
        if seat is None:
            pin = yield from pin_reading(evidence, twists, preserved, basis, sure, tolerances)
        if seat is None and pin is None:
            doubt = yield from _loose_doubt(evidence, twists, count, firm, vague, tolerances)
        if seat is None:
            doubt = doubt or stray_doubt(evidence)
    doubt = doubt or (yield from _near_axes_doubt(evidence, twists, count, tolerances))
    doubt = doubt or _thread_doubt(evidence, basis)
    doubt = doubt or (yield from _torn_doubt(evidence, twists, preserved, count, tolerances))
    doubt = doubt or uncertainty_doubt(evidence.items, form, evidence.frame.length)
    if doubt:
        return Certainty("ambiguous", doubt)
    doubt = yield from _flat_of_ring_doubt(evidence, twists, count, tolerances)
    if doubt:
        return Certainty("ambiguous", doubt)
    prism = _prism_reading(evidence, basis)
    if prism is not None:
        return Certainty("ambiguous", _prism_words(evidence, form, prism), prism)
    reading = _teeth_reading if touching else _scrap_reading
    held = held_by_bends([item.patch for item in evidence.items], basis)
    if held is not basis:
        bent = OtherReading(evidence.form(held), held, (), "bend")
        return Certainty("ambiguous", _bend_words(evidence, basis, held), bent)
    other = seat or pin or (yield from reading(evidence, twists, preserved, basis, tolerances))
    other = other or (yield from stop_reading(evidence, twists, preserved, basis, tolerances, cone))
    if other is not None:
        return doubtful(evidence, basis, other)
    weakest = f"; the weakest constraint has singular value {values[count]:.2g}" if count < 6 else ""
    return Certainty("determined", f"the contact leaves {counted(count, 'freedom')}{weakest}")


def doubtful(evidence: Evidence, basis: Array, other: OtherReading) -> Certainty:
    """That the freedoms `basis` (6, k) may be those of another reading."""
    faces = faces_in_words(evidence, other.out)
    words = f"{evidence.form(basis).type} if {faces} holds; {other.form.type} if it is {ROLES[other.role]}"
    return Certainty("ambiguous", words, other)


def _spread(evidence: Evidence) -> float:
    """rad: how well the directions of the surfaces are known, the mean of all by their weights, but for those that are
    known so little that they do not decide alone in any case.

    By so much, and no more, do singular values change when the rows turn (H. Weyl, Math. Ann. 71, 1912).
    """
    shares = np.add.reduceat(evidence.share, evidence.start[:-1]).tolist()
    turns = [item.patch.mismatch[0] for item in evidence.items]
    known = [(share, turn) for share, turn in zip(shares, turns, strict=True) if turn <= VAGUE_AXIS]
    return sqrt(sum(share * turn**2 for share, turn in known) / max(sum(share for share, _ in known), TINY))


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


def _count(evidence: Evidence, twists: Array, keep: Flags, tolerances: Tolerances) -> Steps[int]:
    """How many freedoms the kept patches leave."""
    preserved = preserved_motions(evidence, twists)
    basis, _ = yield from freedoms(evidence, twists, preserved, keep, tolerances)
    return int(basis.shape[1])


def _known(evidence: Evidence, count: int) -> Flags:
    """(items,) whether they are of known surfaces, on both sides where they leave no freedom of `count`."""
    patches = [item.patch for item in evidence.items]
    return np.array([patch.kind not in HIGHER and (count > 0 or not patch.one_sided) for patch in patches])


def _vagueness(evidence: Evidence, count: int) -> Array:
    """(items,) rad: how well the direction of each patch is known, by the better of its surfaces, or, where they leave
    no freedom of `count`, by both."""
    patches = [item.patch for item in evidence.items]
    return np.array([max(patch.uncertainty[0], 0.0 if count else patch.mismatch[0]) for patch in patches])


def _loose_doubt(
    evidence: Evidence, twists: Array, count: int, firm: Flags, vague: Array, tolerances: Tolerances
) -> Steps[str]:
    """What the patches of known surfaces (`firm`, whose directions are known to `vague` rad) do not hold, the others do
    not hold for sure; bodies become one only by surfaces that are known on both sides."""
    clear = vague <= VAGUE_AXIS
    sure = firm & clear
    if sure.all() or (sure.any() and (yield from _count(evidence, twists, sure, tolerances)) <= count):
        return ""
    if firm.all() or (firm.any() and (yield from _count(evidence, twists, firm, tolerances)) <= count):
        least = float(vague[firm & ~clear].min())
        return (
            f"surfaces decide whose direction is known no better than to {np.degrees(least):.2g}°, as the vertices of "
            f"the mesh scatter: export a finer mesh ({count} of 6 freedoms are left with them)"
        )
    kinds = sorted({item.patch.kind for item in evidence.chosen(~firm)})
    return (
        f"contact along {', '.join(kinds)} without a mating surface decides: give it surfaces that fit each other, or "
        f"state the joint ({count} of 6 freedoms are left with it)"
    )


def _scrap_reading(
    evidence: Evidence, twists: Array, preserved: Flags, basis: Array, tolerances: Tolerances
) -> Steps[OtherReading | None]:
    """What the patches leave free without the scraps among them, where that is more than `basis` (6, k)."""
    slight = scraps(evidence, tolerances.alignment)
    if not slight.any():
        return None
    slight |= [item.patch.kind in HIGHER for item in evidence.items]
    role: ReadingCause = "sliver"
    out = tuple(int(k) for k in np.flatnonzero(slight))
    if slight.all():
        return OtherReading(JointForm("general"), np.eye(6), out, role)
    firm, freed = yield from freedoms_beyond(evidence, twists, preserved, ~slight, tolerances, basis)
    if freed.shape[1] == 0:
        return None
    flats = all(evidence.items[k].patch.kind == "plane" and not evidence.items[k].interferes for k in out)
    if (
        flats
        and not narrow(evidence)[list(out)].any()
        and freed.shape[1] == 1
        and not one_sense(evidence, freed[:, 0], out)
    ):
        return None  # the flat of a shaft holds a turn both ways, however small it is
    return OtherReading(evidence.form(firm), firm, out, role)


def _teeth_reading(
    evidence: Evidence, twists: Array, preserved: Flags, basis: Array, tolerances: Tolerances
) -> Steps[OtherReading | None]:
    """What faces leave free without the points and lines of contact beside them, where those hold all but one of it.

    Teeth and cams drive bodies that something else bears. Where the bodies bear on each other by faces, as planes do,
    and the flanks hold nearly all of what these leave, one of the two is drawn where it is not.
    """
    flanks = np.array([item.patch.kind in TOUCHING for item in evidence.items])
    if basis.shape[1] > 1 or flanks.all() or not flanks.any():
        return None
    firm, _ = yield from freedoms(evidence, twists, preserved, ~flanks, tolerances)
    if firm.shape[1] <= basis.shape[1]:
        return None
    out = tuple(int(k) for k in np.flatnonzero(flanks))
    return OtherReading(evidence.form(firm), firm, out, "flank")


def _near_axes_doubt(evidence: Evidence, twists: Array, count: int, tolerances: Tolerances) -> Steps[str]:
    """Are bodies fixed only by axes or centres that miss each other by a little?"""
    if count:
        return ""
    wide = np.array([item.patch.kind in (*COAXIAL, "sphere") and not item.patch.one_sided for item in evidence.items])
    widened = replace(
        evidence,
        angle=np.where(wide, np.maximum(evidence.angle, TILTED_AXES * tolerances.alignment), evidence.angle),
        position=evidence.position + np.where(wide, MISSED_AXES * evidence.contact, 0.0),
    )
    left = yield from _count(widened, twists, np.ones(len(wide), dtype=bool), tolerances)
    if left == 0:
        return ""
    return f"axes that miss each other by little hold the bodies: as one axis they would leave {left} of 6 freedoms"


def _thread_doubt(evidence: Evidence, basis: Array) -> str:
    """Do facets all round an axis lean like those of a thread, without a thread that was found to mate there?"""
    form = evidence.form(basis)
    if form.type == "screw" or basis.shape[1] > 2:
        return ""
    coaxial = sorted((i for i in evidence.items if i.patch.kind in COAXIAL), key=lambda i: (-i.area, i.index))
    lines = [(item.patch.axis, item.patch.point) for item in coaxial[:THREAD_AXES]]
    if form.axis is not None and form.point is not None:
        lines.append((form.axis, form.point))
    for axis, point in lines:
        advance = _advance(evidence, axis, point)
        if advance:
            return (
                f"facets lean like those of a thread of about {2e3 * np.pi * advance:.3g} mm a turn, "
                "but no two threads of one pitch were found"
            )
    return ""


def _advance(evidence: Evidence, axis: Array, point: Array) -> float:
    """m a radian of the screw about a line that leaves what touches besides surfaces of revolution about it much
    more nearly free than the turn does; 0 where there is none.

    The advance is the one that makes the weighted squares of the speeds along the normals least. It counts where
    contact goes all round the axis, leans against it, and is preserved better by the screw than by the turn.
    """
    leaning = [i for i in evidence.items if i.patch.kind not in COAXIAL or i.patch.one_sided or not _about(i, axis)]
    if all(i.patch.kind == "plane" and _about(i, axis) for i in leaning):
        return 0.0
    points, normals = np.concatenate([i.points for i in leaning]), np.concatenate([i.normals for i in leaning])
    weights = np.concatenate([i.weights for i in leaning])
    arm = points - point
    radial = arm - (arm @ axis)[:, None] * axis
    radius = float(weights @ np.linalg.norm(radial, axis=1) / weights.sum())
    turning, sliding = np.einsum("ij,ij->i", normals, cross(axis, arm)), normals @ axis
    u, v = perpendicular(axis)
    sector = np.floor(np.arctan2(radial @ v, radial @ u) / (2.0 * np.pi) * THREAD_SECTORS).astype(int) % THREAD_SECTORS
    share = np.bincount(sector, weights=weights, minlength=THREAD_SECTORS) / weights.sum()
    filled = np.count_nonzero(share > FILLED_SECTOR) >= THREAD_SECTORS - 1
    if not filled or weights @ sliding**2 < THREAD_SLOPE * weights.sum():
        return 0.0
    advance = -float(weights @ (turning * sliding) / (weights @ sliding**2))
    rest = float(weights @ (turning + advance * sliding) ** 2)
    lean = abs(advance) > THREAD_LEAN * radius and rest < THREAD_FIT * float(weights @ turning**2)
    return advance if lean else 0.0


def _about(item: Item, axis: Array) -> bool:
    return sine(item.patch.axis, axis) < ALONG_AXIS


def _torn_doubt(evidence: Evidence, twists: Array, preserved: Flags, count: int, tolerances: Tolerances) -> Steps[str]:
    """Do flats that may be those of a coarse cylinder hold more than the rest does?"""
    flats = np.array([item.patch.kind == "plane" and item.patch.sides > 0 for item in evidence.items])
    if not flats.any():
        return ""
    if not flats.all():
        basis, _ = yield from freedoms(evidence, twists, preserved, ~flats, tolerances)
    left = 6 if flats.all() else basis.shape[1]
    if left <= count:
        return ""
    sides = max(item.patch.sides for item in evidence.chosen(flats))
    return f"{sides} flats on flats hold it that may be those of a prism, or of a cylinder in a coarse mesh"


def _flat_of_ring_doubt(evidence: Evidence, twists: Array, count: int, tolerances: Tolerances) -> Steps[str]:
    """Do planes hold more than the rest does that lie where the flats of a coarse cylinder beside them do?"""
    flats = np.zeros(len(evidence.items), dtype=bool)
    for ring in (item.patch for item in evidence.items if item.patch.sides and item.patch.kind == "cylinder"):
        radius, least = max(ring.radii), max(ring.radii) * np.cos(np.pi / ring.sides) - ring.chord
        for k, patch in enumerate(item.patch for item in evidence.items):
            if patch.kind == "plane" and abs(float(patch.axis @ ring.axis)) < ALONG_AXIS:
                flats[k] |= bool(least <= abs(float((patch.point - ring.point) @ patch.axis)) <= radius + ring.chord)
    if not flats.any() or flats.all() or (yield from _count(evidence, twists, ~flats, tolerances)) <= count:
        return ""
    area = 1e6 * sum(item.area for item in evidence.chosen(flats))
    return f"{area:.3g} mm² of flats hold it that may be those of the cylinder beside them, in a coarse mesh"


def _bend_words(evidence: Evidence, basis: Array, held: Array) -> str:
    """That a roller in its ring has the freedoms `basis` (6, k) at the first instant, and `held` (6, m) over a
    distance."""
    parts = quoted(next(item.patch for item in evidence.items if item.patch.bends).parts)
    return (
        f"{basis.shape[1]} of 6 freedoms are left at the first instant, and {held.shape[1]} over a distance: about the "
        f"normal of the line in which {parts} touch, the ends of the one go into the other"
    )


def _prism_reading(evidence: Evidence, basis: Array) -> OtherReading | None:
    """What is left of the freedoms `basis` (6, k) where flats that are taken for a coarse cylinder are those of a
    prism: it does not turn."""
    if not any(item.patch.sides and item.patch.kind == "cylinder" for item in evidence.items):
        return None
    _, turns, mixed = np.linalg.svd(basis[:3], full_matrices=True)
    turning = int(np.count_nonzero(turns > SINGLE))
    if not turning:
        return None
    left = basis @ mixed[turning:].T
    return OtherReading(evidence.form(left), left, (), "prism")


def _prism_words(evidence: Evidence, form: JointForm, other: OtherReading) -> str:
    """Both readings, with the sides and the size of the flats."""
    rings = [item.patch for item in evidence.items if item.patch.sides and item.patch.kind == "cylinder"]
    patch = max(rings, key=lambda patch: patch.area)
    return (
        f"{form.type} if the {patch.sides} flats of {2e3 * max(patch.radii):.3g} mm across their corners are a "
        f"cylinder in a coarse mesh; {other.form.type} if they are {ROLES[other.role]}: a stated joint tells"
    )
