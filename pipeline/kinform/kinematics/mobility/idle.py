"""Idle freedoms: a bolt, pin or roller that only spins.

A freedom is idle when it moves a single body, all of whose contact surfaces slide on themselves, and
no intended joint names it (results contract). Only turns about an axis of revolution qualify: a block
that slides on a table leaves its place, a bolt that spins does not.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.screws import Frame, rotation, scaled, span, twist_at_origin
from kinform.foundation.algebra.vectors import cross, perpendicular
from kinform.kinematics.pair.evidence import COAXIAL
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Body, Joint

__all__ = ["idle_freedoms"]


EXACT = 1e-6
SECTORS = 12


def idle_freedoms(
    body: Body,
    joints: Sequence[Joint],
    patches: Sequence[Patch],
    intended: Sequence[IntendedJoint],
    size: float,
    balls: Mapping[int, Array] | None = None,
) -> Array:
    """(k, 6) independent idle turns of the body (ω; v at the world's origin).

    `joints`: all joints of the body; `patches`: the contacts that carry them; `intended`: intended
    joints between this body and its neighbours in `joints`; `size` of the assembly (m); `balls`: by
    position in `patches`, the centre (3,) of the body's own surface where that is a sphere that touches at points
    or along a line.
    """
    if not joints or not patches or body.ground:
        return np.zeros((0, 6))
    frame = Frame.of(np.concatenate([p.points for p in patches]))
    patches = [
        replace(p, kind="sphere", point=balls[k]) if balls is not None and k in balls else p
        for k, p in enumerate(patches)
    ]
    found = []
    spaces = [span(scaled(joint.twists.T, frame)) if joint.freedoms else np.zeros((6, 0)) for joint in joints]
    for axis, point in _candidates(patches, size):
        twist = rotation(axis, point, frame)
        if not all(_contains(free, twist) for free in spaces):
            continue
        if not all(_invariant(patch, axis, point, size) for patch in patches):
            continue
        if not any(_names(wanted, axis, point, len(joints) == 1, size) for wanted in intended):
            found.append(twist)
    return _independent(found, frame)


def _independent(found: Sequence[Array], frame: Frame) -> Array:
    """The first of the turns that are independent, of rate 1."""
    kept: list[Array] = []
    for twist in found:
        if span(np.array([*kept, twist]).T).shape[1] > len(kept):
            kept.append(twist)
    turns = twist_at_origin(np.array(kept).reshape(-1, 6).T, frame).T
    unit: Array = turns / np.linalg.norm(turns[:, :3], axis=1)[:, None]
    return unit


def _candidates(patches: Sequence[Patch], size: float) -> list[tuple[Array, Array]]:
    """Axes of revolution: of coaxial patches, through two centres, and three at a single centre."""
    lines = [(p.axis, p.point) for p in patches if p.kind in COAXIAL]
    centres = [p.point for p in patches if p.kind == "sphere"]
    for k, a in enumerate(centres):
        for b in centres[:k]:
            far = float(np.linalg.norm(b - a))
            if far > 1e-4 * size:
                lines.append(((b - a) / far, a))
    if centres and not lines:
        lines = [(e, centres[0]) for e in np.eye(3)]
    return lines


def _contains(free: Array, twist: Array) -> bool:
    """Is the turn among the freedoms (6, k), orthonormal?"""
    return float(np.linalg.norm(twist - free @ (free.T @ twist))) < 1e-3


def _invariant(patch: Patch, axis: Array, point: Array, size: float) -> bool:
    """Does the patch, as bounded as it is, turn onto itself?"""
    if patch.kind in COAXIAL:
        parallel = float(np.linalg.norm(cross(patch.axis, axis))) < 1e-3
        away = cross(patch.point - point, axis)
        return parallel and float(np.linalg.norm(away)) <= abs(patch.gap) + 1e-4 * size
    if patch.kind == "sphere":
        away = cross(patch.point - point, axis)
        return float(np.linalg.norm(away)) <= abs(patch.gap) + 1e-4 * size
    if patch.kind != "plane" or float(np.linalg.norm(cross(patch.axis, axis))) > 1e-3:
        return False
    u, v = perpendicular(axis)
    arm = patch.points - point
    sector = np.floor(np.arctan2(arm @ v, arm @ u) / (2.0 * np.pi) * SECTORS).astype(int) % SECTORS
    area = np.bincount(sector, weights=patch.weights, minlength=SECTORS)
    return bool(area.min() > 0.25 * area.mean())


def _names(wanted: IntendedJoint, axis: Array, point: Array, leaf: bool, size: float) -> bool:
    """Does the intended joint name this turn? A turn about its own axis, or any turn of a body that
    has no other joint."""
    if wanted.type == "fixed":
        return False
    if leaf:
        return True
    if wanted.type not in ("revolute", "cylindrical", "screw") or wanted.axis is None or wanted.point is None:
        return False
    parallel = float(np.linalg.norm(cross(wanted.axis, axis))) < 0.02
    return parallel and float(np.linalg.norm(cross(wanted.point - point, axis))) < 1e-2 * size
