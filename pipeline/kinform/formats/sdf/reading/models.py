"""The models of an SDF, nested and included, as a flat list, each with the prefix of its names and its frame.

`<include>` of `model://NAME`, of a folder with a model.config, or of a file; only where the description may read, and
at most so deep in each other.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote

import numpy as np

from kinform.form.constants import FILES_DEEP
from kinform.formats.description.elements import FILE, Element, Xml, parse_xml, tag_of
from kinform.formats.description.mesh_files import MeshFiles
from kinform.formats.description.tree import Count
from kinform.formats.sdf.reading.frames import MODEL, WORLD, Frame, Frames
from kinform.formats.sdf.reading.text import Included
from kinform.formats.sdf.reading.values import Values
from kinform.foundation.boundary import OUTSIDE, OUTSIDE_REMEDY
from kinform.foundation.name_hints import in_quotes
from kinform.frozen import dataclass

SDF_MODELS = 2000
"""Models of an SDF, included ones too, beyond which no include is read: files that include each other twice, thirty
deep, never end. Chosen, not measured."""


SCENERY = ("sun", "ground_plane")
"""Models of Gazebo that nearly every world includes."""


@dataclass(frozen=True, eq=False)
class Model:
    """A model: the prefix of the names in it ("arm::"), its element, the folder and the version of its file."""

    scope: str
    element: Element
    folder: Path
    version: tuple[int, ...]
    static: bool
    home: str = MODEL
    """The frame in which its links stand: its own, or of one that is merged the frame where that is put."""


@dataclass(frozen=True)
class _Here:
    """Where models are stated: the prefix of their names, and what holds for their file."""

    scope: str
    folder: Path
    version: tuple[int, ...]
    above: tuple[Path, ...]
    """The files that include each other up to here."""
    static: bool = False
    home: str = MODEL
    """As `Model.home`."""


class Models:
    """Collects models, and the frames that they state."""

    def __init__(self, xml: Xml, meshes: MeshFiles, frames: Frames, left: Count):
        self._xml, self._meshes, self._frames, self._left = xml, meshes, frames, left
        self._values = Values(xml)
        self.models: list[Model] = []
        self.files: list[Path] = []
        self.included: list[Included] = []
        """The outer before the inner."""
        self._full = False

    def collect(self, root: Element, path: Path) -> None:
        """All models of a file."""
        here = _Here(WORLD, path.parent, version_of(root), (path.resolve(),))
        worlds = list(self._xml.children(root, "world"))
        for element in (root, *worlds):
            for child in self._xml.children(element, "frame"):
                self._frame(child, WORLD, WORLD)
            self._below(element, here, alone=not worlds)

    def _below(self, element: Element, here: _Here, alone: bool = False) -> None:
        """The models in an element; one that is alone in its file gives no prefix."""
        models = list(self._xml.children(element, "model", "include"))
        single = alone and len(models) == 1 and tag_of(models[0]) == "model"
        taken: dict[str, Element] = {}
        for child in models:
            if tag_of(child) == "include":
                self._include(child, here, taken)
                continue
            name = self._values.name(child)
            if name is not None and self._is_new(name, child, taken):
                inner = WORLD if single else f"{here.scope}{name}::"
                self._model(child, child, name, here, replace(here, scope=inner, home=MODEL))

    def _is_new(self, name: str, element: Element, taken: dict[str, Element]) -> bool:
        if name in taken:
            first = self._xml.at(taken[name]).line
            message = f"two models are named {in_quotes(name)}: the first is at line {first}"
            self._xml.complain(element, message, "rename one of them")
            return False
        taken[name] = element
        return True

    def _model(self, element: Element, placed: Element, name: str, here: _Here, inside: _Here) -> None:
        """A model, and what holds in it; `placed` is what states its pose: itself, or an include."""
        scope, inner = here.scope, inside.scope
        values, xml = self._values, self._xml
        X, relative = values.pose(placed if xml.child(placed, "pose") is not None else element)
        frame = values.text(placed, "placement_frame") or element.get("placement_frame")
        first = xml.child(element, "link")
        first = xml.child(element, "model", "include") if first is None else first
        canonical = (element.get("canonical_link") or ("" if first is None else first.get("name") or "")).strip()
        attached = inner.removeprefix(scope) + canonical if canonical else None
        relative = relative or (here.home if inner else WORLD)
        self._frames.add(inner + MODEL, Frame(scope, relative, X, placed, attached, frame))
        if inner:
            self._frames.add(scope + name, Frame(scope, f"{name}::{MODEL}", np.eye(4), placed, f"{name}::{MODEL}"))
        held = here.static or values.true(element, "static") or values.true(placed, "static")
        self.models.append(Model(inner, element, inside.folder, inside.version, held))
        for child in xml.children(element, "frame"):
            self._frame(child, inner, MODEL)
        self._below(element, replace(inside, static=held))

    def _frame(self, element: Element, scope: str, otherwise: str) -> None:
        name = self._values.name(element)
        if name is None:
            return
        X, relative = self._values.pose(element)
        attached = (element.get("attached_to") or otherwise).strip()
        self._frames.add(scope + name, Frame(scope, relative or attached, X, element, attached))

    def _include(self, element: Element, here: _Here, taken: dict[str, Element]) -> None:
        xml = self._xml
        uri = self._values.text(element, "uri")
        if uri is None:
            xml.complain(element, "<include> has no <uri>", "add <uri>model://NAME</uri>")
            return
        if self._is_scenery(uri):
            self._left.add(f"<include> of {uri}")
            return
        path = self._file(element, uri, here.folder) if len(self.models) < SDF_MODELS else None
        if path is None:
            if len(self.models) == SDF_MODELS and not self._full:
                self._full = True
                wrong = f"has more than {SDF_MODELS:,} models, with those that are included"
                xml.complain(element, wrong, "divide it, or remove includes")
            return
        if path.resolve() in here.above or len(here.above) > FILES_DEEP:
            xml.complain(element, f"the include {in_quotes(uri)} includes itself", "remove one of the includes")
            return
        shown = _shown(path, self._meshes.folder, Path(xml.file).parent)
        data = xml.content(element, path, self._meshes.boundary)
        root = None if data is None else parse_xml(data, shown, xml.problems)
        self.files.append(path)
        if root is None:
            return
        root.set(FILE, shown)
        models = list(xml.children(root, "model"))
        if tag_of(root) != "sdf" or len(models) != 1:
            xml.complain(
                element, f"the include {in_quotes(uri)} is no SDF with one model", "include an SDF of one model"
            )
            return
        merged = element.get("merge", "false").strip().lower() in ("1", "true")
        name = (self._values.text(element, "name") or models[0].get("name") or "").strip().replace("/", "_")
        if not name or "::" in name:
            xml.complain(element, f"the include {in_quotes(uri)} gives no name that a model can have", "add <name>")
        elif self._is_new(name, element, taken):
            above = (*here.above, path.resolve())
            inside = _Here(f"{here.scope}{name}::", path.parent, version_of(root), above)
            versions = here.version, inside.version
            self.included.append(Included(element, models[0], name, (here.folder, path.parent), versions, merged))
            if merged:
                self._merge(models[0], element, name, here, inside)
            else:
                self._model(models[0], element, name, here, inside)

    def _merge(self, model: Element, element: Element, name: str, here: _Here, inside: _Here) -> None:
        """What a model holds, as if it stood in the one around the include; its frame is `_merged__NAME__model__`."""
        xml, values, scope = self._xml, self._values, here.scope
        around = element.getparent()
        if around is None or tag_of(around) != "model":
            xml.complain(element, "<include merge> stands in no model", "remove merge, or put it in a model")
            return
        placed = values.text(element, "placement_frame") or model.get("placement_frame")
        if placed or any(MODEL in (*e.attrib.values(), (e.text or "").strip()) for e in model.iter() if e is not model):
            what = "has a placement_frame" if placed else f"names the frame {MODEL}"
            xml.complain(element, f"<include merge> of a model that {what} is not read", "include it as a nested model")
            return
        X, relative = values.pose(element if xml.child(element, "pose") is not None else model)
        first = xml.child(model, "link")
        canonical = (model.get("canonical_link") or ("" if first is None else first.get("name") or "")).strip()
        home = f"_merged__{name}{MODEL}"
        self._frames.add(scope + home, Frame(scope, relative or here.home, X, element, canonical or None))
        self.models.append(Model(scope, model, inside.folder, inside.version, here.static, home))
        for child in xml.children(model, "frame"):
            self._frame(child, scope, home)
        self._below(model, replace(inside, scope=scope, static=here.static, home=home))

    def _is_scenery(self, uri: str) -> bool:
        """Whether an include is of a model of Gazebo's own that is not here, and in which nothing is that is read: a
        light, an endless plane."""
        name = unquote(uri).rstrip("/").rpartition("/")[2].lower().replace(" ", "_")
        known = uri.startswith("model://") and self._meshes.package(name) is not None
        return name in SCENERY and "://" in uri and not uri.startswith("file://") and not known

    def _file(self, element: Element, uri: str, folder: Path) -> Path | None:
        """The SDF that an include names; None after noting why there is none."""
        match = re.fullmatch(r"(?:model|package)://([^/]+)/?(.*)", uri)
        if match is None and "://" in uri and not uri.startswith("file://"):
            self._xml.complain(element, f"the include {in_quotes(uri)} is no file", "fetch it, and name a file")
            return None
        if match is not None:
            package = self._meshes.package(match[1])
            if package is None:
                message = f"the include {in_quotes(uri)} is not found: no folder {match[1]} is known"
                self._xml.complain(element, message, f"add --package {match[1]}=FOLDER, or set ROS_PACKAGE_PATH")
                return None
            path = package / match[2]
        else:
            path = folder / uri.removeprefix("file://")
            named = re.fullmatch(r"[\w.-]+", uri) and not (
                self._meshes.boundary.is_file(path) or self._meshes.boundary.is_folder(path)
            )
            path = (self._meshes.package(uri) or path) if named else path  # a name is that of a model
        path = self._in_folder(path) if self._meshes.boundary.is_folder(path) else path
        if not self._meshes.boundary.allows(path):
            self._xml.complain(element, f"the include {in_quotes(uri)} {OUTSIDE}", OUTSIDE_REMEDY)
            return None
        if not self._meshes.boundary.is_file(path):
            self._xml.complain(
                element, f"the include {in_quotes(uri)} does not exist", f"there is no {path.name} there"
            )
            return None
        return path

    def _in_folder(self, folder: Path) -> Path:
        """The SDF that model.config of a folder names last, else model.sdf."""
        try:
            config = self._meshes.boundary.read(folder / "model.config")
        except OSError:
            config = b""
        names = re.findall(rb"<sdf[^>]*>([^<]+)</sdf>", config)
        path = folder / (names[-1].decode("utf-8", "replace").strip() if names else "model.sdf")
        return path if path.resolve().is_relative_to(folder.resolve()) else folder / "model.sdf"


def version_of(root: Element) -> tuple[int, ...]:
    """The version of SDF that a file states; the newest where it states none."""
    numbers = re.findall(r"\d+", root.get("version", ""))
    return tuple(int(n[:6]) for n in numbers[:2]) or (1, 11)


def _shown(path: Path, folder: Path, prefix: Path) -> str:
    """An included file as messages show it: beside the description as that is shown, else by its name."""
    try:
        return (prefix / path.resolve().relative_to(folder.resolve())).as_posix()
    except ValueError:
        return f"{path.parent.name}/{path.name}"
