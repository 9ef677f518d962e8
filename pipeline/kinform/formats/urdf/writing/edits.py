"""Numbers written into a URDF: limits of joints, inertials of links, the folder of its meshes. SI, radians."""

from __future__ import annotations

from typing import Any

from kinform.formats.description.elements import tag_of
from kinform.formats.description.robot import Inertial, Robot
from kinform.formats.description.writing.xml_edits import child_of, inertia_numbers, moved, name_of, numbers


def _named(root: Any, tag: str, name: str) -> Any:
    """The link or joint of that name, as the reader calls it."""
    return next(e for e in root if tag_of(e) == tag and name_of(e) == name)


def write_range(root: Any, robot: Robot, joint: str, bounds: tuple[float, float]) -> None:
    """The limits (rad or m) of a joint."""
    limit = child_of(_named(root, "joint", joint), "limit")
    for key, bound in zip(("lower", "upper"), bounds, strict=True):
        limit.set(key, repr(float(bound)))
    for key in ("effort", "velocity"):
        if limit.get(key) is None:
            limit.set(key, "0")


def write_inertial(root: Any, link: str, stated: Inertial) -> None:
    """The inertial of a link, in its frame."""
    inertial = child_of(_named(root, "link", link), "inertial")
    origin = child_of(inertial, "origin")
    origin.set("xyz", numbers(stated.centre))
    origin.set("rpy", "0 0 0")
    child_of(inertial, "mass").set("value", repr(float(stated.mass)))
    inertia = child_of(inertial, "inertia")
    for key, text in inertia_numbers(stated.inertia):
        inertia.set(key, text)


def write_folder(root: Any, folder: str) -> None:
    """Plain relative paths of meshes and textures, which began in `folder`, as seen from the new place."""
    for element in root.iter():
        if isinstance(element.tag, str) and tag_of(element) in ("mesh", "texture"):
            path = moved(element.get("filename") or "", folder)
            if path is not None:
                element.set("filename", path)
