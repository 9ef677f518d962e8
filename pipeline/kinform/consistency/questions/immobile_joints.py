"""Stated joints that do not move at all, whatever the assembly does."""

from __future__ import annotations

import numpy as np

from kinform.foundation.rounding import ARITHMETIC
from kinform.kinematics.mobility.named_freedoms import Motions
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.function import IntendedJoint
from kinform.model.kinematics import Kinematics
from kinform.model.names import BodyName


def immobile_joints(assembly: Assembly, kinematics: Kinematics) -> tuple[str, ...]:
    """Names of the joints of [function] that are to move, and whose bodies no freedom of the assembly moves relative to
    each other."""
    motions = Motions.of(kinematics)
    return tuple(
        joint.name
        for joint in assembly.function.joints
        if is_immobile(joint, motions.relative(*bodies_between(assembly, kinematics, joint)))
    )


def bodies_between(assembly: Assembly, kinematics: Kinematics, joint: IntendedJoint) -> tuple[BodyName, BodyName]:
    """Names of the bodies that a stated joint is between; one twice where they are one."""
    first, second = (kinematics.body_of(assembly.parts_of(name)[0]).name for name in joint.between)
    return first, second


def is_immobile(joint: IntendedJoint, relative: Array) -> bool:
    """Whether a joint that is to move does not: `relative` (k, 6) twists of its second body relative to its first."""
    return joint.type != "fixed" and float(np.abs(relative).max(initial=0.0)) <= ARITHMETIC
