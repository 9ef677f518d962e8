"""Numbers written into a URDF: limits of joints, inertials of links, the folder of its meshes. SI, radians."""

from __future__ import annotations

import posixpath
import re
from typing import Any

from lxml import etree

from kinform.formats.description.elements import tag_of
from kinform.formats.description.robot import Inertial, Robot


def _named(root: Any, tag: str, name: str) -> Any:
    """The link or joint of that name, as the reader calls it."""
    return next(e for e in root if tag_of(e) == tag and (e.get("name") or "").strip().replace("/", "_") == name)


def _child(element: Any, tag: str) -> Any:
    """The first child with that name, made where there is none."""
    found = next((child for child in element if tag_of(child) == tag), None)
    return etree.SubElement(element, tag) if found is None else found


def write_range(root: Any, robot: Robot, joint: str, bounds: tuple[float, float]) -> None:
    """The limits (rad or m) of a joint."""
    limit = _child(_named(root, "joint", joint), "limit")
    for key, bound in zip(("lower", "upper"), bounds, strict=True):
        limit.set(key, repr(float(bound)))
    for key in ("effort", "velocity"):
        if limit.get(key) is None:
            limit.set(key, "0")


def write_inertial(root: Any, link: str, stated: Inertial) -> None:
    """The inertial of a link, in its frame."""
    inertial = _child(_named(root, "link", link), "inertial")
    origin = _child(inertial, "origin")
    origin.set("xyz", " ".join(repr(float(v)) for v in stated.centre))
    origin.set("rpy", "0 0 0")
    _child(inertial, "mass").set("value", repr(float(stated.mass)))
    inertia = _child(inertial, "inertia")
    keys = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    for key, at in keys.items():
        inertia.set(key, repr(float(stated.inertia[at])))


def write_folder(root: Any, folder: str) -> None:
    """Plain relative paths of meshes and textures, which began in `folder`, as seen from the new place."""
    for element in root.iter():
        stated = element.get("filename") if isinstance(element.tag, str) else None
        plain = stated and tag_of(element) in ("mesh", "texture") and not re.match(r"[a-z]+:|/", stated.strip())
        if stated and plain:
            element.set("filename", posixpath.normpath(posixpath.join(folder, stated.strip())))
