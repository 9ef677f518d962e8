"""An SDF as one text, with its includes put in, so that it can be written back.

An include becomes the model that it names, under the name and in the pose that the include gives, its meshes seen from
the folder of the file around it. That is the same model only where both files are read by the same rules.
"""

from __future__ import annotations

import copy
import os
import re
from collections.abc import Sequence
from pathlib import Path

from lxml import etree

from kinform.formats.description.elements import FILE, Element, tag_of, xml_text
from kinform.frozen import dataclass

MODERN = (1, 7)
"""The version from which on poses and axes are said in the same way."""
_OVER = ("pose", "static")
"""What an include says over the model: in place of what that says."""


@dataclass(frozen=True, eq=False)
class Included:
    """An include and the model in its place."""

    element: Element
    model: Element
    name: str
    folders: tuple[Path, Path]
    """Of the file that includes, and of the one that is included."""
    versions: tuple[tuple[int, ...], tuple[int, ...]]
    """As `folders`."""
    merged: bool = False
    """What the model holds comes in its place, and not the model."""


def whole_text(root: Element, data: bytes, includes: Sequence[Included]) -> str:
    """The text of all of it; "" where includes cannot be put in without another meaning. Elements are changed."""
    if not includes:
        return xml_text(data)
    if any(one != other and min(one, other) < MODERN for one, other in (i.versions for i in includes)):
        return ""
    if any(
        i.merged or i.element.getparent() is None or _is_alone(i.element, root) or _is_dressed(i.element)
        for i in includes
    ):
        return ""
    for included in reversed(includes):  # the inner ones are later
        _put_in(included)
    for element in root.iter():
        element.attrib.pop(FILE, None)
    etree.cleanup_namespaces(root)
    return str(etree.tostring(root, encoding="unicode"))


def _is_alone(element: Element, root: Element) -> bool:
    """Whether a model in its place would be alone in its file, which gives its names no prefix."""
    worlds = [child for child in root if tag_of(child) == "world"]
    return element.getparent() is root and not worlds and sum(tag_of(c) in ("model", "include") for c in root) == 1


def _is_dressed(element: Element) -> bool:
    """Whether an include says more than where the model is: parameters of its elements, plugins."""
    return any(tag_of(child) not in ("uri", "name", "placement_frame", *_OVER) for child in element)


def _put_in(included: Included) -> None:
    model = copy.deepcopy(included.model)
    model.set("name", included.name)
    for child in included.element:
        tag = tag_of(child)
        if tag in _OVER:
            for old in [old for old in model if tag_of(old) == tag]:
                model.remove(old)
            model.insert(0, copy.deepcopy(child))
        elif tag == "placement_frame" and (child.text or "").strip():
            model.set("placement_frame", child.text.strip())
    outer, inner = (folder.resolve() for folder in included.folders)
    folder = Path(os.path.relpath(inner, outer)).as_posix()
    for mesh in model.iter("uri", "filename"):
        stated = (mesh.text or "").strip()
        if stated and folder != "." and not re.match(r"[a-z]+:|/", stated):
            mesh.text = f"{folder}/{stated}"
    model.tail = included.element.tail
    included.element.getparent().replace(included.element, model)
