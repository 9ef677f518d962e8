"""urdf: links, joints, limits and meshes of a tree, as ROS and its relatives read them.

Each link frame has its origin on the joint that carries it and the axes of the world at the pose of the
meshes, so joint values are ours. Joints with several freedoms are chains of turns and slides with links
without mass between them; a screw is a turn and a slide that mimics it.
"""

from __future__ import annotations

from kinform.behaviour.joints import KINDS
from kinform.exports.exported import Exported
from kinform.exports.model import ExportModel, Limits
from kinform.exports.names import XML
from kinform.exports.text import render
from kinform.formats.description.robot import NO_BOUND
from kinform.formats.description.writing.chains import Hinge, chain, tree_losses
from kinform.formats.description.writing.robot_model import RobotLink, RobotModel, robot_model_of
from kinform.frozen import dataclass


@dataclass(frozen=True, eq=False)
class _Joint:
    hinge: Hinge
    type: str
    limits: tuple[float, float] | None
    damping: float
    mimic: tuple[str, float] | None
    friction: float
    others: Limits


def export(model: ExportModel) -> Exported:
    """NAME.urdf and meshes/."""
    robot = robot_model_of(model, XML, KINDS)
    lost = [*model.lost, *model.stiction, *tree_losses(robot, "URDF"), *_spherical(robot)]
    taken = {link.name for link in robot.links}
    joints, remarks = [], robot.remarks
    mimics = _mimics(robot, lost)
    for link in robot.links:
        if link.link.joint is None:
            continue
        hinges = chain(robot, link, taken)
        joints += [_joint(robot, link, hinge, mimics) for hinge in hinges]
        if len(hinges) > 1:
            remarks.append(f"{link.link.joint.subject}: a chain of joints with links without mass between them")
    free = [link for link in robot.links[1:] if link.link.parent < 0]
    if any(joint.limits is not None and NO_BOUND in map(abs, joint.limits) for joint in joints):
        remarks.append(f"limits of {NO_BOUND:g} stand for ranges that are open or not known")
    bounded = [joint.others for joint in joints if joint.limits is not None or joint.others != Limits()]
    if any(None in (others.effort, others.speed) for others in bounded):
        remarks.append(f"limits of effort and velocity of {NO_BOUND:g} stand for none")
    remarks.append("URDF has no gravity; ours is " + ", ".join(f"{x:g}" for x in model.gravity) + " m/s²")
    text = render(
        __package__, "robot.urdf.j2", robot=robot, joints=joints, free=free, lost=lost, remarks=remarks,
        unlimited=NO_BOUND, between=[j.hinge.child for j in joints if j.hinge.between], materials=robot.materials,
    )  # fmt: skip
    return Exported({f"{robot.stem}.urdf": text, **robot.meshes}, tuple(lost), tuple(remarks))


def _joint(robot: RobotModel, link: RobotLink, hinge: Hinge, mimics: dict[str, tuple[str, float]]) -> _Joint:
    limits = link.range if link.single and hinge.follows is None else None
    if limits is not None:
        limits = max(limits[0], -NO_BOUND), min(limits[1], NO_BOUND)
    kind: str = hinge.type
    if kind == "revolute" and (limits is None or limits == (-NO_BOUND, NO_BOUND)):
        kind, limits = "continuous", None
    elif kind == "prismatic" and limits is None:
        limits = -NO_BOUND, NO_BOUND
    mimic = hinge.follows or mimics.get(hinge.name)
    ball = link.link.joint is not None and link.link.joint.kind.name == "spherical"
    damping = 0.0 if hinge.follows is not None or ball else link.damping(hinge.coordinate)
    friction = 0.0 if hinge.follows is not None or ball else link.friction(hinge.coordinate)
    others = link.limits if hinge.follows is None else Limits()
    return _Joint(hinge, kind, limits, damping, mimic, friction, others)


def _mimics(robot: RobotModel, lost: list[str]) -> dict[str, tuple[str, float]]:
    """By joint: the joint that it follows, and the ratio."""
    out: dict[str, tuple[str, float]] = {}
    for gear, a, b in robot.gears:
        if gear.others:
            lost.append(f"{gear.subject}: URDF lets a joint follow one other only")
            continue
        ways = [(a.subject, b.subject, gear.ratio)]
        if gear.ratio:
            ways.append((b.subject, a.subject, 1.0 / gear.ratio))
        for first, second, ratio in ways:
            name = robot.joint_names[first]
            if name not in out and robot.link_of(first) is not None:
                out[name] = (robot.joint_names[second], ratio)
                break
        else:
            lost.append(f"{gear.subject}: URDF lets a joint follow one other only, and none that closes a loop")
    return out


def _spherical(robot: RobotModel) -> list[str]:
    return [
        f"{link.link.joint.subject}: a spherical joint; it is three turns about x, y and z, whose values are not our "
        "quaternion and which lock at 90°"
        for link in robot.links
        if link.link.joint is not None and link.link.joint.kind.name == "spherical"
    ]
