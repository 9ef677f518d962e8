"""`<attach>` of an MJCF: a model among the assets, or one body of it, put where the element stands, as MuJoCo has it.

A model is read by its own file: its compiler settings, default classes and meshes are its own. What it names has the
prefix in front, in the model that it is attached to. A body keeps the pose that it states; what is around it, body or
frame, stays behind.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import field, replace
from pathlib import Path

import numpy as np

from kinform.formats.description.elements import Element, Xml
from kinform.formats.description.mesh_files import MeshFiles
from kinform.formats.description.robot import Link, Ratio, RobotJoint, Shape
from kinform.foundation.algebra.displacements import inverse
from kinform.foundation.boundary import OUTSIDE, OUTSIDE_REMEDY
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.frozen import dataclass
from kinform.model.arrays import Array

ATTACHED_DEEP = 16
"""Models in each other that `<attach>` of an MJCF may name: robots have arms, arms hands, and hands fingers, four deep.
Chosen, not measured."""
COPIES_MOST = 20_000
"""Bodies that `<attach>` makes, or elements that `<replicate>` makes, at most: a few files that attach each other twice
make 2ⁿ, and what is replicated more often are ropes and grains, not machines. Chosen, not measured."""


SUFFIX = "{urn:kinform}suffix"
"""Attribute of `<attach>` elements that were replicated: what the names of the copy end with."""


@dataclass(frozen=True, eq=False)
class Content:
    """What a model holds, in its own world."""

    links: Mapping[str, Link]
    joints: Mapping[str, RobotJoint]
    loops: tuple[RobotJoint, ...]
    ratios: tuple[Ratio, ...]
    sites: Mapping[str, tuple[str, Array]]
    above: Mapping[str, str]
    """The body around each body; that of the world is none."""
    own: Mapping[str, Array]
    """(4, 4) of each body, in the frame or the body that it is stated in."""

    def below(self, body: str) -> Iterator[str]:
        """A body and all that are in it."""
        inside = {body}
        for name in self.links:  # a body is noted after the one around it
            if name in inside or self.above.get(name) in inside:
                inside.add(name)
                yield name


@dataclass
class Budget:
    """What all models of a description share: the models that are being read, and how much has been attached."""

    way: tuple[Path, ...]
    made: int = 0
    files: list[Path] = field(default_factory=list)
    """That were read besides the description."""
    notes: list[str] = field(default_factory=list)
    known: dict[Path, tuple[str, Content] | None] = field(default_factory=dict)
    """By file the name that a model gives itself, and what it holds."""


Read = Callable[[Path, bytes, Xml, MeshFiles, Budget], "tuple[str, Content] | None"]
"""Reads the model of a file with this content: the name that it gives itself, and what it holds."""


class Models:
    """The models among the assets of a description."""

    def __init__(self, xml: Xml, root: Element, path: Path, meshes: MeshFiles, budget: Budget, read: Read):
        self._xml, self._path, self._meshes, self._budget, self._read = xml, path, meshes, budget, read
        self._stated: dict[str, Element] = {}
        for element in (model for assets in xml.children(root, "asset") for model in xml.children(assets, "model")):
            name = element.get("name") or next(iter(self._of(element) or ()), None)
            if name is not None:
                self._stated[str(name)] = element

    def content(self, element: Element) -> Content | None:
        """The model that an `<attach>` names; None after noting what is wrong."""
        name = element.get("model") or ""
        if name not in self._stated:
            wrong = f"<attach>: there is no model {in_quotes(name)}"
            self._xml.complain(element, wrong, did_you_mean(name, self._stated, "the models"))
            return None
        read = self._of(self._stated[name])
        if read is None:
            return None
        self._budget.made += len(read[1].links)
        if self._budget.made > COPIES_MOST:
            self._xml.complain(element, f"<attach> makes more than {COPIES_MOST:,} bodies", "attach fewer")
            return None
        return read[1]

    def _of(self, element: Element) -> tuple[str, Content] | None:
        stated = (element.get("file") or "").replace("\\", "/")
        path = self._path.parent / stated
        full = path.resolve()
        shown = (Path(self._xml.file).parent / stated).as_posix()
        fault = None
        if not self._meshes.boundary.allows(path):
            fault = f"the model {in_quotes(stated)} {OUTSIDE}", OUTSIDE_REMEDY
        elif not stated or not self._meshes.boundary.is_file(path):
            fault = f"the model {in_quotes(stated)} does not exist", "correct its file"
        elif full in self._budget.way:
            fault = f"the model {in_quotes(stated)} attaches itself", "remove one of the models"
        elif len(self._budget.way) > ATTACHED_DEEP:
            fault = f"models in models are more than {ATTACHED_DEEP} deep", "attach fewer"
        if fault is not None:
            self._xml.complain(element, *fault)
            return None
        if full not in self._budget.known:
            way = self._budget.way
            self._budget.way = (*way, full)
            xml = Xml(shown, self._xml.problems)
            data = self._xml.content(element, path, self._meshes.boundary)
            meshes = self._meshes.beside(path)
            self._budget.known[full] = None if data is None else self._read(path, data, xml, meshes, self._budget)
            self._budget.way = way
        return self._budget.known[full]


def attached(xml: Xml, element: Element, content: Content, link: str, X: Array) -> Content | None:
    """What an `<attach>` in a body of that name, at the pose X in F, puts there, in F and under its new names.

    Geometry of the model's world is a link of the name of the body, to be joined with it. None after noting why.
    """
    body, prefix, suffix = element.get("body"), element.get("prefix"), element.get(SUFFIX, "")
    if element.get("frame") is not None:
        xml.complain(element, "<attach> of a frame is not read", "attach a body, or the whole model")
        return None
    if prefix is None:
        xml.complain(element, "<attach> has no prefix", 'add prefix="…"')
        return None
    world = next(iter(content.links))
    bodies = (world, *content.own)  # links between the joints of a body are none
    if body is not None and body not in bodies:
        wrong = f"<attach>: the model {in_quotes(element.get('model'))} has no body {in_quotes(body)}"
        xml.complain(element, wrong, did_you_mean(body, bodies, "its bodies"))
        return None
    top = world if body is None else body
    inside = list(content.below(top))
    around = content.above.get(top)
    move = X if around is None else X @ content.own[top] @ inverse(content.links[top].X_FL)
    names = {name: (prefix + name + suffix).replace("/", "_") for name in inside}
    if body is None:
        names[world] = link
    elif around is not None:
        names[around] = link
    return _Graft(move, names, frozenset(inside), prefix, suffix).of(content, None if body != world else (link, world))


@dataclass(frozen=True, eq=False)
class _Graft:
    """A motion (4, 4), and new names of links; those that go with it."""

    move: Array
    names: Mapping[str, str]
    inside: frozenset[str]
    prefix: str
    suffix: str

    def of(self, content: Content, held: tuple[str, str] | None) -> Content:
        """All that is inside; `held`: a link, and the world of the model that is fixed to it."""
        joints = {joint.name: joint for old in content.joints.values() if (joint := self._joint(old)) is not None}
        if held is not None:
            name = self._named(f"{held[1]} fixed")
            joints[name] = RobotJoint(name, "fixed", (held[0], self.names[held[1]]), content.links[held[1]].at)
        kept = {old.name for old in content.joints.values() if self._joint(old) is not None}
        return Content(
            links={self.names[name]: self._link(content.links[name]) for name in content.links if name in self.inside},
            joints=joints,
            loops=tuple(joint for old in content.loops if (joint := self._joint(old)) is not None),
            ratios=tuple(
                replace(ratio, joints=(self._named(ratio.joints[0]), self._named(ratio.joints[1])))
                for ratio in content.ratios
                if kept.issuperset(ratio.joints)
            ),
            sites={
                self.prefix + name + self.suffix: (self.names[link], self.move @ X)
                for name, (link, X) in content.sites.items()
                if link in self.inside
            },
            above={
                self.names[name]: self.names[around]
                for name, around in content.above.items()
                if name in self.inside and around in self.names
            },
            own={self.names[name]: X for name, X in content.own.items() if name in self.inside},
        )

    def _named(self, name: str) -> str:
        return (self.prefix + name + self.suffix).replace("/", "_")

    def _joint(self, joint: RobotJoint) -> RobotJoint | None:
        """None where a side stays behind, but for the body around the one that is attached."""
        if not (set(joint.between) <= set(self.names) and set(joint.between) & self.inside):
            return None
        R, p = self.move[:3, :3], self.move[:3, 3]
        return replace(
            joint,
            name=self._named(joint.name),
            between=(self.names[joint.between[0]], self.names[joint.between[1]]),
            axis=None if joint.axis is None else R @ joint.axis,
            axis2=None if joint.axis2 is None else R @ joint.axis2,
            point=None if joint.point is None else R @ joint.point + p,
        )

    def _link(self, link: Link) -> Link:
        R, p, inertial = self.move[:3, :3], self.move[:3, 3], link.inertial
        collision = tuple(map(self._shape, link.collision))
        if inertial is not None:
            turned = R @ inertial.inertia @ R.T
            inertial = replace(inertial, centre=R @ inertial.centre + p, inertia=0.5 * (turned + turned.T))
        return replace(
            link,
            name=self.names[link.name],
            X_FL=self.move @ link.X_FL,
            visual=collision if link.visual is link.collision else tuple(map(self._shape, link.visual)),
            collision=collision,
            inertial=inertial,
        )

    def _shape(self, shape: Shape) -> Shape:
        name = None if shape.name is None else self._named(shape.name)
        return replace(shape, name=name, X_FG=np.asarray(self.move @ shape.X_FG))
