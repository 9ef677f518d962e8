"""What an MJCF says once for many elements: includes, compiler settings, default classes, mesh assets."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from kinform.form.constants import FILES_DEEP, FRAME_ROUNDING
from kinform.form.problems import Problems
from kinform.formats.description.elements import FILE, Element, Xml, parse_xml, tag_of
from kinform.formats.description.mesh_files import MeshFiles
from kinform.formats.description.poses import about, pose, quaternion, turn
from kinform.formats.mjcf.reading.fits import INERTIAS
from kinform.foundation.boundary import OUTSIDE, OUTSIDE_REMEDY
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.frozen import dataclass
from kinform.model.arrays import Array


class Includes:
    """Puts the elements of included files in the place of `<include>`; each file at most once, as MuJoCo has it. What
    they name is looked for beside the description first, then beside themselves."""

    def __init__(self, path: Path, xml: Xml, meshes: MeshFiles):
        self._xml, self._meshes = xml, meshes
        self._top, self._seen = path, {path.resolve()}
        self._shown = {xml.file: path}
        self.files: list[Path] = []

    def expand(self, element: Element) -> None:
        """All includes below an element."""
        for child in list(element):
            if isinstance(child.tag, str) and tag_of(child) == "include":
                self._include(child)
            elif isinstance(child.tag, str):
                self.expand(child)

    def find_meshes(self, root: Element, folder: str) -> None:
        """Meshes of included files that are not where those of the description are, but beside the file that names
        them, as seen from the folder of meshes."""
        if not self.files:
            return
        below = self._top.parent / folder
        for element in (e for assets in self._xml.children(root, "asset") for e in self._xml.children(assets, "mesh")):
            name, here = (element.get("file") or "").replace("\\", "/"), Path(self._xml.at(element).file).parent
            beside = os.path.relpath(here, Path(self._xml.file).parent)
            if name and "://" not in name and beside != "." and not self._meshes.boundary.is_file(below / name):
                path = Path(beside) / name
                if self._meshes.boundary.is_file(below / path):
                    element.set("file", path.as_posix())

    def _include(self, element: Element) -> None:
        name = element.get("file") or ""
        path = self._top.parent / name
        shown = Path(self._xml.file).parent / name
        from_file = self._xml.at(element).file
        beside = self._shown[from_file].parent / name
        if name and not self._meshes.boundary.is_file(path) and self._meshes.boundary.is_file(beside):
            path, shown = beside, Path(from_file).parent / name
        if not self._meshes.boundary.allows(path):
            self._xml.complain(element, f"the include {in_quotes(name)} {OUTSIDE}", OUTSIDE_REMEDY)
        elif not name or not self._meshes.boundary.is_file(path):
            self._xml.complain(element, f"the include {in_quotes(name)} does not exist", "correct its file")
        elif path.resolve() in self._seen or len(self._seen) > FILES_DEEP:
            message = f"the file {in_quotes(name)} is included twice, or includes itself"
            self._xml.complain(element, message, "remove one of the includes")
        else:
            self._seen.add(path.resolve())
            self.files.append(path)
            self._shown[shown.as_posix()] = path
            data = self._xml.content(element, path, self._meshes.boundary)
            root = None if data is None else parse_xml(data, shown.as_posix(), self._xml.problems)
            for child in [] if root is None else list(root):
                child.set(FILE, shown.as_posix())
                element.addprevious(child)
                if tag_of(child) == "include":
                    self._include(child)
                else:
                    self.expand(child)
        element.getparent().remove(element)


ORIENTATIONS = ("quat", "euler", "axisangle", "xyaxes", "zaxis")
"""Attributes that state a rotation, of which an element has one."""


_DIRECTIONS = {"quat": "a quaternion that is not zero", "axisangle": "an axis that is not zero",
               "xyaxes": "two axes that are not parallel", "zaxis": "an axis that is not zero"}  # fmt: skip


def _turns(key: str, values: tuple[float, ...]) -> bool:
    """Whether these numbers of an orientation state one."""
    if key == "xyaxes":
        return float(np.linalg.norm(np.cross(values[:3], values[3:]))) > 0.0
    return any(values[:3] if key == "axisangle" else values)


ACTUATOR = "general"
ACTUATORS = ("general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion")
"""Actuators, which have one default among them."""
_KINDS = ("mesh", "material", "joint", "geom", "site", "camera", "light", "pair", "equality", "tendon", ACTUATOR)
"""What has defaults."""


@dataclass(frozen=True)
class Compiler:
    """`<compiler>`: units of angles, the sequence of Euler angles, folders of assets."""

    degrees: bool = True
    sequence: str = "xyz"
    folder: str = ""
    autolimits: bool = True
    strip: bool = False
    from_geometry: bool = False
    fit_around: bool = False
    """Primitives are fitted to the boxes around meshes."""
    inertia: str = INERTIAS[0]
    """Of meshes that state no other way to it."""

    @staticmethod
    def of(xml: Xml, root: Element) -> Compiler:
        """The settings of all `<compiler>` elements, the later ones over the earlier."""
        said: dict[str, str] = {}
        for element in xml.children(root, "compiler"):
            said |= element.attrib
            if set(element.get("eulerseq", "xyz")) - set("xyzXYZ"):
                xml.complain(element, "eulerseq has other letters than x, y, z", 'give eulerseq="xyz"')
                said.pop("eulerseq")
            if element.get("angle", "degree") not in ("degree", "radian"):
                wrong = f"angle cannot be {in_quotes(element.get('angle'))}"
                xml.complain(element, wrong, 'give angle="degree" or angle="radian"')
                said.pop("angle")
            if element.get("coordinate", "local") != "local":
                xml.complain(element, "coordinate is \"global\", which MuJoCo reads no more since version 2.3.4",
                             "load it in MuJoCo 2.3.3, and save it: that gives local coordinates")  # fmt: skip
        sequence = said.get("eulerseq", "xyz")
        return Compiler(
            degrees=said.get("angle", "degree") == "degree",
            sequence=sequence if len(sequence) == 3 else "xyz",
            folder=said.get("meshdir", said.get("assetdir", "")).replace("\\", "/"),
            autolimits=said.get("autolimits", "true") == "true",
            strip=said.get("strippath", "false") == "true",
            from_geometry=said.get("inertiafromgeom", "auto") == "true",
            fit_around=said.get("fitaabb", "false") == "true",
            inertia="exact" if said.get("exactmeshinertia", "false") == "true" else INERTIAS[0],
        )

    def radians(self, angle: float) -> float:
        """An angle of the file."""
        return math.radians(angle) if self.degrees else angle

    def rotation(self, xml: Xml, element: Element, said: Mapping[str, str]) -> Array:
        """The rotation (3, 3) that an element states in one of five ways; the identity where it states none."""

        def numbers(key: str, count: int) -> tuple[float, ...] | None:
            values = xml.numbers(element, said[key], key, count) if key in said else None
            if values is not None and key in _DIRECTIONS and not _turns(key, values):
                wrong = f"<{tag_of(element)}>: {key} has {in_quotes(said[key])}, which states no rotation"
                xml.complain(element, wrong, f"give {_DIRECTIONS[key]}")
            return values

        if (q := numbers("quat", 4)) is not None:
            return quaternion(q)
        if (e := numbers("euler", 3)) is not None:
            out = np.eye(3)
            for letter, angle in zip(self.sequence, e, strict=True):
                step = turn(letter.lower(), self.radians(angle))
                out = out @ step if letter.islower() else step @ out
            return out
        if (a := numbers("axisangle", 4)) is not None:
            return about(a[:3], self.radians(a[3]))
        if (b := numbers("xyaxes", 6)) is not None:
            x = np.array(b[:3]) / (np.linalg.norm(b[:3]) or 1.0)
            y = np.array(b[3:]) - x * (x @ np.array(b[3:]))
            y /= np.linalg.norm(y) or 1.0
            return np.column_stack([x, y, np.cross(x, y)])
        if (z := numbers("zaxis", 3)) is not None:
            return from_z(np.array(z))
        return np.eye(3)

    def pose(self, xml: Xml, element: Element, said: Mapping[str, str]) -> Array:
        """The pose (4, 4) of an element in the one around it."""
        position = xml.numbers(element, said["pos"], "pos", 3) if "pos" in said else None
        return pose(self.rotation(xml, element, said), position or (0.0, 0.0, 0.0))


def from_z(direction: Array) -> Array:
    """The least rotation (3, 3) that takes z to a direction."""
    size = float(np.linalg.norm(direction))
    if size == 0.0:
        return np.eye(3)
    z = direction / size
    axis = np.cross([0.0, 0.0, 1.0], z)
    sine = float(np.linalg.norm(axis))
    if sine < 1e-15:  # mjMINVAL, as MuJoCo has it
        return np.eye(3) if z[2] > 0.0 else np.diag([1.0, -1.0, -1.0])
    return about(tuple(axis), math.atan2(sine, float(z[2])))


class Defaults:
    """Default classes: what elements of a kind are taken to say, by class."""

    def __init__(self, xml: Xml, root: Element):
        self._of: dict[str, dict[str, dict[str, str]]] = {"main": {}}
        self._xml = xml
        for top in xml.children(root, "default"):
            self._read(top, "main", {})

    def _read(self, element: Element, name: str, above: Mapping[str, dict[str, str]]) -> None:
        own = {**self._of.get(name, {}), **above}
        for child in self._xml.children(element):
            kind = ACTUATOR if tag_of(child) in ACTUATORS else tag_of(child)
            if kind in _KINDS:
                own[kind] = _over(own.get(kind, {}), child.attrib)
        self._of[name] = own
        for child in self._xml.children(element, "default"):
            self._read(child, child.get("class") or name, own)

    def said(self, element: Element, inherited: str | None, kind: str | None = None) -> dict[str, str]:
        """The attributes of an element over those of its class, which is that of the body where it names none; `kind`
        is what the class calls such elements, if not by their tag."""
        name = element.get("class") or inherited or "main"
        if name not in self._of:
            self._xml.complain(element, f"there is no default class {in_quotes(name)}", "define it, or correct it")
            name = "main"
        return _over(self._of[name].get(kind or tag_of(element), {}), element.attrib)


def _over(below: Mapping[str, str], said: Mapping[str, str]) -> dict[str, str]:
    """The attributes of a class under those that are stated over it: there is one orientation, which is stated last."""
    turned = any(key in said for key in ORIENTATIONS)
    return {key: value for key, value in below.items() if not (turned and key in ORIENTATIONS)} | dict(said)


@dataclass(frozen=True)
class MeshAsset:
    """A mesh: its file as stated, its scale, and the pose (4, 4) of what is scaled; None where no pose gives it."""

    file: str
    scale: tuple[float, float, float]
    X: Array | None
    inertia: str
    """The way to its inertia, in MuJoCo's words."""
    element: Element


