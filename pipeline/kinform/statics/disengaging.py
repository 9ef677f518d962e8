"""Where a slider has left what guides it, in a run.

A joint that is left while others still guide its bodies the same way is no loss: a bar that runs in two bushes may
leave one. Joints are left one after the other, and the first without which the assembly moves otherwise is a slip.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.kinematics.mobility.guides import guide
from kinform.kinematics.separation.contact_rows import is_stated
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.simulation import Simulation

SLIDES = {"prismatic": 0, "cylindrical": 1, "screw": 0}
"""Column of the coordinate that slides, by type of joint."""


@dataclass(frozen=True, eq=False)
class Slip:
    """A joint whose slider has left all that guides it."""

    joint: Joint
    time: float
    value: float
    """rad or m then."""
    limit: float
    """rad or m at which the last of its patches ends."""


def slips(design: Design) -> tuple[Slip, ...]:
    """First time at which each joint with a slide has left the last of the patches along which it slides, of those
    joints that nothing else replaces."""
    kinematics = design.kinematics
    assert kinematics is not None
    guiding = list(kinematics.joints)
    out = []
    for slip in sorted(_left(design), key=lambda slip: slip.time):
        others = [joint for joint in guiding if joint is not slip.joint]
        if _mobility(kinematics, others) == _mobility(kinematics, guiding):
            guiding = others
        else:
            out.append(slip)
    order = [joint.name for joint in kinematics.joints]
    return tuple(sorted(out, key=lambda slip: order.index(slip.joint.name)))


def _mobility(kinematics: Kinematics, joints: Sequence[Joint]) -> int:
    """Freedoms of first order that these joints leave, at the pose of the meshes."""
    return JointGraph(kinematics.bodies, tuple(joints)).close(2.0 * kinematics.matrix.length).mobility


def _left(design: Design) -> list[Slip]:
    """The first time at which each joint has left its own patches."""
    run, kinematics, contacts = design.simulation, design.kinematics, design.contacts
    assert run is not None and kinematics is not None and contacts is not None
    parts = {body.name: body.parts for body in kinematics.bodies}
    out = []
    for joint in kinematics.joints:
        if joint.type not in SLIDES or joint.name not in run.joint_names or joint.axis is None or is_stated(joint):
            continue
        values = _coordinate(run, joint)
        # a cylindrical joint as a guide sees it
        sliding = replace(joint, type="prismatic") if joint.type == "cylindrical" else joint
        low, high = guide(design.assembly, design.surfaces, contacts, sliding, parts[joint.bodies[1]])
        beyond = np.flatnonzero((values < low) | (values > high))
        if len(beyond):
            value = float(values[beyond[0]])
            out.append(Slip(joint, float(run.time[beyond[0]]), value, low if value < low else high))
    return out


def slide_of(run: Simulation, joint: Joint) -> Array:
    """(T,) m that the joint has slid along its axis; zero for those that do not."""
    if joint.type not in SLIDES:
        return np.zeros(len(run.time))
    values: Array = _coordinate(run, joint)
    return values * (joint.pitch or 0.0) / (2.0 * math.pi) if joint.type == "screw" else values


def _coordinate(run: Simulation, joint: Joint) -> Array:
    """(T,) rad or m: the coordinate along which the joint slides."""
    return np.asarray(
        run.joint_position[:, int(run.joint_offset[run.joint_names.index(joint.name)]) + SLIDES[joint.type]]
    )
