"""Which candidate motions which patches preserve: does a patch slide on itself under a motion?

Compared are two weighted sums of squares over the samples of a patch: of their speeds along the normals, and of those
that a normal off by the patch's `angle` and a surface off by its `position` would give at the samples' own velocities.
All but the mixed term of the second are quadratic forms of the twist, and that lies between zero and its bound by
Cauchy and Schwarz. So second moments of each patch tell nearly always (`preserved_by_each`), and only what they leave
open is summed up over the samples (`preserved_motions`).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross, cross_matrix, foot
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED
from kinform.kinematics.joints.pair.constants import SAME_PITCH
from kinform.kinematics.joints.pair.evidence import Evidence
from kinform.mechanism.constants import SIGMAS
from kinform.model.arrays import Array, Flags

THREAD_TURNING = 1e-3
"""Unit twists that turn by less are not tried on a thread. Chosen, not measured."""


BY_SLOPE = ("cone", "helicoid")
"""Kinds of patches whose slope is a fact, which no tolerance excuses."""


def preserved_by_each(asked: Sequence[tuple[Evidence, Array]]) -> list[Flags]:
    """What `preserved_motions` says of the evidence and the twists of each of several pairs."""
    out: dict[int, Flags] = {}
    alike: dict[tuple[int, int], list[int]] = defaultdict(list)
    for k, (evidence, twists) in enumerate(asked):
        if not any(item.patch.kind in BY_SLOPE for item in evidence.items):
            alike[len(evidence.items), twists.shape[1]].append(k)
    for members in alike.values():
        preserved, sure = _by_moments([asked[k] for k in members])
        out |= {k: flags for k, flags, certain in zip(members, preserved, sure, strict=True) if certain}
    return [out[k] if k in out else preserved_motions(*asked[k]) for k in range(len(asked))]


def _by_moments(asked: Sequence[tuple[Evidence, Array]]) -> tuple[Flags, Flags]:
    """(pairs, items, motions) which patches preserve which motions, and (pairs,) whether all of that is certain; of as
    many items and motions each."""
    twists = np.array([of for _, of in asked])[:, None]
    normal, whole = (np.array(of) for of in zip(*(_moments(evidence) for evidence, _ in asked), strict=True))
    angle, position = (np.array([getattr(e, of) for e, _ in asked])[..., None] for of in ("angle", "position"))
    length = np.array([evidence.frame.length for evidence, _ in asked])[:, None, None]
    missed = ((normal @ twists) * twists).sum(axis=2)
    squares = ((_of_velocity(whole) @ twists) * twists).sum(axis=2)
    shift = position / length * np.sqrt(np.square(twists[:, :, :3]).sum(axis=2))
    share = whole[..., 3, 3, None]
    apart = angle**2 * squares + shift**2 * share
    mixed = 2.0 * angle * shift * np.sqrt(share * np.maximum(squares, 0.0))
    rounding = ARITHMETIC * (np.trace(normal, axis1=2, axis2=3) + np.trace(whole, axis1=2, axis2=3))
    preserved = missed + rounding[..., None] <= apart
    broken = missed - rounding[..., None] > apart + mixed
    return preserved, (preserved | broken).all(axis=(1, 2))


def _moments(evidence: Evidence) -> tuple[Array, Array]:
    """(items, 6, 6) weighted sums of the products of each patch's rows, and (items, 4, 4) of its arms with a one."""
    rows, arms = evidence.rows, np.ones((len(evidence.rows), 4))
    arms[:, :3] = evidence.arms
    share = evidence.share[:, None]
    weighted_rows, weighted_arms = (rows * share).T, (arms * share).T
    bounds = evidence.start.tolist()
    pieces = [slice(a, b) for a, b in zip(bounds, bounds[1:], strict=False)]
    normal, whole = np.empty((len(pieces), 6, 6)), np.empty((len(pieces), 4, 4))
    for k, of in enumerate(pieces):
        np.matmul(weighted_rows[:, of], rows[of], out=normal[k])
        np.matmul(weighted_arms[:, of], arms[of], out=whole[k])
    return normal, whole


def _of_velocity(moments: Array) -> Array:
    """(…, 6, 6): of the moments (…, 4, 4) of arms, the form of a twist that is the sum of the squared velocities."""
    out = np.empty((*moments.shape[:-2], 6, 6))
    second, first, share = moments[..., :3, :3], moments[..., :3, 3], moments[..., 3, 3, None, None]
    out[..., :3, :3] = np.trace(second, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - second
    out[..., :3, 3:] = cross_matrix(first)
    out[..., 3:, :3] = -out[..., :3, 3:]
    out[..., 3:, 3:] = share * np.eye(3)
    return out


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