def mesh_assets(xml: Xml, root: Element, compiler: Compiler, defaults: Defaults) -> dict[str, MeshAsset]:
    """The mesh assets by name; the name of one that has none is that of its file."""
    out = {}
    for element in (mesh for assets in xml.children(root, "asset") for mesh in xml.children(assets, "mesh")):
        said = defaults.said(element, None)
        file = (said.get("file") or "").replace("\\", "/")
        name = said.get("name") or Path(file).stem
        scale = xml.numbers(element, said.get("scale", "1 1 1"), "scale", 3) or (1.0, 1.0, 1.0)
        if 0.0 in scale:
            xml.complain(element, f"mesh {in_quotes(name)}: its scale has a zero", 'give scale="1 1 1"')
            scale = (1.0, 1.0, 1.0)
        position = xml.numbers(element, said.get("refpos", "0 0 0"), "refpos", 3) or (0.0, 0.0, 0.0)
        turned = xml.numbers(element, said.get("refquat", "1 0 0 0"), "refquat", 4) or (1.0, 0.0, 0.0, 0.0)
        along, X = _scale_and_pose(scale, turned, position)
        x, y, z = map(float, along)
        inertia = said.get("inertia", compiler.inertia)
        if inertia not in INERTIAS:
            wrong = f"mesh {in_quotes(name)}: inertia {in_quotes(inertia)} is not known"
            xml.complain(element, wrong, did_you_mean(inertia, INERTIAS, "the ways"))
            inertia = compiler.inertia
        out[name] = MeshAsset(Path(file).name if compiler.strip else file, (x, y, z), X, inertia, element)
    return out


