"""sdf: links, joints, limits, springs and meshes, as Gazebo and Drake read them.

Link frames are those of `tree`. Cylindrical and planar joints, and universal ones whose axes are askew,
are chains of joints with links of almost no mass between them, because a link without mass counts as
1 kg in SDF. That a joint of a design that states its drives is not driven is said by an effort of 0: nothing may act on
it. What a robot description states is a limit, and without one there is none.
"""

from __future__ import annotations

import math
from dataclasses import replace

from kinform.behaviour.joints import KINDS
from kinform.behaviour.primitives import OneFreedom
from kinform.exports.exported import Exported
from kinform.exports.model import ExportModel
from kinform.exports.names import SDF, free_name
from kinform.exports.text import render
from kinform.formats.description.writing.chains import Hinge, chain, tree_losses
from kinform.formats.description.writing.robot_model import GRAIN, RobotLink, RobotModel, robot_model_of
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array


@dataclass(frozen=True, eq=False)
class _Axis:
    direction: Array
    limits: tuple[float, float] | None = None
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    mimic: tuple[str, float] | None = None
    friction: float = 0.0
    effort: float | None = None
    """N·m or N; None: without limit."""
    speed: float | None = None


@dataclass(frozen=True, eq=False)
class _Joint:
    name: str
    type: str
    parent: str
    child: str
    axes: tuple[_Axis, ...] = ()
    pitch: float | None = None
    """Metres a turn."""


@dataclass(frozen=True, eq=False)
class _Grain:
    name: str
    origin: Array


def export(model: ExportModel) -> Exported:
    """NAME.sdf and meshes/."""
    robot = robot_model_of(model, SDF, KINDS)
    lost = [*model.lost, *model.stiction, *tree_losses(robot, "SDF", springs=True)]
    taken = {link.name for link in robot.links} | {"world"}
    joints, grains = [], []
    for link in robot.links:
        if link.link.joint is None:
            continue
        direct = _direct(robot, link)
        if direct is not None:
            joints.append(direct)
            continue
        hinges = chain(robot, link, taken)
        joints += [_of_hinge(robot, link, hinge) for hinge in hinges]
        grains += [_Grain(hinge.child, link.link.origin) for hinge in hinges if hinge.between]
    for gear, a, b in robot.gears:
        if gear.others:
            lost.append(f"{gear.subject}: SDF lets a joint follow one other only")
            continue
        joints = _mimicking(robot, joints, gear.subject, a.subject, b.subject, gear.ratio, lost)
    weightless = [link.name for link in robot.links[1:] if link.mass is None]
    if grains or weightless:
        grain = f"links without mass have {GRAIN:g} kg, because SDF takes 1 kg where nothing is stated"
        lost.append(f"mass of {', '.join([g.name for g in grains] + weightless)}: {grain}")
    remarks = ["meshes do not collide, because mating surfaces always touch", *robot.remarks]
    text = render(
        __package__, "model.sdf.j2", robot=robot, joints=joints, grains=grains, lost=lost, remarks=remarks, grain=GRAIN,
        ground=free_name("world_fixed", robot.joint_names.values()),
    )  # fmt: skip
    return Exported({f"{robot.stem}.sdf": text, **robot.meshes}, tuple(lost), tuple(remarks))


def _direct(robot: RobotModel, link: RobotLink) -> _Joint | None:
    """The joint, where SDF has its kind."""
    joint = link.link.joint
    assert joint is not None
    parent, name = robot.links[link.link.parent].name, robot.joint_names[joint.subject]
    kind = joint.kind.name
    if kind == "fixed":
        return _Joint(name, "fixed", parent, link.name)
    if kind == "spherical":
        return _Joint(name, "ball", parent, link.name)
    screws = [m.primitive for m in link.link.motions if isinstance(m.primitive, OneFreedom)]
    if kind == "universal":
        if abs(float(screws[0].omega @ screws[1].omega)) > SOLVED:
            return None
        axes = zip(link.link.motions, screws, strict=True)
        return _Joint(
            name,
            "universal",
            parent,
            link.name,
            tuple(_axis(robot, link, m.coordinate, screw.omega) for m, screw in axes),
        )
    if len(screws) != 1:
        return None
    turning = bool(screws[0].omega.any())
    limits = link.range if link.range is not None and any(map(math.isfinite, link.range)) else None
    direction = screws[0].omega if turning else screws[0].slide
    axis = replace(_axis(robot, link, 0, direction), limits=limits)
    if kind == "screw":
        return _Joint(name, "screw", parent, link.name, (axis,), joint.geometry.pitch)
    return _Joint(name, kind, parent, link.name, (axis,))


def _axis(robot: RobotModel, link: RobotLink, k: int, direction: Array) -> _Axis:
    """A coordinate of the link's joint, and what acts on it."""
    free = bool(robot.model.assembly.descriptions) or any(drive.freedom == k for drive in link.drives)
    effort = 0.0 if link.limits.effort is None and not free else link.limits.effort
    return _Axis(
        direction, None, link.damping(k), link.stiffness(k), link.rest(k),
        friction=link.friction(k), effort=effort, speed=link.limits.speed,
    )  # fmt: skip


def _of_hinge(robot: RobotModel, link: RobotLink, hinge: Hinge) -> _Joint:
    follows = hinge.follows is not None
    axis = _Axis(hinge.axis, effort=0.0) if follows else _axis(robot, link, hinge.coordinate, hinge.axis)
    return _Joint(hinge.name, hinge.type, hinge.parent, hinge.child, (axis,))


def _mimicking(
    robot: RobotModel, joints: list[_Joint], gear: str, a: str, b: str, ratio: float, lost: list[str]
) -> list[_Joint]:
    """The joints, with a following b."""
    first, second = robot.joint_names[a], robot.joint_names[b]
    out, done = [], False
    for joint in joints:
        if joint.name == first and len(joint.axes) == 1 and joint.axes[0].mimic is None:
            joint, done = replace(joint, axes=(replace(joint.axes[0], mimic=(second, ratio)),)), True
        out.append(joint)
    if not done:
        lost.append(f"{gear}: SDF lets a joint follow one other only, and none that closes a loop")
    return out
