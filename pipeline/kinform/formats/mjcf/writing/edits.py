"""Numbers written into an MJCF: ranges of joints, inertials of bodies, the folder of its assets."""

from __future__ import annotations

import posixpath
from typing import Any

from lxml import etree

from kinform.formats.description.elements import tag_of
from kinform.formats.description.robot import Inertial, Robot
from kinform.formats.description.writing.xml_edits import numbers
from kinform.formats.mjcf.reading.defaults import elements, ranges_of

_TURNED = ("quat", "euler", "axisangle", "xyaxes", "zaxis", "diaginertia")


def write_range(root: Any, robot: Robot, joint: str, bounds: tuple[float, float]) -> None:
    """The range (rad or m, 0 at the pose of the file) of a joint, in the units of the file."""
    slides = next(j.type == "prismatic" for j in robot.joints if j.name == joint)
    for element, values in ranges_of(root, joint, bounds, slides=slides):
        element.set("range", numbers(values))
        element.set("limited", "true")


def write_inertial(root: Any, link: str, stated: Inertial) -> None:
    """The inertial of a body, in its frame."""
    body = next(e for e, _ in elements(root, "body") if (e.get("name") or "").replace("/", "_") == link)
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
