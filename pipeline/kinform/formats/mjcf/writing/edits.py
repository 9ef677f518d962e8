"""Numbers written into an MJCF: ranges of joints, inertials of bodies, the folder of its assets."""

from __future__ import annotations

import math
import posixpath
from collections.abc import Iterator
from typing import Any

from lxml import etree

from kinform.form.problems import Problems
from kinform.formats.description.elements import Xml, tag_of
from kinform.formats.description.robot import Inertial, Robot
from kinform.formats.description.writing.xml_edits import numbers
from kinform.formats.mjcf.reading.defaults import Compiler, Defaults

_TURNED = ("quat", "euler", "axisangle", "xyaxes", "zaxis", "diaginertia")


def _elements(root: Any, tag: str) -> Iterator[tuple[Any, str | None]]:
    """Elements of the world with that name, each with the class that it inherits."""
    waiting = [(world, world.get("childclass")) for world in root if tag_of(world) == "worldbody"]
    while waiting:
        element, named = waiting.pop()
        for child in element:
            inherited = child.get("childclass") or named
            if tag_of(child) == tag:
                yield child, inherited if tag == "body" else named
            if tag_of(child) in ("body", "frame"):
                waiting.append((child, inherited))


def write_range(root: Any, robot: Robot, joint: str, bounds: tuple[float, float]) -> None:
    """The range (rad or m, 0 at the pose of the file) of a joint, in the units of the file."""
    xml = Xml("", Problems())
    compiler, defaults = Compiler.of(xml, root), Defaults(xml, root)
    slides = next(j.type == "prismatic" for j in robot.joints if j.name == joint)
    for element, named in _elements(root, "joint"):
        said = defaults.said(element, named)
        if (said.get("name") or "").replace("/", "_") == joint:
            unit = 1.0 if slides or not compiler.degrees else math.pi / 180.0
            ref = float(said.get("ref", "0"))
            element.set("range", numbers(bound / unit + ref for bound in bounds))
            element.set("limited", "true")


def write_inertial(root: Any, link: str, stated: Inertial) -> None:
    """The inertial of a body, in its frame."""
    body = next(e for e, _ in _elements(root, "body") if (e.get("name") or "").replace("/", "_") == link)
    inertial = next((child for child in body if tag_of(child) == "inertial"), None)
    if inertial is None:
        inertial = etree.Element("inertial")
        body.insert(0, inertial)
    for key in _TURNED:
        inertial.attrib.pop(key, None)
    inertial.set("pos", numbers(stated.centre))
    inertial.set("mass", repr(float(stated.mass)))
    six = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    inertial.set("fullinertia", numbers(stated.inertia[at] for at in six))


def write_folder(root: Any, folder: str) -> None:
    """The folders of meshes and textures, which were relative to `folder`, as seen from the new place."""
    said: dict[str, str] = {}
    compilers = [child for child in root if tag_of(child) == "compiler"]
    for compiler in compilers:
        for key in ("assetdir", "meshdir", "texturedir"):
            if key in compiler.attrib:
                said[key] = compiler.attrib.pop(key)
    if not compilers:
        compilers = [etree.Element("compiler")]
        root.insert(0, compilers[0])
    for key in ("meshdir", "texturedir"):
        stated = said.get(key, said.get("assetdir", ""))
        compilers[-1].set(key, posixpath.normpath(posixpath.join(folder, stated)))