@lru_cache(maxsize=256)
def _scale_and_pose(
    stated: tuple[float, ...], turned: tuple[float, ...], position: tuple[float, ...]
) -> tuple[Array, Array | None]:
    """MuJoCo scales along the axes of the reference frame, whose pose is R, p: its vertices are diag(s)·Rᵀ·(v − p). As
    a scale (3,) along the axes of the mesh and a pose (4, 4) then; no pose where the mesh is sheared, or scaled to
    nothing."""
    scale, R, p = np.array(stated), quaternion(turned), np.array(position)
    M = scale[:, None] * R.T
    along = np.linalg.norm(M, axis=0)
    if not (np.outer(along, along) > 0.0).all():
        return scale, None
    cosines = (M.T @ M) / np.outer(along, along)
    if float(np.abs(cosines - np.eye(3)).max()) > FRAME_ROUNDING:
        return scale, None
    first = along * np.sign(scale)
    return first, pose(M / first, -M @ p)


def elements(root: Any, tag: str) -> Iterator[tuple[Any, str | None]]:
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


def ranges_of(
    root: Any, joint: str, bounds: tuple[float, float], *, slides: bool
) -> Iterator[tuple[Any, tuple[float, float]]]:
    """The elements of a joint, each with the range (rad or m, 0 at the pose of the file) in the units of the file."""
    xml = Xml("", Problems())
    compiler, defaults = Compiler.of(xml, root), Defaults(xml, root)
    unit = 1.0 if slides or not compiler.degrees else math.pi / 180.0
    for element, named in elements(root, "joint"):
        said = defaults.said(element, named)
        if (said.get("name") or "").replace("/", "_") == joint:
            ref = float(said.get("ref", "0"))
            yield element, (bounds[0] / unit + ref, bounds[1] / unit + ref)
