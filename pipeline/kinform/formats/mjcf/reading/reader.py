"""MJCF: bodies in bodies, as MuJoCo reads them. Bodies are links; a body without joint is fixed to the one around it.

The frame F is the world's. The drawn pose is that of the file, where joints have their `ref`; several joints of a body
go through stick bodies. Pairs of `<connect>` make a hinge. Models that are attached are read by their own files
(`mjcf_attach`). What is not carried is listed by name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from lxml import etree

from kinform.form.problems import Problems
from kinform.formats.description.elements import FILE, Element, Xml, parse_xml, tag_of, xml_text
from kinform.formats.description.mesh_files import MeshFiles
from kinform.formats.description.poses import place
from kinform.formats.description.robot import Limits, Link, Ratio, Robot, RobotJoint, Shape, bounded
from kinform.formats.description.tree import Count, distinct
from kinform.formats.mjcf.reading.actuators import efforts
from kinform.formats.mjcf.reading.attach import Budget, Content, Models, attached
from kinform.formats.mjcf.reading.closures import closures, ratios
from kinform.formats.mjcf.reading.defaults import Compiler, Defaults, Includes
from kinform.formats.mjcf.reading.replicas import Replicas
from kinform.formats.mjcf.reading.shapes import Shapes
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array

WORLD = "world"
TYPES = {"hinge": "revolute", "slide": "prismatic", "ball": "spherical", "free": ""}
_QUIET = ("compiler", "default", "asset", "option", "size", "visual", "statistic", "worldbody", "equality", "custom",
          "keyframe", "sensor", "actuator", "extension")  # fmt: skip
_BODY = ("body", "joint", "freejoint", "geom", "inertial", "site", "camera", "light", "frame")


def read(path: Path, data: bytes, file: str, problems: Problems, meshes: MeshFiles) -> Robot | None:
    """The robot of an MJCF text; None where nothing can be made of it, after noting why."""
    budget = Budget((path.resolve(),))
    reader, root, changed = _opened(path, data, Xml(file, problems), meshes, budget)
    robot = None if reader is None else reader.robot(root, path.stem)
    if robot is None:
        return None
    # what attached models say is in no text that could be written back
    text = "" if budget.known else _whole(root, data, changed)
    return replace(robot, format="mjcf", text=text, files=(*budget.files, *robot.files))


def _opened(
    path: Path, data: bytes, xml: Xml, meshes: MeshFiles, budget: Budget
) -> tuple[_Reader | None, Element, bool]:
    """The reader of a text, its root, and whether includes or replicas were put in; no reader after noting why."""
    root = parse_xml(data, xml.file, xml.problems)
    if root is None:
        return None, None, False
    if tag_of(root) != "mujoco":
        xml.complain(root, f"the root is <{tag_of(root)}>, and an MJCF has <mujoco>", "name an MJCF")
        return None, root, False
    includes = Includes(path, xml, meshes)
    includes.expand(root)
    compiler = Compiler.of(xml, root)
    includes.find_meshes(root, compiler.folder)
    budget.files += includes.files
    changed = Replicas(xml, compiler).expand(root) or bool(includes.files)
    return _Reader(xml, meshes, root, path, budget), root, changed


def _model(path: Path, data: bytes, xml: Xml, meshes: MeshFiles, budget: Budget) -> tuple[str, Content] | None:
    """The name that a model gives itself, and what it holds."""
    budget.files.append(path)
    reader, root, _ = _opened(path, data, xml, meshes, budget)
    content = None if reader is None else reader.content(root)
    if reader is None or content is None:
        return None
    budget.notes += reader.left.sentences(xml.file)
    budget.files += sorted(reader.shapes.files)
    return root.get("model") or path.stem, content


def _whole(root: Element, data: bytes, changed: bool) -> str:
    """The text, with everything that it includes and replicates."""
    if not changed:
        return xml_text(data)
    for element in root.iter():
        element.attrib.pop(FILE, None)
    etree.cleanup_namespaces(root)  # MuJoCo refuses what declares one
    return str(etree.tostring(root, encoding="unicode"))


def _seen(link: Link) -> tuple[Shape, ...]:
    """The shapes that are seen only: where there are none, those that collide are seen."""
    return () if link.visual is link.collision else link.visual


class _Reader:
    def __init__(self, xml: Xml, meshes: MeshFiles, root: Element, path: Path, budget: Budget):
        self.xml, self.left, self.budget = xml, Count(), budget
        self.compiler = Compiler.of(xml, root)
        self.defaults = Defaults(xml, root)
        self.shapes = Shapes(xml, root, meshes, self.compiler, self.defaults, self.left)
        self.models = Models(xml, root, path, meshes, budget, _model)
        self.links: dict[str, Link] = {}
        self.above: dict[str, str] = {}
        self.own: dict[str, Array] = {}
        self.joints: dict[str, RobotJoint] = {}
        self.loops: list[RobotJoint] = []
        self.ratios: list[Ratio] = []
        self.sites: dict[str, tuple[str, Array]] = {}
        self.free_link, self.free_joint = distinct({WORLD}), distinct(set())
        self.efforts = efforts(xml, root, self.defaults, self.compiler)

    def robot(self, root: Element, name: str) -> Robot | None:
        """All of the description; None after noting why there is none."""
        if self.content(root) is None:
            return None
        self._leave_out_world(self.loops)
        return Robot(
            name=(root.get("model") or name).replace("/", "_") or name,
            at=self.xml.at(root),
            links=tuple(self.links.values()),
            joints=(*self.joints.values(), *self.loops),
            ratios=tuple(self.ratios),
            root=WORLD if WORLD in self.links else next(iter(self.links), None),
            notes=(*self.left.sentences(self.xml.file), *dict.fromkeys(self.budget.notes)),
            files=tuple(sorted(self.shapes.files)),
        )

    def content(self, root: Element) -> Content | None:
        """All that is in the world; None after noting that there is none."""
        xml = self.xml
        for child in xml.children(root):
            if tag_of(child) not in _QUIET:
                self.left.add(f"<{tag_of(child)}>")
        for compiler in xml.children(root, "compiler"):
            for key in ("settotalmass", "boundmass", "boundinertia"):
                if (xml.number(compiler, key, 0.0) or 0.0) > 0.0:
                    self.left.add(f"{key} of <compiler>")
            if compiler.get("balanceinertia", "false") == "true":
                self.left.add("balanceinertia of <compiler>")
        worlds = list(xml.children(root, "worldbody"))
        if not worlds:
            xml.complain(root, "has no <worldbody>", "name an MJCF with bodies")
            return None
        self.links[WORLD] = Link(WORLD, np.eye(4), xml.at(worlds[0]))
        for world in worlds:
            self._inside(world, WORLD, np.eye(4), world.get("childclass"))
        self.loops += closures(xml, root, self.links, self.sites, self.defaults, self.left)
        self.ratios += ratios(xml, root, self.joints, self.defaults, self.left)
        loops, coupled = tuple(self.loops), tuple(self.ratios)
        return Content(self.links, self.joints, loops, coupled, self.sites, self.above, self.own)

    def _leave_out_world(self, loops: list[RobotJoint]) -> None:
        """The world is no link where it has no geometry, and at most one body is fixed to it."""
        there = [j for j in (*self.joints.values(), *loops) if WORLD in j.between]
        world = self.links[WORLD]
        if world.visual or world.collision or len(there) > 1 or any(j.type != "fixed" for j in there):
            return
        del self.links[WORLD]
        self.joints = {name: joint for name, joint in self.joints.items() if WORLD not in joint.between}

    def _inside(self, element: Element, link: str, X: Array, named: str | None) -> None:
        """Everything in a body, or in a frame of it, whose pose in F is X."""
        visual: list[Shape] = []
        collision: list[Shape] = []
        for child in self.xml.children(element):
            tag = tag_of(child)
            if tag == "body":
                self._body(child, link, X, child.get("childclass") or named)
            elif tag == "frame":
                inner = X @ self.compiler.pose(self.xml, child, child.attrib)
                self._inside(child, link, inner, child.get("childclass") or named)
            elif tag == "attach":
                self._attach(child, link, X)
            elif tag == "geom":
                shape, only_seen = self.shapes.geom(child, link, X, named)
                if shape is not None:
                    (visual if only_seen else collision).append(shape)
            elif tag == "site":
                said = self.defaults.said(child, named)
                if "name" in said:
                    self.sites[said["name"]] = link, X @ self.compiler.pose(self.xml, child, said)
            elif tag not in _BODY:
                self.left.add(f"<{tag}> in bodies")
        old = self.links[link]
        seen = (*_seen(old), *visual)
        both = (*old.collision, *collision)
        self.links[link] = Link(link, old.X_FL, old.at, seen, both, old.inertial, old.stated)
        if tag_of(element) != "frame" and not seen:
            self.links[link] = Link(link, old.X_FL, old.at, both, both, old.inertial, old.stated)

    def _body(self, element: Element, above: str, X: Array, named: str | None) -> None:
        own = self.compiler.pose(self.xml, element, element.attrib)
        X = X @ own
        stated = (element.get("name") or "").replace("/", "_")
        if stated in self.links:
            first = self.links[stated].at.line
            message = f"two bodies are named {in_quotes(stated)}: the first is at line {first}"
            self.xml.complain(element, message, "rename one of them")
        name = self.free_link(stated or f"body {len(self.links)}")
        at = self.xml.at(element)
        if element.get("mocap", "false") == "true":
            self.left.add("mocap of bodies, which are taken as fixed")
        inertial = self.xml.child(element, "inertial")
        if self.compiler.from_geometry:
            inertial = None
        stated_mass = None if inertial is None else self.shapes.inertial(inertial, name, X)
        joints = [j for j in self._joints(element, X, named) if self._type(j[0], j[2]) is not None]
        free = self.xml.child(element, "freejoint") is not None or any(self._type(j, c) == "" for j, _, c in joints)
        written = None if inertial is None else self.shapes.stated(inertial)
        self.links[name] = Link(name, X, at, inertial=stated_mass, stated=written)
        self.above[name], self.own[name] = above, own
        if not free:
            between = above
            for k, (joint, X_FJ, of_class) in enumerate(joints):
                below = name if k == len(joints) - 1 else self.free_link(f"{name} {k + 1}")
                if below != name:
                    self.links[below] = Link(below, X, self.xml.at(joint))
                    self.above[below] = name
                self._joint(joint, between, below, X_FJ, of_class)
                between = below
            if not joints:
                label = self.free_joint(f"{name} fixed")
                self.joints[label] = RobotJoint(label, "fixed", (above, name), at)
        self._inside(element, name, X, named)

    def _attach(self, element: Element, link: str, X: Array) -> None:
        """Put what a model holds into a body."""
        content = self.models.content(element)
        new = None if content is None else attached(self.xml, element, content, link, X)
        if new is None:
            return
        twice = [name for name in new.links if name in self.links and name != link]
        twice += [name for name in new.joints if name in self.joints]
        if twice:
            wrong = f"<attach>: there is a {in_quotes(twice[0])} already"
            self.xml.complain(element, wrong, "give another prefix")
            return
        for name, other in new.links.items():
            old = self.links.get(name)
            if old is None:
                self.links[self.free_link(name)] = other
            else:  # geometry of the model's world
                visual, collision = (*_seen(old), *_seen(other)), (*old.collision, *other.collision)
                self.links[name] = replace(old, visual=visual, collision=collision)
        for name, joint in new.joints.items():
            limits = [v for v in (joint.effort, self.efforts.get(name)) if v is not None]
            self.joints[self.free_joint(name)] = replace(joint, effort=min(limits) if limits else None)
        self.above |= {name: around for name, around in new.above.items() if name not in self.above and name != link}
        self.own |= {name: own for name, own in new.own.items() if name not in self.own}
        self.loops += new.loops
        self.ratios += new.ratios
        self.sites |= new.sites

    def _joints(self, element: Element, X: Array, named: str | None) -> Iterator[tuple[Element, Array, str | None]]:
        """The joints of a body, and in its frames: each with the pose in F of what it is in, and the class there."""
        for child in self.xml.children(element, "joint", "frame"):
            if tag_of(child) == "joint":
                yield child, X, named
            else:
                inner = X @ self.compiler.pose(self.xml, child, child.attrib)
                yield from self._joints(child, inner, child.get("childclass") or named)

    def _type(self, element: Element, named: str | None) -> str | None:
        """kinform's type of a joint, "" of a free one; None after noting that it is not known."""
        kind = self.defaults.said(element, named).get("type", "hinge")
        if kind not in TYPES:
            wrong = f"joint type {in_quotes(kind)} is not known"
            self.xml.complain(element, wrong, did_you_mean(kind, TYPES, "the types"))
        return TYPES.get(kind)

    def _joint(self, element: Element, above: str, below: str, X: Array, named: str | None) -> None:
        xml, said = self.xml, self.defaults.said(element, named)
        stated = (said.get("name") or f"{below} joint").replace("/", "_")
        if stated in self.joints:
            message = f"two joints are named {in_quotes(stated)}: the first is at line {self.joints[stated].at.line}"
            xml.complain(element, message, "rename one of them")
        name, kind = self.free_joint(stated), self._type(element, named) or ""
        axis = np.array(xml.numbers(element, said.get("axis", "0 0 1"), "axis", 3) or (0.0, 0.0, 1.0))
        if float(np.linalg.norm(axis)) < SOLVED:
            xml.complain(element, f"joint {in_quotes(name)}: its axis is zero", 'give an axis such as "0 0 1"')
            axis = np.array([0.0, 0.0, 1.0])
        point = xml.numbers(element, said.get("pos", "0 0 0"), "pos", 3) or (0.0, 0.0, 0.0)
        for key in ("frictionloss", "armature", "springdamper"):
            if any(xml.numbers(element, said.get(key, ""), key, None) or ()):
                self.left.add(f"{key} of joints")
        moves_one = kind in ("revolute", "prismatic")
        for key in () if moves_one else ("range", "damping", "stiffness"):
            if any(self.xml.numbers(element, said.get(key, ""), key, None) or ()):
                self.left.add(f"{key} of ball joints")
        self.joints[name] = RobotJoint(
            name=name, type=kind, between=(above, below), at=xml.at(element),
            axis=X[:3, :3] @ (axis / np.linalg.norm(axis)) if kind != "spherical" else None,
            point=place(X, point) if kind != "prismatic" else None,
            range=self._range(element, said, kind, name) if moves_one else None,
            effort=self._effort(element, said, name) if moves_one else None,
            damping=self._first(element, said, "damping") if moves_one else None,
            stiffness=self._first(element, said, "stiffness") if moves_one else None,
            rest=self._angle(element, said, "springref", kind) - self._angle(element, said, "ref", kind),
            limits=self._limits(element, said, kind) if moves_one else None,
        )  # fmt: skip

    def _limits(self, element: Element, said: Mapping[str, str], kind: str) -> Limits:
        """The limits of a joint, word for word; MJCF needs none."""
        values = self.xml.numbers(element, said["range"], "range", 2) if "range" in said else None
        turn = self.compiler.radians if kind == "revolute" else float
        limited = said.get("limited", "auto")
        off = values is None or limited == "false" or (limited == "auto" and not self.compiler.autolimits)
        bounds = None if off or values is None else (turn(values[0]), turn(values[1]))
        return Limits(
            said.get("type", "hinge"), limited == "true", bounds, degrees=kind == "revolute" and self.compiler.degrees
        )

    def _first(self, element: Element, said: Mapping[str, str], key: str) -> float | None:
        """The first number of an attribute, where it is positive: later ones are of a polynomial."""
        values = self.xml.numbers(element, said.get(key, ""), key, None) or ()
        if len(values) > 1 and any(values[1:]):
            self.left.add(f"nonlinear {key} of joints")
        return values[0] if values and values[0] > 0.0 else None

    def _angle(self, element: Element, said: Mapping[str, str], key: str, kind: str) -> float:
        value = (self.xml.numbers(element, said.get(key, "0"), key, 1) or (0.0,))[0]
        return self.compiler.radians(value) if kind == "revolute" else value

    def _range(self, element: Element, said: Mapping[str, str], kind: str, name: str) -> tuple[float, float] | None:
        limited = said.get("limited", "auto")
        if "range" not in said or limited == "false" or (limited == "auto" and not self.compiler.autolimits):
            if limited == "true":
                self.left.notes.append(f"joint {in_quotes(name)} is limited, and states no range")
            return None
        values = self.xml.numbers(element, said["range"], "range", 2)
        if values is None:
            return None
        lower, upper = (self.compiler.radians(v) if kind == "revolute" else v for v in values)
        ref = self._angle(element, said, "ref", kind)
        if lower < upper:
            return bounded(lower - ref, upper - ref)
        self.left.notes.append(f"joint {in_quotes(name)}: its range {said['range']} is not ascending: taken as none")
        return None

    def _effort(self, element: Element, said: Mapping[str, str], name: str) -> float | None:
        own = self.xml.numbers(element, said.get("actuatorfrcrange", ""), "actuatorfrcrange", None) or ()
        limits = [max(map(abs, own))] if len(own) == 2 else []
        limits += [self.efforts[name]] if name in self.efforts else []
        return min(limits) if limits and min(limits) > 0.0 else None
