"""SDF 1.4 to 1.12: models in models, links and joints in frames, as SDFormat defines them.

The frame F is that of the world. Every pose is stated, so that joints may also close loops. The axis of a joint is in
the joint's frame since 1.5, in the model's before and with `use_parent_model_frame`, and in `expressed_in` since 1.7.
What is not carried is listed by name.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from kinform.form.problems import Problems
from kinform.formats.description.elements import Element, Xml, parse_xml, tag_of
from kinform.formats.description.mesh_files import MeshFiles
from kinform.formats.description.poses import place
from kinform.formats.description.robot import NO_BOUND, Limits, Link, Ratio, Robot, RobotJoint, bounded
from kinform.formats.description.tree import Count, distinct, refuse_circle
from kinform.formats.sdf.reading.frames import WORLD, Frame, Frames
from kinform.formats.sdf.reading.links import Links
from kinform.formats.sdf.reading.models import Model, Models, version_of
from kinform.formats.sdf.reading.text import whole_text
from kinform.formats.sdf.reading.values import Values
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array

TYPES = {
    "revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic", "fixed": "fixed", "ball": "spherical",
    "universal": "universal", "revolute2": "universal", "screw": "screw", "gearbox": "revolute",
}  # fmt: skip
"""Types of joints, and kinform's."""

_MODEL = ("link", "joint", "frame", "model", "include", "pose", "static", "self_collide", "allow_auto_disable",
          "enable_wind")  # fmt: skip
_JOINT = ("parent", "child", "pose", "axis", "axis2", "thread_pitch", "screw_thread_pitch", "gearbox_ratio",
          "gearbox_reference_body")  # fmt: skip
_IN_WORLD = ("model", "include", "frame", "physics", "gravity", "light", "scene", "gui", "atmosphere", "audio", "wind",
             "magnetic_field", "spherical_coordinates")  # fmt: skip
_ROOT = ("model", "include", "world", "frame")


def read(path: Path, data: bytes, file: str, problems: Problems, meshes: MeshFiles) -> Robot | None:
    """The robot of an SDF text; None where nothing can be made of it, after noting why."""
    root = parse_xml(data, file, problems)
    if root is None:
        return None
    xml = Xml(file, problems)
    if tag_of(root) != "sdf":
        xml.complain(root, f"the root is <{tag_of(root)}>, and an SDF has <sdf>", "name an SDF")
        return None
    reader = _Reader(xml, meshes)
    robot = reader.robot(root, path)
    if robot is None:
        return None
    return replace(robot, format="sdf", text=whole_text(root, data, reader.models.included))


