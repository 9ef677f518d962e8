"""mjcf: the model as MuJoCo runs it, loops included, starting where our simulation starts.

Body frames have their origin on the joint that carries them and the axes of the world at the pose of the
meshes; joints of a body act in the order in which they are listed, from the parent. A loop closes in a
ball (`connect`), a hinge (two `connect` on its axis) or a weld; where only another kind of joint could close
it, a body is robot of two halves that are welded. Meshes are for the eye: mating surfaces always touch, so
they must not collide.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import field, replace
from typing import Any, Literal

import numpy as np

from kinform.behaviour.primitives import Ball
from kinform.exports.exported import Exported, ExportError
from kinform.exports.model import ExportModel, Limits
from kinform.exports.names import MJCF, free_name
from kinform.exports.text import render, vector
from kinform.exports.tree import Closing, Link, Motion
from kinform.formats.description.writing.robot_model import GRAIN, RobotLink, RobotModel, robot_model_of
from kinform.formats.mjcf.writing.drives import actuators, gears, load, trains
from kinform.foundation.algebra.spatial import to_matrix
from kinform.frozen import dataclass
from kinform.model.arrays import Array

LEAST_MOMENT = 1e-14
"""kg·m², ten times the moment of inertia below which MuJoCo refuses a body (mjMINVAL, 1e-15)."""
MOST_FACETS = 200_000
"""More facets MuJoCo does not read from one STL file: a check in its reader."""
MOST_NESTED = 495
"""Bodies in a row, each in the one before, that MuJoCo 4.0 reads: its XML reader takes 499 elements in each other."""
STEP = 0.001
"""s, of RK4 without loops. Chosen, not measured."""
STEP_OF_LOOPS = 0.0002
"""s, of RK4: loops are stiff springs to MuJoCo and need the shorter step (within 1e-5 of rigid ones in the tests)."""


CLOSABLE = ("spherical", "revolute", "fixed")


@dataclass(frozen=True, eq=False)
class _Joint:
    name: str
    type: Literal["hinge", "slide", "ball"]
    position: Array
    axis: Array
    range: tuple[float, float] | None = None
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    friction: float = 0.0
    armature: float = 0.0
    effort: float | None = None
    """N·m or N, the most that actuators give; None: without limit."""


@dataclass(eq=False)
class _Body:
    link: RobotLink
    joints: list[_Joint]
    share: float = 1.0
    """Of the mass: halves of a body that was cut."""
    twin: bool = False
    children: list[_Body] = field(default_factory=list)
    qpos: list[float] = field(default_factory=list)
    qvel: list[float] = field(default_factory=list)

    @property
    def full_inertia(self) -> str:
        """ixx iyy izz ixy ixz iyz."""
        i = self.share * self.link.inertia
        return vector((i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]))

    @property
    def mass(self) -> float | None:
        """Its share."""
        return None if self.link.mass is None else self.share * self.link.mass


@dataclass(frozen=True)
class _Equality:
    kind: Literal["connect", "weld"]
    name: str
    first: str
    second: str
    anchor: str


def export(model: ExportModel) -> Exported:
    """NAME.xml and meshes/."""
    robot = robot_model_of(model, MJCF, CLOSABLE)
    lost = [*model.lost, *model.stiction, *_losses(robot)]
    robot = _with_moments(robot, lost)
    root, twins = _bodies(robot)
    equalities = [row for closing in robot.closing for row in _closure(robot, closing, twins)]
    nested = list(_nested(root))
    ordered = [body for body, _, ends in nested if not ends]
    rows = actuators(robot, [body.link for body in ordered], lost)
    remarks = ["meshes do not collide, because mating surfaces always touch", *robot.remarks]
    if equalities:
        remarks.append("loops are stiff springs to MuJoCo: the shorter the step, the closer to rigid")
    text = render(
        __package__, "model.mjcf.j2", robot=robot, nested=nested, equalities=equalities, actuators=rows, lost=lost,
        remarks=remarks, materials=robot.materials, step=STEP_OF_LOOPS if equalities else STEP,
        qpos=[x for body in ordered for x in body.qpos], qvel=[x for body in ordered for x in body.qvel],
        loads=[load(robot, one) for one in robot.loads], most=MOST_FACETS, inf=np.inf,
        screws=[screw for body in ordered for screw in _screws(body)], gears=gears(robot, lost),
        trains=trains(robot, lost),
        ctrl=[*(row["start"] for row in rows), *(1.0 for _ in robot.loads)],
    )  # fmt: skip
    return Exported({f"{robot.stem}.xml": text, **robot.meshes}, tuple(lost), tuple(remarks))


def _losses(robot: RobotModel) -> list[str]:
    out = []
    for link in robot.links:
        for visual in link.visuals:
            if visual.facets > MOST_FACETS:
                out.append(f"{visual.name}: its mesh; MuJoCo reads up to {MOST_FACETS} facets")
    for closing in robot.closing:
        if closing.joint.kind.name in CLOSABLE and robot.model.system.actors(closing.joint.name):
            out.append(f"{closing.joint.subject}: what acts on it; it closes a loop and has no coordinate in MJCF")
        if closing.joint.kind.name in CLOSABLE and closing.joint.subject in robot.model.limits:
            out.append(f"{closing.joint.subject}: its limits; it closes a loop and has no coordinate in MJCF")
    for link in robot.links:
        if link.link.joint is not None and link.limits.speed is not None:
            unit = "rad/s" if link.link.joint.kind.coordinates[0][1] else "m/s"
            out.append(f"{link.link.joint.subject}: the limit of its speed ({link.limits.speed:g} {unit})")
    return out


def _with_moments(robot: RobotModel, lost: list[str]) -> RobotModel:
    """Moments of inertia that are zero, and masses that are not known, raised to what MuJoCo accepts."""
    links = []
    for k, link in enumerate(robot.links):
        if k and link.mass is None:
            link = replace(link, mass=GRAIN, inertia=GRAIN * np.eye(3))
            told, more = f"{link.name}: its mass is not known", f"which MuJoCo refuses; it has {GRAIN:g} kg"
            if told in lost:
                lost[lost.index(told)] = f"{told}, {more}"
            else:
                lost.append(f"{link.name}: a body without mass, {more}")
        elif k:
            least = float(np.linalg.eigvalsh(link.inertia)[0])
            if least < LEAST_MOMENT:
                link = replace(link, inertia=link.inertia + (LEAST_MOMENT - min(least, 0.0)) * np.eye(3))
                lost.append(f"{link.name}: a moment of inertia of zero; it is {LEAST_MOMENT:g} kg·m²")
        links.append(link)
    return replace(robot, links=tuple(links))


def _bodies(robot: RobotModel) -> tuple[_Body, dict[str, str]]:
    """The nested bodies, and for joints that cut a body the name of its second half."""
    bodies = [_Body(link, _joints(robot, link)) for link in robot.links]
    for k, link in enumerate(robot.links):
        if k:
            bodies[max(link.link.parent, 0)].children.append(bodies[k])
        _state(robot, bodies[k])
    twins: dict[str, str] = {}
    names = {link.name for link in robot.links}
    for closing in robot.closing:
        if closing.joint.kind.name not in CLOSABLE:
            twins[closing.joint.subject] = _cut(robot, closing, bodies, names)
    return bodies[0], twins


def _cut(robot: RobotModel, closing: Closing, bodies: list[_Body], names: set[str]) -> str:
    """Half of the second body (the first where that is the ground), carried by the closing joint."""
    forward = closing.b != 0
    parent, cut = (closing.a, closing.b) if forward else (closing.b, closing.a)
    whole = bodies[cut]
    name = free_name(f"{whole.link.name} half", names)
    names.add(name)
    point = closing.joint.geometry.point
    origin = whole.link.link.origin if point is None else point
    link = Link(whole.link.link.body, parent, closing.joint, forward, origin)
    shift = whole.link.link.origin - origin
    half = replace(
        whole.link, link=link, name=name, offset=origin - robot.tree.links[parent].origin,
        centre=whole.link.centre + shift, visuals=(), actors=robot.model.system.actors(closing.joint.name),
        range=robot.model.ranges.get(closing.joint.subject),
        limits=robot.model.limits.get(closing.joint.subject, Limits()),
    )  # fmt: skip
    # Every cut halves what is left, so that the whole body keeps its mass.
    whole.share *= 0.5
    body = _Body(half, _joints(robot, half), whole.share, True)
    _state(robot, body)
    bodies[parent].children.append(body)
    return name


def _joints(robot: RobotModel, link: RobotLink) -> list[_Joint]:
    if link.link.joint is None:
        return []
    point = link.link.joint.geometry.point
    position = np.zeros(3) if point is None else point - link.link.origin
    return [row for motion in link.link.motions for row in _joint(robot, link, motion, position)]


def _joint(robot: RobotModel, link: RobotLink, motion: Motion, position: Array) -> list[_Joint]:
    name, primitive = robot.joint_names[motion.name], motion.primitive
    if isinstance(primitive, Ball):
        return [_Joint(name, "ball", position, np.zeros(3))]
    k = motion.coordinate
    limits = link.range if link.single else None
    on_it = (
        *(limits, link.damping(k), link.stiffness(k), link.rest(k)),
        *(link.friction(k), link.armature(k), link.limits.effort),
    )
    if not primitive.omega.any():
        return [_Joint(name, "slide", position, primitive.slide, *on_it)]
    turn = _Joint(name, "hinge", position, primitive.omega, *on_it)
    if not primitive.slide.any():
        return [turn]
    return [turn, _Joint(f"{name}.slide", "slide", position, primitive.omega)]


def _state(robot: RobotModel, body: _Body) -> None:
    """Coordinates and rates of the body's joints at the start."""
    joint = body.link.link.joint
    if joint is None:
        if body.link.link.parent < 0 and body.link.link.body is not robot.tree.links[0].body:
            body.qpos, body.qvel = [*body.link.link.origin.tolist(), 1.0, 0.0, 0.0, 0.0], [0.0] * 6
        return
    q, v = robot.model.coordinates(joint.subject)
    if joint.kind.name == "spherical":
        sign = 1.0 if body.link.link.forward else -1.0
        body.qpos = [float(q[0]), *(sign * q[1:]).tolist()]
        body.qvel = (to_matrix(q).T @ v if body.link.link.forward else -v).tolist()
        return
    for motion in body.link.link.motions:
        body.qpos.append(float(q[motion.coordinate]))
        body.qvel.append(float(v[motion.coordinate]))
        primitive = motion.primitive
        if not isinstance(primitive, Ball) and primitive.omega.any() and primitive.slide.any():
            lead = float(primitive.slide @ primitive.omega)
            body.qpos.append(lead * body.qpos[-1])
            body.qvel.append(lead * body.qvel[-1])


