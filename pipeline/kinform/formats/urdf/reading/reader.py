"""URDF: links and joints of a tree, as urdfdom reads it, and the `drake:joint` that kinform's own export writes.

Numbers are SI and radians. The frame F is that of the root link; joints stand at zero. What a URDF may hold besides
(transmissions, plugins, friction, safety controllers) is listed as not carried.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from kinform.form.problems import Problems
from kinform.formats.description.elements import Element, Xml, colour_of, parse_xml, tag_of, xml_text
from kinform.formats.description.inertials import placed, symmetric
from kinform.formats.description.mesh_files import MeshFiles
from kinform.formats.description.poses import place, pose, quaternion, rpy
from kinform.formats.description.robot import (
    NO_BOUND,
    Inertial,
    Limits,
    Link,
    Ratio,
    Robot,
    RobotJoint,
    Shape,
    Solid,
    Stated,
    bounded,
)
from kinform.formats.description.tree import Count, Edge, Tree, refuse_circle, tree_of
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array

TYPES = {
    "revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic", "fixed": "fixed", "planar": "planar",
    "ball": "spherical", "universal": "universal", "screw": "screw", "floating": "",
}  # fmt: skip
"""Types of joints, and kinform's; a floating one is none."""

_LINK = ("visual", "collision", "inertial")
_JOINT = ("origin", "parent", "child", "axis", "limit", "mimic", "dynamics", "screw_thread_pitch")
_QUIET = ("material",)


def read(path: Path, data: bytes, file: str, problems: Problems, meshes: MeshFiles) -> Robot | None:
    """The robot of a URDF text; None where nothing can be made of it, after noting why."""
    return read_text(path, data, file, problems, meshes)


def read_text(
    path: Path, data: bytes, file: str, problems: Problems, meshes: MeshFiles, written: str | None = None
) -> Robot | None:
    """As `read`; `written` is the text as people wrote it, where the data was expanded from that: lines are its own."""
    root = parse_xml(data, file, problems)
    if root is None:
        return None
    robot = _Reader(Xml(file, problems, written), meshes).robot(root, path.stem)
    return None if robot is None else replace(robot, format="urdf", text=xml_text(data))


