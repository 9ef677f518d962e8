"""The tree with what URDF, SDF and MJCF say of links and joints alike: inertia, shapes, limits, drives."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import field

import numpy as np

from kinform.behaviour import (
    Actor,
    Damper,
    DcMotor,
    EffortDrive,
    Friction,
    Ground,
    JointComponent,
    LoadComponent,
    MotionDrive,
    RigidBody,
    Servo,
    Spring,
)
from kinform.behaviour.components import Gear
from kinform.exports.looks import Shape, shapes_of, stl
from kinform.exports.model import ExportModel, Limits
from kinform.exports.names import FILES, XML, Language, identifiers
from kinform.exports.tree import Closing, Link, Tree, coordinate_names, grow
from kinform.frozen import dataclass
from kinform.model.arrays import Array

GRAIN = 1e-9
"""kg and kg·m², of links whose mass is not known, where a format wants one: a microgram changes no motion. Chosen,
not measured."""

Driver = MotionDrive | EffortDrive | Servo | DcMotor
"""What drives a joint."""


@dataclass(frozen=True)
class Visual:
    """A mesh of a link, in the link frame."""

    name: str
    file: str
    """With ending, in the folder meshes/."""
    facets: int
    material: str
    """A name for the format, never empty."""
    rgba: tuple[float, float, float, float]


@dataclass(frozen=True, eq=False)
class RobotLink:
    """A link with all that is on it."""

    link: Link
    name: str
    offset: Array
    """(3,) m from the parent's origin to its own, in the common axes."""
    mass: float | None
    """kg; None: not known, or the ground."""
    centre: Array
    """(3,) m, centre of mass in the link frame."""
    inertia: Array
    """(3, 3) kg·m² about the centre of mass."""
    visuals: tuple[Visual, ...]
    actors: tuple[Actor, ...]
    range: tuple[float, float] | None
    """rad or m, of its joint; None: not known."""
    limits: Limits
    """Of effort and speed of its joint."""

    @property
    def single(self) -> bool:
        """Whether its joint has one freedom."""
        return self.link.joint is not None and self.link.joint.kind.rates == 1

    def damping(self, freedom: int) -> float:
        """Of all dampers on a coordinate of its joint."""
        return sum(one.damping for one in self.actors if isinstance(one, Damper) and one.freedom == freedom)

    def friction(self, freedom: int) -> float:
        """N·m or N of all friction on a coordinate of its joint that does not depend on loads."""
        return sum(
            one.effort
            for one in self.actors
            if isinstance(one, Friction) and one.freedom == freedom and one.static == 0.0
        ) + sum(motor.rotor_friction * abs(motor.gear) for motor in self._motors(freedom))

    def armature(self, freedom: int) -> float:
        """kg·m² or kg of the rotors of motors on a coordinate of its joint."""
        return sum(motor.armature for motor in self._motors(freedom))

    def _motors(self, freedom: int) -> list[DcMotor]:
        return [one for one in self.actors if isinstance(one, DcMotor) and one.freedom == freedom]

    @property
    def springs(self) -> tuple[Spring, ...]:
        """The springs on its joint."""
        return tuple(actor for actor in self.actors if isinstance(actor, Spring))

    def stiffness(self, freedom: int) -> float:
        """Of all springs on a coordinate of its joint together."""
        return sum(spring.stiffness for spring in self.springs if spring.freedom == freedom)

    def rest(self, freedom: int) -> float:
        """Value of the coordinate at which its springs balance."""
        stiffness = self.stiffness(freedom)
        turned = sum(s.stiffness * s.rest for s in self.springs if s.freedom == freedom)
        return turned / stiffness if stiffness else 0.0

    def coordinate(self, freedom: int) -> str:
        """The name of a coordinate of its joint, before it is made to fit a language."""
        assert self.link.joint is not None
        return coordinate_names(self.link.joint)[freedom]

    @property
    def drives(self) -> tuple[Driver, ...]:
        """The drives, servos and motors on its joint."""
        return tuple(actor for actor in self.actors if isinstance(actor, Driver))