def _nested(root: _Body) -> Iterator[tuple[_Body, int, bool]]:
    """Each body with its depth, the world's being 1, where it begins, and where it ends, but for the world, after all
    that are in it."""
    left = [(root, 1, False)]
    while left:
        body, depth, ends = left.pop()
        yield body, depth, ends
        if ends:
            continue
        if depth > MOST_NESTED + 1:
            raise ExportError(
                f"more than {MOST_NESTED} bodies hang on each other in a row, and MuJoCo reads no more: choose a "
                "`ground` in their middle, or export urdf or sdf"
            )
        if depth > 1:
            left.append((body, depth, True))
        left += [(child, depth + 1, False) for child in reversed(body.children)]


def _closure(robot: RobotModel, closing: Closing, twins: dict[str, str]) -> list[_Equality]:
    joint = closing.joint
    a = robot.links[closing.a]
    first, second = ("world" if k == 0 else robot.links[k].name for k in (closing.a, closing.b))
    if joint.subject in twins:
        whole = second if closing.b != 0 else first
        return [_Equality("weld", f"{joint.subject} half", whole, twins[joint.subject], "")]
    if joint.kind.rates == 0:
        return [_Equality("weld", joint.subject, first, second, "")]
    point = np.asarray(joint.geometry.point) - a.link.origin
    if joint.kind.name == "spherical":
        return [_Equality("connect", joint.subject, first, second, vector(point))]
    reach = 0.5 * robot.model.mechanism.length * np.asarray(joint.geometry.axis)
    return [
        _Equality("connect", f"{joint.subject} {side}", first, second, vector(point + sign * reach))
        for side, sign in (("lower", -1.0), ("upper", 1.0))
    ]


def _screws(body: _Body) -> list[dict[str, Any]]:
    """Turns and the slides that follow them, with metres a radian."""
    out = []
    for motion, joint in zip(body.link.link.motions, body.joints, strict=False):
        primitive = motion.primitive
        if not isinstance(primitive, Ball) and primitive.omega.any() and primitive.slide.any():
            out.append({"joint": joint.name, "lead": float(primitive.slide @ primitive.omega)})
    return out