class _Reader:
    def __init__(self, xml: Xml, meshes: MeshFiles):
        self.xml, self.meshes, self.left = xml, meshes, Count()
        self.colours: dict[str, str] = {}

    def robot(self, root: Element, name: str) -> Robot | None:
        xml = self.xml
        if tag_of(root) != "robot":
            xml.complain(root, f"the root is <{tag_of(root)}>, and a URDF has <robot>", "name a URDF")
            return None
        self.colours = self._colours(root)
        links = self._by_name(root, "link")
        joints = self._by_name(root, "joint")
        edges = [edge for joint in joints.items() if (edge := self._edge(*joint)) is not None]
        if len(edges) < len(joints):
            return None
        tree = tree_of({link: xml.at(e) for link, e in links.items()}, edges, xml.at(root), xml.problems)
        if tree is None:
            return None
        for child in xml.children(root):
            if tag_of(child) not in ("link", "joint", *_QUIET):
                self.left.add(f"<{tag_of(child)}>")
        made = [self._joint(label, joints[label], edge, tree) for label, edge in zip(joints, edges, strict=True)]
        return Robot(
            name=(root.get("name") or name).replace("/", "_") or name,
            at=xml.at(root),
            links=tuple(self._link(label, element, tree) for label, element in links.items()),
            joints=tuple(joint for joint in made if joint is not None),
            ratios=tuple(self._ratios(joints, {joint.name for joint in made if joint is not None})),
            root=tree.root,
            notes=self.left.sentences(xml.file),
        )

    def _by_name(self, root: Element, tag: str) -> dict[str, Element]:
        """Elements by name, each of its own."""
        out: dict[str, Element] = {}
        for element in self.xml.children(root, tag):
            name = self.xml.name(element)
            if name in out:
                first = self.xml.at(out[name]).line
                message = f"two {tag}s are named {in_quotes(name)}: the first is at line {first}"
                self.xml.complain(element, message, "rename one of them")
            elif name is not None:
                out[name] = element
        return out

    def _colours(self, root: Element) -> dict[str, str]:
        """Colours of materials by name; the first that is stated counts, of the whole robot before of a visual."""
        out: dict[str, str] = {}
        for element in (*self.xml.children(root, "material"), *root.iter("material")):
            color = self.xml.child(element, "color")
            colour = None if color is None else colour_of(color.get("rgba"))
            if colour is not None:
                out.setdefault(element.get("name") or "", colour)
        return out

    def _colour(self, element: Element) -> str | None:
        """The colour of a visual: its own, else that of the material that it names."""
        material = self.xml.child(element, "material")
        if material is None:
            return None
        own = self.xml.child(material, "color")
        return (None if own is None else colour_of(own.get("rgba"))) or self.colours.get(material.get("name") or "")

    def _origin(self, element: Element | None) -> Array:
        origin = self.xml.child(element, "origin")
        place = self.xml.vector(origin, "xyz", (0.0, 0.0, 0.0))
        if origin is None or origin.get("quat_xyzw") is None:
            return pose(rpy(self.xml.vector(origin, "rpy", (0.0, 0.0, 0.0))), place)
        x, y, z, w = self.xml.vector(origin, "quat_xyzw", (0.0, 0.0, 0.0, 1.0))
        if origin.get("rpy") is not None or not any((x, y, z, w)):
            wrong = "rpy and quat_xyzw" if origin.get("rpy") is not None else "a quat_xyzw that is zero"
            self.xml.complain(origin, f"<origin> has {wrong}", "give one rotation")
        return pose(quaternion((w, x, y, z)), place)

    def _edge(self, name: str, element: Element) -> Edge | None:
        ends = []
        for tag in ("parent", "child"):
            end = self.xml.child(element, tag)
            if end is None:
                self.xml.complain(element, f"joint {in_quotes(name)} has no <{tag}>", f'add <{tag} link="…"/>')
                return None
            ends.append(self.xml.name(end, "link"))
        if ends[0] is None or ends[1] is None:
            return None
        return name, ends[0], ends[1], self._origin(element), self.xml.at(element)

    def _link(self, name: str, element: Element, tree: Tree) -> Link:
        X_FL = tree.poses[name]
        for child in self.xml.children(element):
            if tag_of(child) not in _LINK:
                self.left.add(f"<{tag_of(child)}> of links")
        visual, collision = (
            tuple(s for e in self.xml.children(element, tag) if (s := self._shape(e, name, X_FL)) is not None)
            for tag in ("visual", "collision")
        )
        inertial = self.xml.child(element, "inertial")
        return Link(name, X_FL, self.xml.at(element), visual, collision,
                    None if inertial is None else self._inertial(inertial, name, X_FL),
                    None if inertial is None else self._stated(inertial))  # fmt: skip

    def _stated(self, element: Element) -> Stated | None:
        """What an inertial says, word for word; None without a mass."""
        mass = self.xml.number(self.xml.child(element, "mass"), "value")
        numbers = self.xml.child(element, "inertia")
        keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        six = None if numbers is None else tuple(self.xml.number(numbers, key, 0.0) or 0.0 for key in keys)
        return None if mass is None else Stated(mass, six, self.xml.at(element))

    def _shape(self, element: Element, link: str, X_FL: Array) -> Shape | None:
        what = f"link {in_quotes(link)}"
        kind = next(self.xml.children(self.xml.child(element, "geometry")), None)
        if kind is None:
            wrong = f"{what}: <{tag_of(element)}> has no geometry"
            self.xml.complain(element, wrong, "add <geometry> with a mesh, box, cylinder or sphere")
            return None
        X = X_FL @ self._origin(element)
        label = (element.get("name") or "").strip().replace("/", "_") or None
        if tag_of(kind) == "mesh":
            shape = self._mesh(kind, what, label, X)
        else:
            solid = self._solid(kind, what)
            shape = None if solid is None else Shape(label, solid, (1.0, 1.0, 1.0), X, self.xml.at(kind))
        return None if shape is None else replace(shape, colour=self._colour(element))

    def _mesh(self, kind: Element, what: str, label: str | None, X: Array) -> Shape | None:
        scale = self.xml.vector(kind, "scale", (1.0, 1.0, 1.0))
        if 0.0 in scale:
            self.xml.complain(kind, f"{what}: the scale of its mesh has a zero", 'give scale="1 1 1"')
            return None
        if not (kind.get("filename") or "").strip():
            self.xml.complain(kind, f"{what}: its mesh names no file", 'add filename="…"')
            return None
        found = self.meshes.find(kind.get("filename"))
        if found.path is None:
            self.xml.not_found(kind, f"{what}: the mesh", found)
            return None
        return Shape(label, found.path, (scale[0], scale[1], scale[2]), X, self.xml.at(kind))

    def _solid(self, kind: Element, what: str) -> Solid | None:
        tag = tag_of(kind)
        keys = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",),
                "capsule": ("radius", "length")}  # fmt: skip
        if tag not in keys:
            wrong = f"{what}: geometry <{tag}> is not known"
            self.xml.complain(kind, wrong, did_you_mean(tag, [*keys, "mesh"], "the kinds"))
            return None
        sizes: tuple[float, ...] = ()
        for key in keys[tag]:
            if kind.get(key) is None:
                self.xml.complain(kind, f"{what}: <{tag}> has no {key}", f'add {key}="…"')
                return None
            sizes += self.xml.vector(kind, key, (1.0, 1.0, 1.0) if key == "size" else (1.0,))
        if min(sizes) <= 0.0:
            self.xml.complain(kind, f"{what}: <{tag}> has a size that is not positive", "give positive lengths")
            return None
        return Solid(tag, sizes)

    def _inertial(self, element: Element, link: str, X_FL: Array) -> Inertial | None:
        mass = self.xml.number(self.xml.child(element, "mass"), "value")
        numbers = self.xml.child(element, "inertia")
        if mass is None or numbers is None:
            self.left.notes.append(f"link {in_quotes(link)} states no mass, or no inertia: taken as not stated")
            return None
        if mass <= 0.0:
            self.left.notes.append(f"link {in_quotes(link)} states the mass {mass:g} kg: taken as not stated")
            return None
        six = [self.xml.number(numbers, key, 0.0) or 0.0 for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")]
        return placed(mass, X_FL @ self._origin(element), symmetric(*six), self.xml.at(element))

    def _joint(self, name: str, element: Element, edge: Edge, tree: Tree) -> RobotJoint | None:
        xml, what = self.xml, f"joint {in_quotes(name)}"
        stated = (element.get("type") or "").strip()
        if stated not in TYPES:
            xml.complain(
                element, f"{what}: type {in_quotes(stated)} is not known", did_you_mean(stated, TYPES, "types")
            )
            return None
        kind = TYPES[stated]
        for child in xml.children(element):
            if tag_of(child) not in _JOINT:
                self.left.add(f"<{tag_of(child)}> of joints")
        if not kind:
            self.left.notes.append(f"joint {in_quotes(name)} is floating: no joint is intended there")
            return None
        X = tree.poses[edge[2]]
        axes = self._axes(element, what, kind)
        if axes is None:
            return None
        turned = [X[:3, :3] @ axis for axis in axes]
        limit, dynamics = xml.child(element, "limit"), xml.child(element, "dynamics")
        if (xml.number(dynamics, "friction", 0.0) or 0.0) != 0.0:
            self.left.add("friction of joints")
        moves_one = kind in ("revolute", "prismatic")
        pitch = xml.number(xml.child(element, "screw_thread_pitch"), "value") if kind == "screw" else None
        if kind == "screw" and not pitch:
            xml.complain(element, f"{what}: a screw needs a pitch", 'add <drake:screw_thread_pitch value="…"/>')
            return None
        return RobotJoint(
            name=name, type=kind, between=(edge[1], edge[2]), at=xml.at(element),
            axis=turned[0] if kind not in ("fixed", "spherical") else None,
            axis2=turned[1] if kind == "universal" else None,
            point=None if kind in ("fixed", "prismatic") else place(X, (0.0, 0.0, 0.0)),
            pitch=pitch,
            range=self._range(limit, stated, what) if moves_one else None,
            effort=self._positive(limit, "effort") if moves_one else None,
            speed=self._positive(limit, "velocity") if moves_one else None,
            damping=self._positive(dynamics, "damping") if moves_one else None,
            limits=self._limits(limit, stated) if moves_one else None,
        )  # fmt: skip

    def _limits(self, limit: Element | None, stated: str) -> Limits:
        """The limits of a joint, word for word."""
        needed = stated in ("revolute", "prismatic")
        if limit is None:
            return Limits(stated, needed)
        bounds = None
        if needed:
            bounds = (self.xml.number(limit, "lower", 0.0) or 0.0, self.xml.number(limit, "upper", 0.0) or 0.0)
        effort, speed = (self.xml.number(limit, key) for key in ("effort", "velocity"))
        return Limits(stated, needed, bounds, effort, speed)

    def _axes(self, element: Element, what: str, kind: str) -> list[Array] | None:
        """Unit axes in the joint's frame, of which a universal joint has two: x and y, as Drake has it."""
        if kind == "universal":
            return [np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])]
        stated = self.xml.child(element, "axis")
        axis = np.array(self.xml.vector(stated, "xyz", (1.0, 0.0, 0.0)))
        size = float(np.linalg.norm(axis))
        if size < SOLVED and kind in ("fixed", "spherical"):
            return [np.array([1.0, 0.0, 0.0])]
        if size < SOLVED:
            self.xml.complain(stated, f"{what}: its axis is zero", 'give an axis such as xyz="0 0 1"')
            return None
        return [axis / size]

    def _range(self, limit: Element | None, stated: str, what: str) -> tuple[float, float] | None:
        if stated == "continuous":
            return None
        if limit is None:
            self.left.notes.append(f"{what} is {stated} and states no limits: taken as without range")
            return None
        lower, upper = (self.xml.number(limit, key, 0.0) or 0.0 for key in ("lower", "upper"))
        if lower < upper:
            return bounded(lower, upper)
        words = "are both 0" if lower == upper == 0.0 else f"{lower:g} and {upper:g} are not ascending"
        self.left.notes.append(f"{what}: its limits {words}: taken as without range")
        return None

    def _positive(self, element: Element | None, key: str) -> float | None:
        value = self.xml.number(element, key)
        most = NO_BOUND if key in ("effort", "velocity") else math.inf
        return value if value is not None and 0.0 < value < most else None

    def _ratios(self, joints: dict[str, Element], made: set[str]) -> list[Ratio]:
        out = []
        for name, element in joints.items():
            mimic = self.xml.child(element, "mimic")
            if mimic is None:
                continue
            leader = self.xml.name(mimic, "joint")
            if leader is None:
                continue
            if leader not in joints or leader == name:
                wrong = f"joint {in_quotes(name)} mimics {in_quotes(leader)}, which is "
                wrong += "itself" if leader == name else "no joint"
                others = [other for other in joints if other != name]
                remedy = did_you_mean(leader, others, "the joints") if others else "remove <mimic>: no joint could lead"
                self.xml.complain(mimic, wrong, remedy)
                continue
            ratio = self.xml.number(mimic, "multiplier", 1.0)
            offset = self.xml.number(mimic, "offset", 0.0) or 0.0
            if offset:
                self.left.add("offset of <mimic>")
            if not ratio or name not in made or leader not in made:
                self.left.add("<mimic> of ratio zero" if not ratio else "<mimic> of a joint that is not carried")
                continue
            out.append(Ratio((name, leader), ratio, self.xml.at(mimic), offset))
        refuse_circle(out, self.xml.problems)
        return out