class _Reader:
    def __init__(self, xml: Xml, meshes: MeshFiles):
        self.xml, self.values, self.left = xml, Values(xml), Count()
        self.frames = Frames(xml)
        self.models = Models(xml, meshes, self.frames, self.left)
        self.links = Links(self.values, self.frames, meshes, self.left)
        self.joints: dict[str, RobotJoint] = {}
        self.stated: dict[str, tuple[Model, Element]] = {}
        self.between: dict[str, Link] = {}

    def robot(self, root: Element, path: Path) -> Robot | None:
        """All of it."""
        xml = self.xml
        for child in xml.children(root):
            if tag_of(child) not in _ROOT:
                self.left.add(f"<{tag_of(child)}>")
        self.models.collect(root, path)
        for model in self.models.models:
            self._state(model)
        for world in xml.children(root, "world"):
            self._state_world(Model(WORLD, world, path.parent, version_of(root), static=False))
        if not self.links.stated and not len(xml.problems):
            xml.complain(root, "has no link in a model", "add a <model> with links")
        if len(xml.problems):
            return None
        links = self.links.read()
        for name in self.stated:
            self._joint(name)
        self._hold(links)
        ratios = [ratio for joint in self.stated if (ratio := self._ratio(joint)) is not None]
        refuse_circle(ratios, xml.problems)
        label = next((m.element.get("name") for m in self.models.models), None) or path.stem
        every = (*links.values(), *self.between.values())
        world = Link(WORLD, np.eye(4), xml.at(root))
        joints, taken = tuple(self.joints.values()), {link.name for link in every}
        held = [joint for joint in joints if WORLD in joint.between]
        name = distinct(taken)("world")
        keep = len(held) > 1 or any(joint.type != "fixed" for joint in held)
        ends = [joint.between[0] or joint.between[1] for joint in held]
        return Robot(
            name=label.replace("/", "_"),
            at=xml.at(root),
            links=(*every, Link(name, world.X_FL, world.at)) if keep else every,
            joints=tuple(_renamed(j, name) for j in joints if keep or j not in held),
            ratios=tuple(ratios),
            root=name if keep else next((end for end in ends), next(iter(links), None)),
            notes=self.left.sentences(xml.file),
            files=tuple(self.models.files),
        )

    def _state(self, model: Model) -> None:
        """Note the links and joints of a model, and their frames."""
        for child in self.xml.children(model.element):
            tag = tag_of(child)
            if tag not in _MODEL:
                self.left.add(f"<{tag}> of models")
            if tag in ("link", "joint"):
                self._note(model, child)

    def _state_world(self, world: Model) -> None:
        """Note the joints between models, and what is in a world besides."""
        for child in self.xml.children(world.element):
            tag = tag_of(child)
            if tag == "joint":
                self._note(world, child)
            elif tag not in _IN_WORLD:
                self.left.add(f"<{tag}> of worlds")

    def _note(self, model: Model, element: Element) -> None:
        tag, name = tag_of(element), self.values.name(element)
        if name is None:
            return
        full = model.scope + name
        known: dict[str, tuple[Model, Element]] = self.links.stated if tag == "link" else self.stated
        if full in known:
            first = self.xml.at(known[full][1]).line
            message = f"two {tag}s are named {in_quotes(full)}: the first is at line {first}"
            self.xml.complain(element, message, "rename one of them")
            return
        known[full] = model, element
        X, relative = self.values.pose(element)
        if tag == "link":
            self.frames.add(full, Frame(model.scope, relative or model.home, X, element))
        else:
            below = self.values.text(element, "child") or ""
            self.frames.add(full, Frame(model.scope, relative or below, X, element, below))

    def _hold(self, links: dict[str, Link]) -> None:
        """Static models are fixed to the world."""
        free = distinct(set(self.joints))
        for name, (model, element) in self.links.stated.items():
            if model.static and name in links:
                label = free(f"{name} static")
                self.joints[label] = RobotJoint(label, "fixed", (WORLD, name), self.xml.at(element))

    def _ends(self, what: str, model: Model, element: Element) -> tuple[str, str] | None:
        """The links of a joint, "" for the world; None after noting what is wrong."""
        ends: list[str] = []
        for tag in ("parent", "child"):
            child, stated = self.xml.child(element, tag), self.values.text(element, tag)
            if child is None or stated is None:
                self.xml.complain(element, f"{what} has no <{tag}>", f"add <{tag}>LINK</{tag}>")
                return None
            full = self.frames.full(model.scope, stated, child, f"{what}: its {tag}")
            link = None if full is None else self.frames.link_of(full, self.links.stated)
            if link is None:
                return None
            ends.append(link)
        if ends[0] == ends[1]:
            self.xml.complain(element, f"{what} joins {in_quotes(ends[0] or 'world')} to itself", "name two links")
            return None
        return ends[0], ends[1]

    def _joint(self, name: str) -> None:
        model, element = self.stated[name]
        xml, values, what = self.xml, self.values, f"joint {in_quotes(name)}"
        stated = (element.get("type") or "").strip()
        if stated not in TYPES:
            xml.complain(
                element, f"{what}: type {in_quotes(stated)} is not known", did_you_mean(stated, TYPES, "types")
            )
            return
        kind = TYPES[stated]
        for child in xml.children(element):
            if tag_of(child) not in _JOINT:
                self.left.add(f"<{tag_of(child)}> of joints")
        between, X = self._ends(what, model, element), self._frame_of(model, element)
        if between is None or X is None:
            return
        if stated == "gearbox":
            self.left.add("ratio of gearbox joints")
        axes = self._axes(what, model, element, kind, X)
        if axes is None:
            return
        one, axis = kind in ("revolute", "prismatic"), xml.child(element, "axis")
        limit, dynamics = xml.child(axis, "limit"), xml.child(axis, "dynamics")
        if values.number(dynamics, "friction", 0.0):
            self.left.add("friction of joints")
        if kind == "universal" and any(self._range(xml.child(element, tag), what) for tag in ("axis", "axis2")):
            self.left.add("limits of universal joints")
        pitch = self._pitch(what, element) if kind == "screw" else None
        if kind == "screw" and pitch is None:
            return
        self.joints[name] = RobotJoint(
            name=name, type=kind, between=between, at=xml.at(element),
            axis=axes[0] if axes else None, axis2=axes[1] if len(axes) > 1 else None,
            point=None if kind in ("fixed", "prismatic") else place(X, (0.0, 0.0, 0.0)),
            pitch=pitch,
            range=self._range(axis, what) if one and stated != "continuous" else None,
            effort=_bound(values.number(limit, "effort", -1.0), NO_BOUND) if one else None,
            speed=_bound(values.number(limit, "velocity", -1.0), NO_BOUND) if one else None,
            damping=_bound(values.number(dynamics, "damping", 0.0)) if one else None,
            stiffness=_bound(values.number(dynamics, "spring_stiffness", 0.0)) if one else None,
            rest=values.finite(dynamics, "spring_reference", 0.0) if one else 0.0,
            limits=self._limits(limit, stated) if one else None,
        )  # fmt: skip

    def _limits(self, limit: Element | None, stated: str) -> Limits:
        """The limits of a joint, word for word; SDF needs none."""
        named = [limit is not None and self.xml.child(limit, tag) is not None for tag in ("lower", "upper")]
        lower, upper = (self.values.number(limit, tag, 0.0) for tag in ("lower", "upper"))
        known = all(named) and stated != "continuous" and math.isfinite(lower) and math.isfinite(upper)
        return Limits(stated, False, (lower, upper) if known else None)

    def _frame_of(self, model: Model, element: Element) -> Array | None:
        """The pose (4, 4) of a joint, which is relative to its child unless it says otherwise."""
        X, relative = self.values.pose(element)
        below = relative or self.values.text(element, "child") or ""
        full = self.frames.full(model.scope, below, element, "the pose: its relative_to")
        X_FB = None if full is None else self.frames.pose(full)
        return None if X_FB is None else np.asarray(X_FB @ X)

    def _axes(self, what: str, model: Model, element: Element, kind: str, X: Array) -> list[Array] | None:
        """Unit axes in F; None after noting what is wrong."""
        out = []
        tags = {"fixed": (), "spherical": (), "universal": ("axis", "axis2")}.get(kind, ("axis",))
        for tag in tags:
            axis = self.xml.child(element, tag)
            if axis is None:
                self.xml.complain(element, f"{what} has no <{tag}>", f"add <{tag}><xyz>0 0 1</xyz></{tag}>")
                return None
            direction = np.array(self.values.vector(axis, "xyz", (0.0, 0.0, 1.0)))
            size = float(np.linalg.norm(direction))
            if size < SOLVED:
                self.xml.complain(axis, f"{what}: its axis is zero", "give an axis such as <xyz>0 0 1</xyz>")
                return None
            R = self._seen_from(what, model, axis, X)
            if R is None:
                return None
            out.append(R @ (direction / size))
        if len(out) == 2 and float(np.linalg.norm(np.cross(out[0], out[1]))) < SOLVED:
            self.xml.complain(element, f"{what}: its two axes are parallel", "give axes at right angles")
            return None
        return out

    def _seen_from(self, what: str, model: Model, axis: Element, X: Array) -> Array | None:
        """The rotation (3, 3) of the frame in which an axis is stated."""
        child = self.xml.child(axis, "xyz")
        stated = (child.get("expressed_in") or "").strip() if child is not None else ""
        if not stated and (model.version < (1, 5) or self.values.true(axis, "use_parent_model_frame")):
            stated = model.home
        if not stated:
            return np.asarray(X[:3, :3])
        full = self.frames.full(model.scope, stated, axis, f"{what}: expressed_in")
        X_FE = None if full is None else self.frames.pose(full)
        return None if X_FE is None else np.asarray(X_FE[:3, :3])

    def _pitch(self, what: str, element: Element) -> float | None:
        """Metres a turn, right-handed positive; `thread_pitch` is in radians a metre, left-handed positive."""
        pitch = self.values.finite(element, "screw_thread_pitch", 0.0)
        old = self.values.finite(element, "thread_pitch", 0.0)
        if pitch == 0.0 and old == 0.0:
            remedy = "add <screw_thread_pitch> (metres a turn)"
            self.xml.complain(element, f"{what}: a screw needs a pitch", remedy)
            return None
        return pitch or -2.0 * math.pi / old

    def _range(self, axis: Element | None, what: str) -> tuple[float, float] | None:
        limit = self.xml.child(axis, "limit")
        lower, upper = (
            self.values.number(limit, key, bound) for key, bound in (("lower", -math.inf), ("upper", math.inf))
        )
        if lower < upper:
            return bounded(lower, upper)
        words = "are both 0" if lower == upper == 0.0 else f"{lower:g} and {upper:g} are not ascending"
        self.left.notes.append(f"{what}: its limits {words}: taken as without range")
        return None

    def _ratio(self, name: str) -> Ratio | None:
        model, element = self.stated[name]
        mimic = self.xml.child(self.xml.child(element, "axis"), "mimic")
        if mimic is None or name not in self.joints:
            return None
        leader = model.scope + (mimic.get("joint") or "").strip()
        if leader not in self.stated or leader == name:
            others = (other.removeprefix(model.scope) for other in self.stated if other != name)
            message = f"joint {in_quotes(name)} mimics {in_quotes(mimic.get('joint') or '')}, which is no other joint"
            remedy = "remove <mimic>: no joint could lead"
            if len(self.stated) > 1:
                remedy = did_you_mean(mimic.get("joint") or "", others, "the joints")
            self.xml.complain(mimic, message, remedy)
            return None
        ratio = self.values.finite(mimic, "multiplier", 1.0)
        offset, reference = (self.values.finite(mimic, key, 0.0) for key in ("offset", "reference"))
        if offset or reference:
            self.left.add("offset of <mimic>")
        movable = all(self.joints[j].type in ("revolute", "prismatic") for j in (name, leader) if j in self.joints)
        if not ratio or leader not in self.joints or not movable or mimic.get("axis", "axis") != "axis":
            self.left.add("<mimic> of ratio zero" if not ratio else "<mimic> of a joint that is not carried")
            return None
        return Ratio((name, leader), ratio, self.xml.at(mimic), offset - ratio * reference)


def _bound(value: float, most: float = math.inf) -> float | None:
    """A positive bound below the most that is one; SDF has negative and infinite ones for none."""
    return value if 0.0 < value < most else None


def _renamed(joint: RobotJoint, world: str) -> RobotJoint:
    """The joint with a name for the world."""
    first, second = (end or world for end in joint.between)
    return replace(joint, between=(first, second))
