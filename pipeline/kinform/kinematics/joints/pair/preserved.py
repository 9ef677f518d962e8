"""Which candidate motions which patches preserve: does a patch slide on itself under a motion?

Compared are two weighted sums of squares over the samples of a patch: of their speeds along the normals, and of those
that a normal off by the patch's `angle` and a surface off by its `position` would give at the samples' own velocities.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import cross, foot
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.kinematics.joints.pair.constants import SAME_PITCH
from kinform.kinematics.joints.pair.evidence import Evidence
from kinform.mechanism.constants import SIGMAS
from kinform.model.arrays import Array, Flags

THREAD_TURNING = 1e-3
"""Unit twists that turn by less are not tried on a thread. Chosen, not measured."""


def preserved_motions(evidence: Evidence, twists: Array, slack: float = 1.0) -> Flags:
    """(items, motions): does the patch slide on itself, within `slack` times its tolerances?

    `twists` (6, motions), scaled in the evidence's frame.
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
            slides = turning < SOLVED
            allowed[samples, slides] = (SIGMAS * item.patch.uncertainty[0] + SINGLE) * speed[samples, slides]
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
    turning = square > (THREAD_TURNING / frame.length) ** 2
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
        & (np.abs(advance - wanted) <= slack * SAME_PITCH * abs(wanted))
    )