@dataclass(frozen=True, eq=False)
class RobotModel:
    """Links, loops, names and files."""

    model: ExportModel
    name: str
    stem: str
    """Name of the file without ending."""
    tree: Tree
    links: tuple[RobotLink, ...]
    joint_names: dict[str, str]
    """By the joint's or motion's own name."""
    meshes: dict[str, bytes] = field(default_factory=dict)

    @property
    def closing(self) -> tuple[Closing, ...]:
        """Joints that close loops of moving bodies."""
        return tuple(closing for closing in self.tree.closing if not closing.rigid)

    @property
    def materials(self) -> dict[str, tuple[float, float, float, float]]:
        """Colour of each material that is used, by name."""
        return dict(sorted((visual.material, visual.rgba) for link in self.links for visual in link.visuals))

    @property
    def remarks(self) -> list[str]:
        """What is to be said of bodies and joints that are taken as stated, ranges that are not known, and teeth."""
        return [*self.model.taken, *self.unranged, *self.model.teeth]

    @property
    def loads(self) -> tuple[LoadComponent, ...]:
        """Forces on bodies."""
        return self.model.system.steady_loads

    @property
    def gears(self) -> tuple[tuple[Gear, JointComponent, JointComponent], ...]:
        """Couplings with the joints at a and b."""
        system = self.model.system
        return tuple((gear, system.joint_at(gear.name, "a"), system.joint_at(gear.name, "b")) for gear in system.gears)

    def link_of(self, joint: str) -> RobotLink | None:
        """The link that a joint carries; None for a joint that closes a loop."""
        return next((k for k in self.links if k.link.joint is not None and k.link.joint.subject == joint), None)

    @property
    def unranged(self) -> tuple[str, ...]:
        """A sentence about the joints whose ranges nothing says."""
        names = [
            link.link.joint.subject
            for link in self.links
            if link.link.joint is not None and link.link.joint.kind.rates == 1 and link.range is None
        ]
        return (f"no limits, because no range is known: {', '.join(sorted(names))}",) if names else ()

    @property
    def moved(self) -> bool:
        """Whether it starts elsewhere than at rest in the pose of the meshes."""
        return bool(np.any(self.model.q != self.model.mechanism.start) or np.any(self.model.v))


def robot_model_of(model: ExportModel, language: Language = XML, closable: Collection[str] = ()) -> RobotModel:
    """The tree of a model, with names for the language."""
    tree = grow(model.system, closable, model.stated)
    shapes = shapes_of(model)
    names = identifiers((link.body.subject for link in tree.links), language)
    called = {name for joint in model.system.joints for name in (joint.subject, *coordinate_names(joint))}
    joints = identifiers(called, language, suffixes=("", ".x", ".y", ".z", ".slide", " lower", " upper", " half"))
    links, meshes = [], {}
    for link in tree.links:
        parent = tree.links[link.parent].origin if link.parent >= 0 else np.zeros(3)
        looks = shapes.get(link.body.subject, ())
        for shape in looks:
            meshes[f"meshes/{shape.file}.stl"] = stl(shape.in_world - link.origin, shape.faces)
        links.append(_link(model, link, names[link.body.subject], link.origin - parent, looks))
    title = identifiers([model.name], language)[model.name]
    return RobotModel(model, title, identifiers([model.name], FILES)[model.name], tree, tuple(links), joints, meshes)


def _link(model: ExportModel, link: Link, name: str, offset: Array, shapes: tuple[Shape, ...]) -> RobotLink:
    body, mass, centre, inertia = link.body, None, np.zeros(3), np.zeros((3, 3))
    if isinstance(body, RigidBody) and body.mass is not None:
        mass, centre, inertia = body.mass, body.centre_of_mass - link.origin, body.inertia
    elif isinstance(body, Ground):
        for properties in model.masses:
            if properties.name == body.subject and properties.mass is not None:
                mass, inertia = properties.mass, properties.inertia
                centre = properties.centre_of_mass - link.origin
    visuals = tuple(
        Visual(shape.part, f"{shape.file}.stl", len(shape.faces), shape.material or "unstated", shape.rgba)
        for shape in shapes
    )
    joint = link.joint
    actors = () if joint is None else model.system.actors(joint.name)
    limits = None if joint is None else model.ranges.get(joint.subject)
    others = Limits() if joint is None else model.limits.get(joint.subject, Limits())
    return RobotLink(link, name, offset, mass, centre, inertia, visuals, actors, limits, others)
