"""A run as the designer sees it: joints by the names that the function gives them, values in the designer's sense."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from kinform.frozen import dataclass
from kinform.function.joint_names import Resolution, resolve_joint
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.collisions import JointRange, RangeEnd
from kinform.model.kinematics import Joint, Kinematics
from kinform.model.simulation import Simulation

ALONG_AN_AXIS = ("revolute", "prismatic", "cylindrical", "screw")
"""Joints whose values turn their sign with the axis, and with the order of the bodies."""


@dataclass(frozen=True)
class DesignersJoint:
    """What the function calls a derived joint, and the sign of the designer's value in kinform's."""

    name: str
    sign: int


def designers_joints(assembly: Assembly, kinematics: Kinematics) -> dict[str, DesignersJoint]:
    """By the names of derived joints, of those that just one intended joint stands for: of several the one that is
    stated in the outermost assembly.

    A joint of several freedoms without an axis in common, whose bodies or axis the designer states the other way round,
    is left out: its values are no one's but kinform's. So is a name that another joint has.
    """
    found = [resolve_joint(assembly, kinematics, intended.name) for intended in assembly.function.joints]
    count = Counter((one.joint.name, _depth(one.name)) for one in found if one.joint is not None)
    derived = {joint.name for joint in kinematics.joints}
    out: dict[str, DesignersJoint] = {}
    seen: set[str] = set()
    for one in sorted(found, key=lambda one: _depth(one.name)):
        if one.joint is None or one.joint.name in seen:
            continue
        seen.add(one.joint.name)
        if count[one.joint.name, _depth(one.name)] > 1 or (one.name in derived and one.name != one.joint.name):
            continue
        if one.joint.type in ALONG_AN_AXIS or (one.sign > 0 and one.bodies == one.joint.bodies):
            out[str(one.joint.name)] = DesignersJoint(one.name, one.sign)
    return out


def _depth(name: str) -> int:
    """Of the assembly that states a joint: 0 of the outermost."""
    return name.count("/")


def joint_as_stated(found: Resolution) -> Joint | None:
    """The joint that a name stands for, with the bodies in the designer's order, the axis and the range in the
    designer's sense; None where there is none. One of several freedoms without an axis in common is as it was."""
    joint = found.joint
    if joint is None or joint.type not in ALONG_AN_AXIS:
        return joint
    along = found.sign if found.bodies == joint.bodies else -found.sign
    ends = (joint.range_lower, joint.range_upper)
    if found.sign < 0:
        ends = (_minus(joint.range_upper), _minus(joint.range_lower))
    first, second = joint.bodies if found.bodies == joint.bodies else joint.bodies[::-1]
    axis = None if joint.axis is None else along * joint.axis + 0.0
    return replace(joint, bodies=(first, second), axis=axis, range_lower=ends[0], range_upper=ends[1])


def as_intended(run: Simulation, known: Mapping[str, DesignersJoint]) -> Simulation:
    """The run with the joints that are `known` under the designer's names, in the designer's sense. Wrenches stay those
    on the bodies of the derived joints, and sentences what they were."""
    named = {name: one.name for name, one in known.items()}
    of_joint = [known[name].sign if name in known else 1 for name in run.joint_names]
    signs = np.repeat(np.array(of_joint, dtype=np.int64), np.diff(run.joint_offset))

    def turned(values: Array) -> Array:
        return values * signs + 0.0 if values.size and values.shape[1] == len(signs) else values

    of_drive = np.array([known[use.joint].sign if use.joint in known else 1 for use in run.drives], dtype=np.int64)
    return replace(
        run,
        drive_effort=run.drive_effort * of_drive + 0.0 if run.drive_effort.size else run.drive_effort,
        drive_speed=run.drive_speed * of_drive + 0.0 if run.drive_speed.size else run.drive_speed,
        joint_names=tuple(named.get(name, name) for name in run.joint_names),
        joint_position=turned(run.joint_position),
        joint_velocity=turned(run.joint_velocity),
        joint_effort=turned(run.joint_effort),
        joint_acceleration=turned(run.joint_acceleration),
        drives=tuple(replace(use, joint=named.get(use.joint, use.joint)) for use in run.drives),
        friction_joints=tuple(named.get(name, name) for name in run.friction_joints),
        friction_effort=_frictions(run, known),
        gear_names=tuple(named.get(name, name) for name in run.gear_names),
        ranges=None
        if run.ranges is None
        else tuple(range_as_stated(item, known[item.joint]) if item.joint in known else item for item in run.ranges),
    )


def _frictions(run: Simulation, known: Mapping[str, DesignersJoint]) -> Array:
    """(T, M) what the frictions give, in the designer's senses."""
    if not run.friction_joints:
        return run.friction_effort
    signs = np.array([known[name].sign if name in known else 1 for name in run.friction_joints])
    return np.asarray(run.friction_effort * signs + 0.0)


def range_as_stated(item: JointRange, one: DesignersJoint | Resolution) -> JointRange:
    """The range of a derived joint in the designer's name and sense."""
    ends = (item.lower, item.upper) if one.sign > 0 else (_mirrored(item.upper), _mirrored(item.lower))
    return replace(item, joint=type(item.joint)(one.name), lower=ends[0], upper=ends[1])


def _mirrored(end: RangeEnd) -> RangeEnd:
    return replace(end, value=_minus(end.value), leaves=_minus(end.leaves))


def _minus(value: float | None) -> float | None:
    return None if value is None else 0.0 - value
