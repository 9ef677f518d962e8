"""Whether contacts can share a load by pushing alone, where redundant constraints leave their reactions open.

The wrenches of a run are one of many that balance; any set of wrenches that balance among themselves, and do nothing
along the freedoms of the joints, may be added. The simulated motion needs no pull where some of all these can be made
by pushes in every contact at once (non-negative least squares over all contacts together); where none can, parts must
separate however the load is shared.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from kinform.model.arrays import Array
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.simulation import Simulation

__all__ = ["axes_of", "decidable", "self_stresses"]


DEPENDENT = 1e-7
"""Relative singular value below which a balance depends on the others, as in the count of freedoms."""
MOST = 60
"""Joints up to which all wrenches are looked for."""


def axes_of(joint: Joint, R: Array, X: Array) -> tuple[list[Array], list[Array], list[Array]]:
    """Turns, slides and screws (h u; u, as 6 numbers about the joint's point) of a joint in the world, where its first
    body is turned by R and its second displaced by X (4, 4) as the first sees it."""
    axis = None if joint.axis is None else R @ joint.axis
    turns: list[Array] = []
    slides: list[Array] = []
    screws: list[Array] = []
    if joint.type == "spherical":
        turns = list(np.eye(3))
    if axis is None:
        return turns, slides, screws
    if joint.type in ("revolute", "cylindrical", "planar", "universal"):
        turns.append(axis)
    if joint.type in ("prismatic", "cylindrical"):
        slides.append(axis)
    if joint.type == "planar":
        slides += list(np.linalg.svd(axis[None])[2][1:])
    if joint.type == "universal" and joint.axis2 is not None:
        turns.append(R @ X[:3, :3] @ joint.axis2)
    if joint.type == "screw":
        screws.append(np.concatenate([axis, (joint.pitch or 0.0) / (2.0 * math.pi) * axis]))
    return turns, slides, screws


def decidable(run: Simulation) -> bool:
    """Whether all wrenches that balance can be looked through: of few joints, and without gears among them."""
    return len(run.joint_names) <= MOST and not run.gear_names


def self_stresses(
    kinematics: Kinematics, run: Simulation, joints: Sequence[Joint], turns: Array, across: Array, k: int, length: float
) -> Array:
    """(m, J, 6) wrenches (τ/length; f) on the second bodies of all `joints` of a run, about their points as the first
    bodies carry them, in the world, that balance among themselves at time k.

    `turns` (J, 3, 3): of the first bodies then; `across` (J, 4, 4): displacements of the second as the first sees it.
    """
    ground = {body.name for body in kinematics.bodies if body.ground}
    moving = {name: n for n, name in enumerate(name for name in run.body_names if name not in ground)}
    rows = np.zeros((6 * len(moving), 6 * len(joints)))
    still = []
    for n, joint in enumerate(joints):
        at = np.zeros(3) if joint.point is None else joint.point
        body = run.body_names.index(joint.bodies[0])
        place = turns[n] @ at + run.p_WB[k, body]
        block = np.eye(6)
        block[:3, 3:] = (
            np.array([[0, -place[2], place[1]], [place[2], 0, -place[0]], [-place[1], place[0], 0]]) / length
        )
        for name, sign in zip(joint.bodies, (-1.0, 1.0), strict=True):
            if name in moving:
                rows[6 * moving[name] : 6 * moving[name] + 6, 6 * n : 6 * n + 6] += sign * block
        for kind, offset in zip(axes_of(joint, turns[n], across[n])[:2], (0, 3), strict=True):
            for axis in kind:
                row = np.zeros(6 * len(joints))
                row[6 * n + offset : 6 * n + offset + 3] = axis
                still.append(row)
        for screw in axes_of(joint, turns[n], across[n])[2]:
            row = np.zeros(6 * len(joints))
            row[6 * n : 6 * n + 6] = screw * np.array([length, length, length, 1.0, 1.0, 1.0])
            still.append(row / np.linalg.norm(row))
    matrix = np.concatenate([rows, np.array(still).reshape(-1, 6 * len(joints))])
    _, values, right = np.linalg.svd(matrix)
    rank = int(np.count_nonzero(values > DEPENDENT * max(values.max(initial=0.0), 1e-300)))
    return np.asarray(right[rank:].reshape(-1, len(joints), 6))
