"""What URDF and SDF have in common: joints as chains of turns and slides with links without mass between them, and what
formats of trees of links cannot say."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Literal

import numpy as np

from kinform.behaviour import DcMotor, EffortDrive, MotionDrive, Servo
from kinform.behaviour.primitives import Ball, OneFreedom
from kinform.exports.names import free_name
from kinform.formats.description.writing.robot_model import Driver, RobotLink, RobotModel
from kinform.frozen import dataclass
from kinform.model.arrays import Array

_DRIVES: dict[type[Driver], str] = {
    MotionDrive: "its motion follows a law",
    EffortDrive: "its effort follows a law",
    Servo: "a servo with its gains and target",
    DcMotor: "a DC motor with its voltage",
}


HingeType = Literal["fixed", "revolute", "prismatic"]


@dataclass(frozen=True, eq=False)
class Hinge:
    """One turn, slide, or rigid connection between two links, both by name."""

    name: str
    type: HingeType
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
    coordinate: int = 0
    """Which of its coordinates it is."""


@dataclass(frozen=True, eq=False)
class _Step:
    """A turn or slide of a motion; `follows` as of `Hinge`."""

    name: str
    type: HingeType
    axis: Array
    follows: tuple[str, float] | None = None


def chain(robot: RobotModel, link: RobotLink, taken: set[str]) -> list[Hinge]:
    """The hinges from the parent to a link; names of the links between are added to `taken`."""
    joint = link.link.joint
    assert joint is not None
    parent = robot.links[link.link.parent].name
    steps = [
        (step, motion.coordinate)
        for motion in link.link.motions
        for step in _steps(robot.joint_names[motion.name], motion.primitive)
    ]
    if not steps:
        return [Hinge(robot.joint_names[joint.subject], "fixed", parent, link.name, link.offset, np.zeros(3))]
    out = []
    for k, (step, coordinate) in enumerate(steps):
        last = k == len(steps) - 1
        child = link.name if last else free_name(f"{link.name}_{k + 1}", taken)
        taken.add(child)
        offset = link.offset if k == 0 else np.zeros(3)
        hinge = Hinge(step.name, step.type, parent, child, offset, step.axis, not last, step.follows)
        out.append(replace(hinge, joint=joint.subject, coordinate=coordinate))
        parent = child
    return out


def _steps(name: str, primitive: OneFreedom | Ball) -> list[_Step]:
    if isinstance(primitive, Ball):
        return [_Step(f"{name}.{axis}", "revolute", row) for axis, row in zip("xyz", np.eye(3), strict=True)]
    if not primitive.omega.any():
        return [_Step(name, "prismatic", primitive.slide)]
    lead = float(primitive.slide @ primitive.omega)
    turn = _Step(name, "revolute", primitive.omega)
    if lead == 0.0:
        return [turn]
    return [turn, _Step(f"{name}.slide", "prismatic", primitive.omega, (name, lead))]


def tree_losses(robot: RobotModel, format: str, *, springs: bool = False) -> Iterator[str]:
    """Loops, laws of drives, springs, loads and initial values. `springs`: the format has them."""
    for closing in robot.closing:
        yield f"{closing.joint.subject}: the joint closes a loop, and {format} has trees only; it is left out"
        for actor in robot.model.system.actors(closing.joint.name):
            yield f"{closing.joint.subject}: what acts on it ({type(actor).__name__}) is left out with it"
    for link in robot.links:
        for drive in link.drives:
            yield f"{drive.subject}: {_DRIVES[type(drive)]}, which {format} does not have; only that it is driven"
        if not springs:
            for spring in link.springs:
                yield f"{spring.subject}: a spring of {spring.stiffness:g} N·m/rad or N/m"
    for load in robot.loads:
        yield f"{load.subject}: a load"
    if robot.moved:
        yield "the initial positions and velocities; zero is the pose of the meshes"
