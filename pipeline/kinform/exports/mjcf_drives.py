"""What acts on the joints and bodies of an MJCF model: actuators, couplings, loads."""

from __future__ import annotations

from typing import Any

import numpy as np

from kinform.behaviour import LoadComponent, MotionDrive
from kinform.behaviour.primitives import Ball
from kinform.exports.names import XML, identifiers
from kinform.exports.robot import Robot, RobotLink

__all__ = ["actuators", "gears", "load"]

BANDWIDTH = 2.0 * np.pi * 10.0
"""rad/s, of the position servos that stand for prescribed motions."""


def gears(made: Robot, lost: list[str]) -> list[tuple[Any, str, str]]:
    """Couplings with the names of both joints; those that MJCF cannot have are added to `lost`."""
    out = []
    for gear, a, b in made.gears:
        if made.link_of(a.subject) is None or made.link_of(b.subject) is None:
            lost.append(f"{gear.subject}: one of its joints closes a loop and has no coordinate in MJCF")
            continue
        out.append((gear, made.joint_names[a.subject], made.joint_names[b.subject]))
    return out


def actuators(made: Robot) -> list[dict[str, Any]]:
    """Drives, with what they hold at the start."""
    out: list[dict[str, Any]] = []
    links = list(made.links)
    names = identifiers((drive.name for link in links for drive in link.drives), XML)
    for link in links:
        joint = link.link.joint
        for drive in link.drives:
            assert joint is not None
            moving = isinstance(drive, MotionDrive)
            inertia = _inertia_on(made, link) if moving else 0.0
            out.append(
                {
                    "name": names[drive.name],
                    "joint": made.joint_names[joint.subject],
                    "moving": moving,
                    "kp": inertia * BANDWIDTH**2,
                    "kv": 2.0 * inertia * BANDWIDTH,
                    "start": drive.signal.value(0.0),
                }
            )
    return out


def _inertia_on(made: Robot, link: RobotLink) -> float:
    """What a joint with one freedom moves if all others hold still (kg·m² or kg), at the pose of the meshes."""
    (motion,) = link.link.motions
    primitive = motion.primitive
    assert not isinstance(primitive, Ball)
    total, queue = 0.0, [next(k for k, other in enumerate(made.links) if other is link)]
    while queue:
        k = queue.pop()
        queue += made.tree.children(k)
        other = made.links[k]
        if other.mass is None:
            continue
        if not primitive.omega.any():
            total += other.mass
            continue
        arm = np.cross(primitive.omega, other.centre + other.link.origin - primitive.point)
        total += float(other.mass * arm @ arm + primitive.omega @ other.inertia @ primitive.omega)
    return total if total > 0.0 else 1.0


def load(made: Robot, given: LoadComponent) -> dict[str, Any]:
    """A load as an actuator at a site."""
    body = made.model.system.body_at(given.name, "frame").subject
    link = next(k for k in made.links if k.link.body.subject == body)
    return {
        "name": given.name,
        "body": link.name,
        "position": given.point - link.link.origin,
        "turning": given.turning,
        "gear": [*given.force.tolist(), *given.torque.tolist()],
    }
