"""How well the lengths in closed loops are known: what decides between branches of a motion that nearly meet."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.foundation.algebra.vectors import cross
from kinform.foundation.constants import COVERAGE
from kinform.foundation.graphs.graph import blocks
from kinform.foundation.rounding import ARITHMETIC
from kinform.model.kinematics import Joint, Kinematics


def loop_uncertainty(kinematics: Kinematics, length: float) -> float:
    """By how much loops may be off (rad, and shares of `length`, m): of the worst block of loops.

    The places of its joints, and in loops that are not planar also their directions, add up as independent errors do.
    """
    body = {body.name: k for k, body in enumerate(kinematics.bodies)}
    joints = kinematics.joints
    worst = 0.0
    for block in blocks(len(body), [(body[joint.bodies[0]], body[joint.bodies[1]]) for joint in joints]):
        members = [joints[k] for k in block]
        if len(members) > 1:
            places = [joint.point_uncertainty / length for joint in members]
            turns = [] if _planar(members) else [joint.axis_uncertainty for joint in members]
            worst = max(worst, COVERAGE * float(np.linalg.norm([*places, *turns])))
    return worst


def _planar(joints: Sequence[Joint]) -> bool:
    """Whether all turns are about one direction: tilts of such axes change lengths by their squares only."""
    axes = [joint.axis for joint in joints if joint.type != "prismatic"]
    return not any(a is None or axes[0] is None or np.linalg.norm(cross(a, axes[0])) > ARITHMETIC for a in axes)
