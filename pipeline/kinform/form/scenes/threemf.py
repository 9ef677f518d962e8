"""3MF: objects with meshes, objects of components, and the items of the build, in the unit that the file states.

Read here, not by trimesh, which needs networkx for it, drops the hierarchy, and leaves out what it does not find.
"""

from __future__ import annotations

import io
import re
import zipfile
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from kinform.form.constants import (
    ATTRIBUTE_BYTES,
    ELEMENT_BYTES,
    PARTS_MOST,
    TREE_FREELY,
    TREE_TIMES,
    UNPACKED_BYTES,
    UNPACKED_FREELY,
    UNPACKED_TIMES,
)
from kinform.form.meshes.digits import written_step
from kinform.form.meshes.raw import Fault, MeshError, RawMesh, is_coordinate, prevailing
from kinform.form.scenes.declarations import refuse_declarations
from kinform.form.scenes.scene import EXPORT, SCENE_DEEP, Node, Scene
from kinform.form.sources import AS_IT_IS, Reading
from kinform.foundation.name_hints import in_quotes
from kinform.foundation.words import counted
from kinform.model.arrays import Array

if TYPE_CHECKING:
    from pathlib import Path

_UNITS = {"micron": "um", "millimeter": "mm", "centimeter": "cm", "inch": "in", "foot": "ft", "meter": "m"}
_CORE = "http://schemas.microsoft.com/3dmanufacturing/core/"
_KNOWN = ("/material/", "/production/", "/core/")
"""What the name spaces of extensions contain that do not change where anything is, or that are read."""
_PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""The methods of packing that 3MF has. Others unpack slowly, or with gigabytes of memory."""
_HEX = re.compile(r"#[0-9A-Fa-f]{6}([0-9A-Fa-f]{2})?")
_Key = tuple[str, str]
"""The file in the archive, and the number of an object in it."""


def read_3mf(data: bytes, path: Path, reading: Reading = AS_IT_IS) -> Scene:
    """The scene of a file. Raises MeshError."""
    try:
        archive = zipfile.ZipFile(io.BytesIO(data))
    except zipfile.BadZipFile:
        raise MeshError([Fault("is no 3MF: it is no zip archive, or cut short", EXPORT)]) from None
    with archive:
        return _Reader(archive, len(data)).scene()


class _Reader:
    def __init__(self, archive: zipfile.ZipFile, packed: int):
        self.archive = archive
        self.names = {f"/{name.lstrip('/')}".lower(): name for name in archive.namelist()}
        self.most = min(UNPACKED_BYTES, max(UNPACKED_FREELY, UNPACKED_TIMES * packed))
        self.left = self.most
        self.tree_left = max(TREE_FREELY, TREE_TIMES * packed)
        self.objects: dict[_Key, Any] = {}
        self.roots: dict[str, Any] = {}
        self.colours: dict[_Key, list[str]] = {}
        self.meshes: list[tuple[str, RawMesh]] = []
        self.nodes: list[Node] = []
        self.number: dict[_Key, int] = {}
        self.skipped = self.placed = 0

    def scene(self) -> Scene:
        """All that the build places."""
        top = self._top()
        root = self._model(top)
        unit = root.get("unit", "millimeter")
        if unit not in _UNITS:
            raise MeshError([Fault(f"states the unit {in_quotes(unit)}, which 3MF does not have", EXPORT)])
        roots = []
        for item in root.iterfind("{*}build/{*}item"):
            k = self._object(_key(item, top), ())
            if k is not None:
                X, said = _transform(item), item.get("partnumber") or self.nodes[k].name
                roots.append(len(self.nodes))
                self.nodes.append(Node(said, X @ self.nodes[k].X, self.nodes[k].mesh, self.nodes[k].children))
        notes = (f"{counted(self.skipped, 'object')} of other types than model left out",) if self.skipped else ()
        return Scene(tuple(self.meshes), tuple(self.nodes), tuple(roots), _UNITS[unit], notes)

    def _top(self) -> str:
        """The file in the archive that its relationships name."""
        if "/_rels/.rels" in self.names:
            for relation in self._xml("/_rels/.rels").iterfind("{*}Relationship"):
                if relation.get("Type", "").endswith("/3dmodel"):
                    return "/" + str(relation.get("Target", "")).lstrip("/").lower()
        return "/3d/3dmodel.model"

    def _xml(self, name: str) -> Any:
        from lxml import etree

        if name not in self.names:
            raise MeshError([Fault(f"has no {name[1:]} in it", EXPORT)])
        info = self.archive.getinfo(self.names[name])
        if info.compress_type not in _PACKED:
            raise MeshError([Fault("is packed by another method than 3MF has, which is deflate", EXPORT)])
        self.left -= info.file_size
        if self.left < 0:
            raise MeshError([Fault(f"unpacks to more than {self.most:,} bytes of XML", "divide it")])
        try:
            text = self.archive.read(info)
        except (zipfile.BadZipFile, RuntimeError, NotImplementedError, EOFError, OSError) as error:
            raise MeshError([Fault(f"cannot be unpacked: {error}", EXPORT)]) from None
        refuse_declarations(text)
        self.tree_left -= ELEMENT_BYTES * text.count(b"<") + ATTRIBUTE_BYTES * text.count(b"=")
        if self.tree_left < 0:
            raise MeshError([Fault("has far more elements in it than its size lets expect", "divide it")])
        parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
        try:
            return etree.fromstring(text, parser)
        except etree.XMLSyntaxError as error:
            raise MeshError([Fault(f"has {name[1:]} that is not well-formed: {error}", EXPORT)]) from None

    def _model(self, name: str) -> Any:
        """A model in the archive; its objects are known then."""
        root = self._xml(name)
        self.roots[name] = root
        for prefix in root.get("requiredextensions", "").split():
            space = root.nsmap.get(prefix, prefix)
            if not any(word in space for word in _KNOWN):
                raise MeshError([Fault(f"needs the extension {in_quotes(space)}, which is not read",
                                       "export it as plain meshes")])  # fmt: skip
        self.placed += sum(1 for _ in root.iter("{*}component", "{*}item"))
        if self.placed > PARTS_MOST:
            message = f"has {self.placed:,} components and items, and {PARTS_MOST:,} are the most"
            raise MeshError([Fault(message, "divide it")])
        for table in root.iterfind("{*}resources/{*}object"):
            self.objects[name, table.get("id", "")] = table
        return root

    def _object(self, key: _Key, above: tuple[_Key, ...]) -> int | None:
        """The node of an object; None where it is no part."""
        if key in self.number:
            return self.number[key]
        if key[0] not in self.roots:
            self._model(key[0])
        table = self.objects.get(key)
        if table is None:
            raise MeshError([Fault(f"places object {in_quotes(key[1])}, which it does not have", EXPORT)])
        if len(above) > SCENE_DEEP:
            raise MeshError([Fault(f"has objects more than {SCENE_DEEP} deep in each other", EXPORT)])
        if key in above:
            raise MeshError([Fault(f"has object {in_quotes(key[1])} in itself", EXPORT)])
        if table.get("type", "model") not in ("model", "surface"):
            self.skipped += 1
            return None
        name, mesh, children = table.get("name", ""), table.find("{*}mesh"), []
        for part in table.iterfind("{*}components/{*}component"):
            k = self._object(_key(part, key[0]), (*above, key))
            if k is not None:
                children.append(len(self.nodes))
                node = self.nodes[k]
                self.nodes.append(Node(node.name, _transform(part) @ node.X, node.mesh, node.children))
        if mesh is not None:
            self.meshes.append((name, self._mesh(mesh, key, table)))
        self.number[key] = len(self.nodes)
        self.nodes.append(Node(name, np.eye(4), None if mesh is None else len(self.meshes) - 1, tuple(children)))
        return self.number[key]

    def _mesh(self, mesh: Any, key: _Key, table: Any) -> RawMesh:
        """The mesh of an object, in the colour of most of it."""
        raw = _mesh(mesh, key[1])
        usual = self._colour(key[0], table.get("pid"), table.get("pindex"))
        said = [(t.get("pid"), t.get("p1")) for t in mesh.iterfind("{*}triangles/{*}triangle")]
        if all(first is None for _, first in said):
            return replace(raw, colour=usual)
        of = {one: self._colour(key[0], one[0] or table.get("pid"), one[1]) for one in set(said) if one[1] is not None}
        colours = [of.get(one, usual) for one in said]
        distinct = list(dict.fromkeys(colours))
        number = np.array([distinct.index(colour) for colour in colours])
        pieces = [raw.faces[number == k] for k in range(len(distinct))]
        return replace(raw, colour=prevailing(raw.vertices, pieces, distinct))

    def _colour(self, file: str, group: str | None, place: str | None) -> str | None:
        """The colour at a place of a group of materials or colours; None where there is none."""
        if group is None or not (place or "").isdecimal():
            return None
        if (file, group) not in self.colours:
            resources = self.roots[file].find("{*}resources")
            groups = [] if resources is None else [t for t in resources if t.get("id") == group]
            listed = [t for t in groups for t in t.iterfind("{*}base")] or [
                t for t in groups for t in t.iterfind("{*}color")
            ]
            self.colours[file, group] = [t.get("displaycolor") or t.get("color") or "" for t in listed]
        every = self.colours[file, group]
        text = every[int(str(place)[:9])] if int(str(place)[:9]) < len(every) else ""
        return text[:7].lower() if _HEX.fullmatch(text) else None


def _key(element: Any, file: str) -> _Key:
    """What an item or a component places; `path` of the production extension names another file."""
    path = next((value for key, value in element.attrib.items() if key.endswith("}path")), None)
    return file if path is None else "/" + path.lstrip("/").lower(), element.get("objectid", "")


def _transform(element: Any) -> Array:
    """4×4; the file has the rows of its transpose."""
    X = np.eye(4)
    text = element.get("transform")
    if text is not None:
        values = _numbers(text.split(), "a transform")
        if values.shape != (12,):
            raise MeshError([Fault(f"has a transform of {values.size} numbers, and 12 are needed", EXPORT)])
        X[:3] = values.reshape(4, 3).T
    return X


def _numbers(words: list[str], what: str) -> Array:
    try:
        values = np.array(words, dtype=np.float64)
    except ValueError:
        raise MeshError([Fault(f"has {what} with what is no number", EXPORT)]) from None
    if not is_coordinate(values).all():
        raise MeshError([Fault(f"has {what} with numbers that are not finite, or beyond all places", EXPORT)])
    return values


def _mesh(mesh: Any, number: str) -> RawMesh:
    what = f"a mesh (object {number})"
    rows = [row for v in mesh.iterfind("{*}vertices/{*}vertex") for row in (v.get("x"), v.get("y"), v.get("z"))]
    triangles = mesh.iterfind("{*}triangles/{*}triangle")
    corners = [row for t in triangles for row in (t.get("v1"), t.get("v2"), t.get("v3"))]
    if None in rows or None in corners:
        raise MeshError([Fault(f"has {what} with vertices or triangles that miss a number", EXPORT)])
    vertices, faces = _numbers(rows, what).reshape(-1, 3), _numbers(corners, what).reshape(-1, 3)
    if (faces != np.floor(faces)).any() or (faces < 0).any() or (faces >= len(vertices)).any():
        raise MeshError([Fault(f"has {what} with a triangle of vertices that are not there", EXPORT)])
    return RawMesh(
        vertices, faces.astype(np.int64), written=written_step([[row.encode() for row in rows]], vertices.reshape(-1))
    )
