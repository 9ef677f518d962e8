"""Which motions the patches between two bodies leave free, and the singular values that say so.

Each candidate motion is tested against each patch; the freedoms are the motions that every patch
preserves, and the singular values of the rows, made exactly consistent with those, confirm that nothing
else is free.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, foot, norm
from kinform.kinematics import constants
from kinform.kinematics.pair.evidence import Evidence
from kinform.kinematics.pair.in_step import Remainder, Remains, Steps
from kinform.kinematics.pair.lower_pairs import nearest_pair
from kinform.model.arrays import Array, Flags
from kinform.model.tolerances import Tolerances


def preserved_motions(evidence: Evidence, twists: Array, slack: float = 1.0) -> Flags:
    """(items, motions): does the patch slide on itself, within `slack` times its tolerances?

    `twists` (6, motions), scaled in the evidence's frame. Compared are weighted sums of squares over the samples of a
    patch: of its speeds along the normals, and of those that a normal off by `angle` and a surface off by `position`
    would give at the sample's own velocity.
    """
    counts = np.diff(evidence.start)
    velocity = twists[3:].T[None] + cross(twists[:3].T[None], evidence.arms[:, None])
    speed = np.linalg.norm(velocity, axis=2)
    turning = np.linalg.norm(twists[:3], axis=0)
    allowed = np.repeat(evidence.angle, counts)[:, None] * speed
    allowed += np.repeat(evidence.position / evidence.frame.length, counts)[:, None] * turning
    for k, item in enumerate(evidence.items):
        if item.patch.kind == "cone":
            # the slope of a cone is a fact, not a misalignment: slides along it have no slack
            samples = slice(evidence.start[k], evidence.start[k + 1])
            slides = turning < constants.PURE_SLIDE
            allowed[samples, slides] = (constants.SIGMAS * item.patch.uncertainty[0] + constants.CONE_SLACK) * speed[
                samples, slides
            ]
    weight = evidence.share[:, None]
    first = evidence.start[:-1]
    missed = np.add.reduceat(weight * (evidence.rows @ twists) ** 2, first, axis=0)
    limit = np.add.reduceat(weight * allowed**2, first, axis=0)
    preserved = np.asarray(missed <= slack**2 * limit + 1e-24)
    for k, item in enumerate(evidence.items):
        if item.patch.kind == "helicoid":
            preserved[k] = _screws(evidence, k, twists, slack)
    return preserved


def _screws(evidence: Evidence, number: int, twists: Array, slack: float) -> Flags:
    """(motions,): is it the screw motion of this thread? Its slope is a fact, like that of a cone: however small,
    no tolerance makes a turn or a slide of it. Only the axis may be off."""
    item, frame = evidence.items[number], evidence.frame
    angular, linear = twists[:3] / frame.length, twists[3:]
    square = np.einsum("ij,ij->j", angular, angular)
    turning = square > (constants.THREAD_TURNING / frame.length) ** 2
    square = np.where(turning, square, 1.0)
    advance = np.einsum("ij,ij->j", angular, linear) / square
    feet = frame.centre[:, None] + np.cross(angular, linear, axis=0) / square
    axis, middle = item.patch.axis, item.middle
    direction = angular / np.sqrt(square)
    tilt = np.linalg.norm(np.cross(axis[:, None], direction, axis=0), axis=0)
    apart = foot(item.patch.point, axis, middle)[:, None] - feet
    apart = np.linalg.norm(apart - direction * np.einsum("ij,ij->j", direction, apart), axis=0)
    angle, reach = float(evidence.angle[number]), float(np.linalg.norm(item.points - middle, axis=1).max())
    wanted = item.patch.pitch / (2.0 * np.pi)
    return np.asarray(
        turning
        & (tilt <= slack * angle)
        & (apart <= slack * (float(evidence.position[number]) + angle * reach))
        & (np.abs(advance - wanted) <= slack * constants.SAME_PITCH * abs(wanted))
    )


def freedoms(
    evidence: Evidence, twists: Array, preserved: Flags, keep: Flags, tolerances: Tolerances
) -> Steps[Remains]:
    """Basis (6, k) of what the kept patches leave free, and the singular values (6,) that say so.

    `preserved` (items, motions) is what `preserved_motions` says of the candidate `twists` (6, motions); `keep`
    (items,) which patches count.
    """
    rows, share = evidence.rows, evidence.share
    if not keep.all():
        chosen = np.repeat(keep, np.diff(evidence.start))
        rows, share, preserved = rows[chosen], share[chosen], preserved[keep]
    known = _independent(evidence, twists[:, preserved.all(axis=0)], keep)
    basis, values = yield Remainder(rows, share, known, tolerances.free)
    if evidence.form(basis).type == "general":
        rounded = nearest_pair(basis, evidence.frame)
        if rounded is not None and _all_preserve(evidence, rounded, keep):
            return (yield Remainder(rows, share, rounded, tolerances.free))
    return basis, values


def _independent(evidence: Evidence, twists: Array, keep: Flags) -> Array:
    """Orthonormal basis (6, k) of twists (6, n) that the kept patches preserve. One that differs from those before it
    by less than the patches can tell adds nothing."""
    basis = np.zeros((6, 0))
    for twist in twists.T:
        rest = twist - basis @ (basis.T @ twist) if basis.size else twist
        size = norm(rest)
        unit = rest / max(size, 1e-300)
        if size > constants.CLEARLY_NEW or (
            size > constants.NEW_FREEDOM and _all_preserve(evidence, unit, keep, constants.DIFFERENCE_SLACK)
        ):
            basis = np.column_stack([basis, unit])
    return basis


def _all_preserve(evidence: Evidence, twists: Array, keep: Flags, slack: float = 1.0) -> bool:
    """Does every kept patch slide on itself under the twist (6,), or each of the twists (6, n)?"""
    twists = twists.reshape(6, -1)
    return bool(preserved_motions(evidence, twists, slack)[keep].all())
