"""What edits of the XML formats have in common: elements made where there are none, numbers and paths as text."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterable
from typing import Any

from lxml import etree

from kinform.formats.description.elements import tag_of
from kinform.model.arrays import Array

_INERTIA = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
_ELSEWHERE = re.compile(r"[a-z]+:|/")
"""How paths begin that do not depend on where the file is: schemes such as package://, and absolute ones."""


def name_of(element: Any) -> str:
    """The name of an element as readers give it."""
    return (element.get("name") or "").strip().replace("/", "_")


def child_of(element: Any, tag: str) -> Any:
    """The first child with that name, made where there is none."""
    found = next((child for child in element if tag_of(child) == tag), None)
    return etree.SubElement(element, tag) if found is None else found


def numbers(values: Iterable[float]) -> str:
    """Numbers as text that reads back as the same doubles, with blanks between."""
    return " ".join(repr(float(value)) for value in values)


def inertia_numbers(inertia: Array) -> Iterable[tuple[str, str]]:
    """The six numbers of an inertia matrix (3, 3) as text, with their names in URDF and SDF."""
    return ((key, repr(float(inertia[at]))) for key, at in _INERTIA.items())


def moved(path: str, folder: str) -> str | None:
    """A path that began in `folder`, as seen from the new place; None where it is absolute, a URI, or empty."""
    stated = path.strip()
    return posixpath.normpath(posixpath.join(folder, stated)) if stated and not _ELSEWHERE.match(stated) else None
