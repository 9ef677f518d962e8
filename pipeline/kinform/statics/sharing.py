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

from kinform.foundation.algebra.subspaces import null_space
from kinform.foundation.algebra.vectors import cross_matrix, perpendicular
from kinform.mechanism.constants import FREE
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.simulation import Simulation

MOST_JOINTS = 60
"""Joints up to which all wrenches are looked for: the time grows with the third power. A choice."""


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
        slides += perpendicular(axis)
    if joint.type == "universal" and joint.axis2 is not None:
        turns.append(R @ X[:3, :3] @ joint.axis2)
    if joint.type == "screw":
        screws.append(np.concatenate([axis, (joint.pitch or 0.0) / (2.0 * math.pi) * axis]))
    return turns, slides, screws


def decidable(run: Simulation) -> bool:
    """Whether all wrenches that balance can be looked through: of few joints, and without gears among them."""
    return len(run.joint_names) <= MOST_JOINTS and not run.gear_names


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
        block[:3, 3:] = cross_matrix(place) / length
        for name, sign in zip(joint.bodies, (-1.0, 1.0), strict=True):
            if name in moving:
                rows[6 * moving[name] : 6 * moving[name] + 6, 6 * n : 6 * n + 6] += sign * block
        turning, sliding, screws = axes_of(joint, turns[n], across[n])
        freedoms = [np.concatenate([axis, np.zeros(3)]) for axis in turning]
        freedoms += [np.concatenate([np.zeros(3), axis]) for axis in sliding]
        scaled = [screw * np.array([length, length, length, 1.0, 1.0, 1.0]) for screw in screws]
        freedoms += [screw / np.linalg.norm(screw) for screw in scaled]
        for freedom in freedoms:
            row = np.zeros(6 * len(joints))
            row[6 * n : 6 * n + 6] = freedom
            still.append(row)
    matrix = np.concatenate([rows, np.array(still).reshape(-1, 6 * len(joints))])
    # a balance depends on others as in the count of freedoms
    return null_space(matrix, FREE).reshape(-1, len(joints), 6)
