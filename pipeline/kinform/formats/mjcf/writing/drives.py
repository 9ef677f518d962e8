"""What acts on the joints and bodies of an MJCF model: actuators, couplings, loads."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from kinform.behaviour import (
    Constant,
    DcMotor,
    EffortDrive,
    Gear,
    JointComponent,
    LoadComponent,
    MotionDrive,
    Servo,
    VoltageController,
)
from kinform.behaviour.shafts import Controller
from kinform.behaviour.signals import Signal
from kinform.exports.motors import limited, slowed
from kinform.exports.names import XML, identifiers
from kinform.formats.description.writing.robot_model import RobotLink, RobotModel
from kinform.formats.mjcf.writing.reflected import Carried, carried
from kinform.foundation.rounding import SOLVED

BANDWIDTH = 2.0 * math.pi * 10.0
"""rad/s, of the position servos that stand for prescribed motions: 10 Hz. Chosen, not measured."""


def gears(robot: RobotModel, lost: list[str]) -> list[tuple[Any, str, str]]:
    """Couplings with the names of both joints; those that MJCF cannot have are added to `lost`."""
    out = []
    for gear, a, b in robot.gears:
        if gear.others:
            continue
        if robot.link_of(a.subject) is None or robot.link_of(b.subject) is None:
            lost.append(f"{gear.subject}: one of its joints closes a loop and has no coordinate in MJCF")
            continue
        out.append((gear, robot.joint_names[a.subject], robot.joint_names[b.subject]))
    return out


def trains(robot: RobotModel, lost: list[str]) -> list[tuple[Gear, list[tuple[str, float]]]]:
    """Couplings of three joints and more, which are fixed tendons of constant length, with what multiplies the value
    of each joint; those that MJCF cannot have are added to `lost`."""
    out = []
    for gear in (gear for gear, _, _ in robot.gears if gear.others):
        ends = [(robot.model.system.joint_at(gear.name, port).subject, factor) for port, factor in gear.terms]
        if any(robot.link_of(joint) is None for joint, _ in ends):
            lost.append(f"{gear.subject}: one of its joints closes a loop and has no coordinate in MJCF")
            continue
        out.append((gear, [(robot.joint_names[joint], factor) for joint, factor in ends]))
    return out


def actuators(robot: RobotModel, links: Sequence[RobotLink], lost: list[str]) -> list[dict[str, Any]]:
    """Drives of links, halves of bodies among them, with what they hold at the start; what MuJoCo does otherwise is
    added to `lost`."""
    out: list[dict[str, Any]] = []
    names = identifiers((drive.name for link in links for drive in link.drives), XML)
    for link in links:
        joint = link.link.joint
        for drive in link.drives:
            assert joint is not None
            if joint.kind.name == "spherical":
                lost.append(f"{drive.subject}: what acts about one direction of the ball {joint.subject}")
                continue
            at = {"name": names[drive.name], "joint": robot.joint_names[link.coordinate(drive.freedom)], "bound": None}
            if isinstance(drive, MotionDrive):
                moved = carried(robot.model, joint.subject, drive.freedom) or Carried(1.0, 0.0)
                gains = {"kp": moved.inertia * BANDWIDTH**2, "kv": 2.0 * moved.inertia * BANDWIDTH}
                aside = moved.gravity / gains["kp"]
                out.append(at | gains | {"type": "position", "start": drive.signal.value(0.0) + aside})
                lost.append(
                    f"{drive.subject}: its motion follows a law; it is a position servo of {BANDWIDTH / math.tau:g} Hz "
                    f"that holds the start{_aimed(aside, joint, drive.freedom)}"
                )
            elif isinstance(drive, EffortDrive):
                out.append(at | {"type": "motor", "start": drive.signal.value(0.0)})
                if not isinstance(drive.signal, Constant):
                    lost.append(
                        f"{drive.subject}: its effort follows a law; its actuator holds the effort at the start"
                    )
            elif isinstance(drive, Servo):
                out.append(at | _servo(drive.subject, drive.target, drive.controller, 1.0, 0.0, lost))
            else:
                out.append(at | _motor(robot, drive, lost))
    return out


def _servo(
    subject: str, target: Signal, controller: Controller, ratio: float, drag: float, lost: list[str]
) -> dict[str, Any]:
    """A position servo; `ratio`: effort for a unit of the controller's output, `drag`: damping beside it."""
    lost += slowed(subject, controller)
    controller = controller.without_speed_limit
    if not isinstance(target, Constant):
        lost.append(f"{subject}: the target of its controller follows a law; it is that at the start, at rest")
    if controller.ki:
        lost.append(f"{subject}: the integral of its controller (ki = {controller.ki:g})")
    bounded = math.isfinite(controller.limit)
    if bounded and drag:
        lost.append(f"{subject}: the limit of its controller's voltage ({controller.limit:g} V)")
    return {
        "type": "position",
        "kp": ratio * controller.kp,
        "kv": ratio * controller.kd + drag,
        "start": target.value(0.0),
        "bound": controller.limit if bounded and not drag else None,
    }


def _motor(robot: RobotModel, motor: DcMotor, lost: list[str]) -> dict[str, Any]:
    """A motor whose current follows its voltage at once; controlled by that, or by its controller's target."""
    if motor.inductance:
        lost.append(f"{motor.subject}: the inductance of its motor ({motor.inductance:g} H)")
    lost += limited(motor)
    ratio = motor.constant * motor.gear / motor.resistance
    drag = ratio * motor.constant * motor.gear
    supply = robot.model.system.supply(motor.name)
    if isinstance(supply, VoltageController):
        return _servo(motor.subject, supply.target, supply.controller, ratio, drag, lost)
    if not isinstance(supply.signal, Constant):
        lost.append(f"{motor.subject}: the voltage of its motor follows a law; its actuator holds that at the start")
    return {"type": "general", "gain": ratio, "drag": drag, "start": supply.signal.value(0.0)}


def _aimed(aside: float, joint: JointComponent, freedom: int) -> str:
    """What carries gravity at the start, in words; nothing where it is rounding."""
    if abs(aside) < SOLVED:
        return ""
    turns = joint.kind.coordinates[freedom][1]
    size = f"{math.degrees(aside):.3g}°" if turns else f"{1e3 * aside:.3g} mm"
    return f", aimed {size} aside so that it carries gravity there"


def load(robot: RobotModel, given: LoadComponent) -> dict[str, Any]:
    """A load as an actuator at a site."""
    body = robot.model.system.body_at(given.name, "frame").subject
    link = next(k for k in robot.links if k.link.body.subject == body)
    return {
        "name": given.name,
        "body": link.name,
        "position": given.point - link.link.origin,
        "turning": given.turning,
        "gear": [*given.force.tolist(), *given.torque.tolist()],
    }
