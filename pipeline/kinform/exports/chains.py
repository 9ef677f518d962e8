"""Joints as chains of turns and slides with links without mass between them, for URDF and SDF."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kinform.behaviour.primitives import Ball, OneFreedom
from kinform.exports.robot import Robot, RobotLink
from kinform.model.arrays import Array

__all__ = ["Hinge", "chain"]


@dataclass(frozen=True, eq=False)
class Hinge:
    """One turn, slide, or rigid connection between two links, both by name."""

    name: str
    type: str
    """fixed, revolute or prismatic."""
    parent: str
    child: str
    offset: Array
    """(3,) m from the parent's frame to the child's."""
    axis: Array
    """(3,) unit; zero when fixed."""
    between: bool = False
    """The child is a link without mass."""
    follows: tuple[str, float] | None = None
    """The slide of a screw: the turn that it follows, and metres a radian."""
    joint: str = ""
    """Subject of the joint."""


def chain(robot: Robot, link: RobotLink, taken: set[str]) -> list[Hinge]:
    """The hinges from the parent to a link; names of the links between are added to `taken`."""
    joint = link.link.joint
    assert joint is not None
    parent = robot.links[link.link.parent].name
    steps: list[tuple[str, str, Array, tuple[str, float] | None]] = []
    for motion in link.link.motions:
        name = robot.joint_names[motion.name]
        steps.extend(_steps(name, motion.primitive))
    if not steps:
        return [Hinge(robot.joint_names[joint.subject], "fixed", parent, link.name, link.offset, np.zeros(3))]
    out = []
    for k, (name, kind, axis, follows) in enumerate(steps):
        last = k == len(steps) - 1
        child = link.name if last else _free(f"{link.name}_{k + 1}", taken)
        offset = link.offset if k == 0 else np.zeros(3)
        out.append(Hinge(name, kind, parent, child, offset, axis, not last, follows, joint.subject))
        parent = child
    return out


def _steps(name: str, primitive: OneFreedom | Ball) -> list[tuple[str, str, Array, tuple[str, float] | None]]:
    if isinstance(primitive, Ball):
        return [(f"{name}.{axis}", "revolute", row, None) for axis, row in zip("xyz", np.eye(3), strict=True)]
    if not primitive.omega.any():
        return [(name, "prismatic", primitive.slide, None)]
    lead = float(primitive.slide @ primitive.omega)
    turn = (name, "revolute", primitive.omega, None)
    if lead == 0.0:
        return [turn]
    return [turn, (f"{name}.slide", "prismatic", primitive.omega, (name, lead))]


def _free(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    taken.add(name)
    return name
