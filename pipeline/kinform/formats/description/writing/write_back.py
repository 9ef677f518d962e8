"""The robot description that a design was read from, written back: names, frames and everything that was not touched.

The text is the one that was read (macros expanded, includes put in), comments and unknown elements with it. Written
into it are ranges and masses that a manifest states over the description, on request masses and inertias of the
geometry, and where its meshes lie, seen from the new place. A text in which nothing changes is given byte for byte.
What a manifest says over it besides is named as lost.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from lxml import etree

from kinform.design import Design
from kinform.exports.exported import Exported
from kinform.form.problems import Problems
from kinform.formats.description.elements import xml_bytes
from kinform.formats.description.mesh_files import Found, MeshFiles
from kinform.formats.description.robot import At, Inertial, Robot, RobotJoint
from kinform.formats.registry import WRITTEN, edits_of, reader_of_text
from kinform.foundation.boundary import Boundary
from kinform.foundation.rounding import SOLVED
from kinform.frozen import dataclass
from kinform.mass.shapes import solid_of
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part
from kinform.model.descriptions import DescribedLink, Description
from kinform.model.function import IntendedJoint

_BEFORE = re.compile(r"(?:\s|<\?.*?\?>|<!--.*?-->|<!DOCTYPE[^>\[]*>)*", re.DOTALL)


def description_of(design: Design, format: str) -> Description | None:
    """The description of that format that the whole design was read from; None where there is none."""
    own = [d for d in design.assembly.descriptions if not d.prefix]
    return own[0] if len(own) == 1 and own[0].format == format and own[0].text else None


def export(design: Design, format: str, *, inertia: bool = False, folder: str | None = None) -> Exported:
    """NAME.urdf, NAME.sdf or NAME.xml.

    `inertia`: of the geometry; `folder`: that of the description as seen from the new place. Raises LookupError where
    `description_of` gives none.
    """
    description = description_of(design, format)
    if description is None:
        raise LookupError(f"the design was not read from a description of the format {format}")
    robot = _read(description)
    changes = _Changes(design.assembly, description, robot)
    masses, left = _masses(design, description, robot, inertia=inertia)
    ranges = dict(changes.ranges())
    text = _Text(description, edits_of(format))
    for joint, bounds in ranges.items():
        text.module.write_range(text.root, robot, joint, bounds)
    for link, stated in masses.items():
        text.module.write_inertial(text.root, link, stated)
    if folder not in (None, "", "."):
        text.module.write_folder(text.root, folder)
    changed = bool(ranges or masses or folder not in (None, "", "."))
    ending = WRITTEN[format].ending
    name = Path(description.file).name.removesuffix(".xacro")
    name = name if name.endswith(ending) else Path(name).stem + ending
    data = text.data() if changed else xml_bytes(description.text)
    remarks = [f"the description as it was read, with {len(ranges)} ranges and {len(masses)} inertias written into it"]
    if folder is None:
        remarks.append("paths of meshes are as in the source: they are right in its folder")
    return Exported({name: data}, (*changes.lost(), *left), tuple(remarks))


def _read(description: Description) -> Robot:
    """The robot of the text, by its reader; meshes need not be there. What else it names is read only where the working
    folder may."""
    read = reader_of_text(description.format)
    data, path = xml_bytes(description.text), Path(description.file)
    problems = Problems()
    robot = read(path, data, description.file, problems, _Named(path, {}, boundary=Boundary(Path(path.name))))
    problems.raise_if_any()
    assert robot is not None
    return robot


class _Named(MeshFiles):
    """Paths as they are stated."""

    def find(self, stated: str, folder: Path | None = None) -> Found:
        """The name of a file, wherever it lies."""
        return Found((folder or self.folder) / stated)


class _Text:
    """The XML of a description, with its comments."""

    def __init__(self, description: Description, module: Any):
        parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, recover=True)
        self.root = etree.fromstring(xml_bytes(description.text), parser)
        self.module = module
        match = _BEFORE.match(description.text)
        self._before = match[0] if match else ""

    def data(self) -> bytes:
        """As it is written: what stands before the root as it stood."""
        return xml_bytes(self._before + etree.tostring(self.root, encoding="unicode", with_tail=False) + "\n")


@dataclass(frozen=True, eq=False)
class _Changes:
    """What the design says otherwise than its description."""

    assembly: Assembly
    description: Description
    robot: Robot

    def _pairs(self) -> Iterator[tuple[IntendedJoint, RobotJoint]]:
        was = {joint.name: joint for joint in self.robot.joints}
        return ((joint, was[joint.name]) for joint in self.assembly.function.joints if joint.name in was)

    def ranges(self) -> Iterator[tuple[str, tuple[float, float]]]:
        """Joints whose range a manifest states otherwise, with that range (rad or m)."""
        for joint, was in self._pairs():
            if joint.range is not None and not _same(joint.range, was.range) and all(map(math.isfinite, joint.range)):
                yield joint.name, joint.range

    def lost(self) -> Iterator[str]:
        """What is not written back, in sentences."""
        was = {joint.name for joint in self.robot.joints}
        for joint in self.assembly.function.joints:
            if joint.name not in was:
                yield f"joint {joint.name}: the description has no such joint"
        for joint, other in self._pairs():
            place = ("type" if joint.type != other.type else "", "axis" if not _same(joint.axis, other.axis) else "",
                     "point" if not _same(joint.point, other.point) else "")  # fmt: skip
            if any(place):
                yield f"joint {joint.name}: its {' and '.join(filter(None, place))} as the manifest over it says"
            open_ended = joint.range is not None and not all(map(math.isfinite, joint.range))
            if open_ended and not _same(joint.range, other.range):
                yield f"joint {joint.name}: a range that is free on one side"
        known = {name for link in self.description.links for name in link.parts}
        for part in self.assembly.parts:
            if part.name not in known:
                yield f"part {part.name}: the description has no such geometry"


def _same(a: Any, b: Any) -> bool:
    if a is None or b is None:
        return a is b
    first, second = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
    scale = max(float(np.abs(second[np.isfinite(second)]).max(initial=0.0)), 1e-3)
    other = first != second  # of two infinities there is no difference
    return bool((np.abs(first[other] - second[other]) <= SOLVED * scale).all())


def _masses(
    design: Design, description: Description, robot: Robot, *, inertia: bool
) -> tuple[dict[str, Inertial], list[str]]:
    """What is to be written of links, in their own frames; and what could not be."""
    assembly = design.assembly
    stated = {str(group.name): group.override for group in assembly.groups if group.override is not None}
    stated |= {str(part.name): part.override for part in assembly.parts if part.mesh is None and part.override}
    was = {link.name: link.inertial for link in robot.links}
    out: dict[str, Inertial] = {}
    left: list[str] = []
    by_name = {str(part.name): part for part in assembly.parts}
    for link in description.links:
        parts = [by_name[name] for name in link.parts if name in by_name and by_name[name].mesh is not None]
        override = stated.get(link.name)
        if inertia and parts:
            made = _of_geometry(design, link, parts, None if override is None else override.mass)
            if isinstance(made, str):
                left.append(f"link {link.name}: {made}: its inertia is left as it was")
            else:
                out[link.name] = made
        elif override is not None and parts:
            other = was.get(link.name)
            now = (override.mass, *override.centre_of_mass, *override.inertia.ravel())
            before = None if other is None else (other.mass, *other.centre, *other.inertia.ravel())
            if before is None or not np.allclose(now, before, rtol=SOLVED, atol=1e-15):
                out[link.name] = _in_link(link, override.mass, override.centre_of_mass, override.inertia)
    return out, left


def _of_geometry(design: Design, link: DescribedLink, parts: list[Part], mass: float | None) -> Inertial | str:
    """The inertial of the shapes of a link: at their densities where all have one, else of the stated mass, spread
    evenly; the reason where neither can be."""
    known = {p.name: p for p in design.mass.parts if p.mass is not None} if design.mass is not None else {}
    if all(part.density is not None and part.name in known for part in parts):
        own = [known[part.name] for part in parts]
        total = math.fsum(p.mass or 0.0 for p in own)
        centre = np.sum([(p.mass or 0.0) * p.centre_of_mass for p in own], axis=0) / total
        inertia = np.zeros((3, 3))
        for p in own:
            away = p.centre_of_mass - centre
            inertia += p.inertia + (p.mass or 0.0) * (away @ away * np.eye(3) - np.outer(away, away))
        return _in_link(link, total, centre, inertia)
    solid = solid_of(parts)
    if solid is None or solid.open_parts:
        names = ", ".join(solid.open_parts if solid is not None else (str(part.name) for part in parts))
        return f"{names} enclose{'s' if names.count(',') == 0 else ''} no volume"
    if mass is None:
        return "it states no mass, and its parts have no density"
    return _in_link(link, mass, solid.centroid, solid.inertia * (mass / solid.volume))


def _in_link(link: DescribedLink, mass: float, centre: Array, inertia: Array) -> Inertial:
    """World values in the frame of the link."""
    R = link.rotation
    turned = R.T @ inertia @ R
    return Inertial(float(mass), R.T @ (centre - link.position), 0.5 * (turned + turned.T), At("", 1))
