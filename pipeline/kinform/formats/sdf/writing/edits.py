"""Numbers written into an SDF: limits of joints, inertials of links, the folder of its meshes. SI, radians."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from lxml import etree

from kinform.formats.description.elements import tag_of
from kinform.formats.description.robot import Inertial, Robot
from kinform.formats.description.writing.xml_edits import child_of, inertia_numbers, moved, name_of, numbers

_FILES = ("uri", "filename", "albedo_map", "normal_map", "roughness_map", "metalness_map", "environment_map")
"""Elements whose text is the path of a file."""


def _models(element: Any, scope: str) -> Iterator[tuple[str, Any]]:
    """Models in an element, nested ones too, with the prefix of the names in each."""
    for child in element:
        if tag_of(child) == "model":
            inner = f"{scope}{name_of(child)}::"
            yield inner, child
            yield from _models(child, inner)


def _all_models(root: Any) -> Iterator[tuple[str, Any]]:
    """All models, as the reader calls what is in them: one that is alone in its file gives no prefix."""
    worlds = [child for child in root if tag_of(child) == "world"]
    own = [child for child in root if tag_of(child) == "model"]
    if len(own) == 1 and not worlds:
        yield "", own[0]
        yield from _models(own[0], "")
        return
    for element in (root, *worlds):
        yield from _models(element, "")


def _named(root: Any, tag: str, name: str) -> Any:
    """The link or joint of that full name."""
    return next(e for scope, m in _all_models(root) for e in m if tag_of(e) == tag and scope + name_of(e) == name)


def write_range(root: Any, robot: Robot, joint: str, bounds: tuple[float, float]) -> None:
    """The limits (rad or m) of a joint."""
    limit = child_of(child_of(_named(root, "joint", joint), "axis"), "limit")
    for key, bound in zip(("lower", "upper"), bounds, strict=True):
        child_of(limit, key).text = repr(float(bound))


def write_inertial(root: Any, link: str, stated: Inertial) -> None:
    """The inertial of a link, in its frame."""
    inertial = child_of(_named(root, "link", link), "inertial")
    inertial.attrib.pop("auto", None)
    for child in [child for child in inertial if tag_of(child) in ("density", "auto_inertia_params")]:
        inertial.remove(child)
    pose = child_of(inertial, "pose")
    pose.attrib.clear()
    pose.text = numbers((*stated.centre, 0.0, 0.0, 0.0))
    child_of(inertial, "mass").text = repr(float(stated.mass))
    inertia = child_of(inertial, "inertia")
    for key, text in inertia_numbers(stated.inertia):
        child_of(inertia, key).text = text


def write_folder(root: Any, folder: str) -> None:
    """Plain relative paths of meshes and textures, which began in `folder`, as seen from the new place."""
    for element in root.iter(etree.Element):
        path = moved(element.text or "", folder) if tag_of(element) in _FILES else None
        if path is not None:
            element.text = path
