"""glTF 2.0, as GLB or as JSON with its buffers: meshes of triangles and the tree of nodes.

Read here, not by trimesh, which fills what it cannot decode with zeros, renames what has the same name, and allots
what a header claims before it looks at what is there. Lengths are metres. Materials give
their colour; skins, morph targets and textures are left.
"""

from __future__ import annotations

import base64
import json
import math
import os
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from kinform.form.constants import LARGEST_NUMBER, TEXT_BYTES
from kinform.form.meshes.raw import Fault, MeshError, RawMesh, is_coordinate, prevailing
from kinform.form.scenes.scene import EXPORT, Node, Scene
from kinform.form.sources import AS_IT_IS, Reading
from kinform.foundation.boundary import Boundary
from kinform.foundation.colours import of_light
from kinform.foundation.name_hints import in_quotes
from kinform.foundation.regular_files import not_a_file
from kinform.foundation.words import counted
from kinform.model.arrays import Array, Ints

_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}
_HARMLESS = ("KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_mesh_quantization", "KHR_xmp")
"""Extensions, by how they begin, that do not change where anything is; or that are read."""
NUMBER_BYTES = 8
"""Of a coordinate or an index once it is read."""
DECODED_TIMES = 64
"""Bytes of coordinates and indices, once they are read, for one of the buffers, at most: two where nothing is shared,
and ten where meshes share their vertices. Chosen, not measured."""
DECODED_FREELY = 100 << 20
"""Bytes of coordinates and indices that need no such ratio."""
_PLACING = ("matrix", "rotation", "scale", "translation")
"""Keys of a node that place it."""
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
"""Modes of primitives whose facets are read."""


def read_gltf(data: bytes, path: Path, reading: Reading = AS_IT_IS) -> Scene:
    """The scene of a file at `path`, beside which its buffers lie. Raises MeshError."""
    return _Reader(*_chunks(data), path, reading.boundary or Boundary(path)).scene()


def _chunks(data: bytes) -> tuple[Any, bytes | None]:
    """The JSON of a file, and its binary chunk, if any."""
    binary = None
    text = data
    if data[:4] == b"glTF":
        version, length = (int.from_bytes(data[k : k + 4], "little") for k in (4, 8))
        if version != 2:
            raise MeshError([Fault(f"is glTF {version}, and 2 is read", "export it as glTF 2.0")])
        if length > len(data):
            raise MeshError([Fault(f"is cut short: it has {len(data):,} bytes of {length:,}", EXPORT)])
        chunks: dict[bytes, bytes] = {}
        at = 12
        while at + 8 <= length:
            size, kind = int.from_bytes(data[at : at + 4], "little"), data[at + 4 : at + 8]
            if at + 8 + size > length:
                raise MeshError([Fault("has a chunk that goes beyond its end", EXPORT)])
            chunks.setdefault(kind, data[at + 8 : at + 8 + size])
            at += 8 + size
        text, binary = chunks.get(b"JSON", b""), chunks.get(b"BIN\x00")
    if len(text) > TEXT_BYTES:
        raise MeshError([Fault(f"has {len(text):,} bytes of JSON, and {TEXT_BYTES:,} are the most", "divide it")])
    try:
        header = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise MeshError([Fault(f"is no glTF: its JSON cannot be read ({str(error)[:80]})", EXPORT)]) from None
    if not isinstance(header, dict) or not isinstance(header.get("asset"), dict):
        raise MeshError([Fault("is no glTF: it states no asset", EXPORT)])
    version = header["asset"].get("version")
    if not str(version).startswith("2"):
        raise MeshError([Fault(f"is glTF {str(version)[:20]}, and 2 is read", "export it as glTF 2.0")])
    return header, binary


class _Reader:
    """Reads what a header names; every index and size is looked at before it is used."""

    def __init__(self, header: dict[str, Any], binary: bytes | None, path: Path, boundary: Boundary):
        self.header, self.binary, self.path, self.boundary = header, binary, path, boundary
        self.files: list[Path] = []
        self.notes: list[str] = []
        self._buffers: dict[int, bytes] = {}
        self._decoded = 0

    def scene(self) -> Scene:
        """All of it."""
        for name in self._list(self.header, "extensionsRequired"):
            if not str(name).startswith(_HARMLESS):
                raise MeshError([Fault(f"needs the extension {in_quotes(name)}, which is not read",
                                       "export it without compression and extensions")])  # fmt: skip
        meshes: list[tuple[str, RawMesh]] = []
        number: dict[int, int] = {}
        for k, table in enumerate(self._list(self.header, "meshes")):
            raw = self._mesh(k, table)
            if raw is not None:
                number[k] = len(meshes)
                meshes.append((_text(table.get("name")), raw))
        nodes = [self._node(k, table, number) for k, table in enumerate(self._list(self.header, "nodes"))]
        return Scene(tuple(meshes), tuple(nodes), self._roots(nodes), "m", tuple(self.notes), tuple(self.files))

    def _roots(self, nodes: list[Node]) -> tuple[int, ...]:
        """The nodes of the scene that is shown; without one, those that are no child."""
        scenes = self._list(self.header, "scenes")
        if not scenes:
            below = {child for node in nodes for child in node.children}
            return tuple(k for k in range(len(nodes)) if k not in below)
        shown = self._at("scenes", self.header.get("scene", 0))
        if len(scenes) > 1:
            self.notes.append(f"has {counted(len(scenes), 'scene')}: only the one that is shown is read")
        return tuple(self._index(k, len(nodes), "a node") for k in self._list(shown, "nodes"))

    def _node(self, k: int, table: Any, number: dict[int, int]) -> Node:
        what = f"node {k}"
        if not isinstance(table, dict):
            raise MeshError([Fault(f"has a {what} that is no table", EXPORT)])
        if "EXT_mesh_gpu_instancing" in (table.get("extensions") or {}):
            raise MeshError([Fault("has instances by EXT_mesh_gpu_instancing, which are not read",
                                   "export each instance as a node")])  # fmt: skip
        if "skin" in table:
            self.notes.append(f"node {in_quotes(table.get('name', k))} has a skin: it is taken without")
        mesh = None
        if "mesh" in table:
            self._leave_out_weights(table)
            mesh = number.get(self._index(table["mesh"], len(self._list(self.header, "meshes")), "a mesh"))
        count = len(self._list(self.header, "nodes"))
        children = tuple(self._index(child, count, "a node") for child in self._list(table, "children"))
        return Node(_text(table.get("name")), _matrix(table, what), mesh, children)

    def _leave_out_weights(self, node: dict[str, Any]) -> None:
        """Note morph targets that move the vertices of a node's mesh."""
        mesh = self._at("meshes", node["mesh"])
        weights = node.get("weights", mesh.get("weights", []))
        if isinstance(weights, list) and any(weights):
            self.notes.append(f"node {in_quotes(str(node.get('name', '')))} has morph targets: it is taken without")

    def _mesh(self, k: int, table: Any) -> RawMesh | None:
        """The triangles of a mesh; None where it has none."""
        vertices, faces, count, quantum = [], [], 0, 0.0
        colours: list[str | None] = []
        shared: dict[int, int] = {}
        for primitive in self._list(table, "primitives"):
            mode = primitive.get("mode", _TRIANGLES)
            if mode not in (_TRIANGLES, _STRIP, _FAN):
                continue
            for name in primitive.get("extensions") or ():
                if not str(name).startswith(_HARMLESS):
                    raise MeshError([Fault(f"has triangles in {in_quotes(name)}, which is not read",
                                           "export it without compression")])  # fmt: skip
            stated = primitive["attributes"]["POSITION"]
            if stated not in shared:
                points, step = self._positions(stated)
                shared[stated] = count
                vertices.append(points)
                quantum = max(quantum, step)
                count += len(points)
            size = len(vertices[list(shared).index(stated)])
            corners = np.arange(size) if "indices" not in primitive else self._corners(primitive["indices"], size, k)
            faces.append(_triangles(corners, mode, k) + shared[stated])
            colours.append(self._colour(primitive))
        if not sum(map(len, faces)):
            return None
        every = np.concatenate(vertices)
        colour = prevailing(every, faces, colours)
        return RawMesh(every, np.concatenate(faces).astype(np.int64), written=quantum, colour=colour)

    def _colour(self, primitive: dict[str, Any]) -> str | None:
        """Of the material of some triangles; None where it states none, or a texture says it."""
        every = self.header.get("materials")
        k = primitive.get("material")
        table = every[k] if isinstance(every, list) and isinstance(k, int) and 0 <= k < len(every) else None
        shade = table.get("pbrMetallicRoughness") if isinstance(table, dict) else None
        factor = shade.get("baseColorFactor") if isinstance(shade, dict) else None
        if not isinstance(factor, list) or len(factor) not in (3, 4):
            return None
        numbers = [float(v) for v in factor if isinstance(v, int | float) and math.isfinite(v)]
        return of_light(numbers) if len(numbers) == len(factor) else None

    def _positions(self, stated: Any) -> tuple[Array, float]:
        """Vertices (n, 3), and the step of quantised ones."""
        table = self._at("accessors", stated)
        values = self._accessor(table, stated)
        if values.shape[1] != 3:
            raise MeshError([Fault(f"has positions that are no vectors (accessor {stated})", EXPORT)])
        if values.dtype.kind == "f":
            if not is_coordinate(values).all():
                raise MeshError([Fault(f"has coordinates that are no numbers (accessor {stated})", EXPORT)])
            return values, 0.0
        step = 1.0
        if table.get("normalized"):
            step = 1.0 / np.iinfo(values.dtype).max
        return np.asarray(np.maximum(values * step, -1.0 if step < 1.0 else -np.inf)), float(step)

    def _corners(self, stated: Any, vertices: int, mesh: int) -> Ints:
        values = self._accessor(self._at("accessors", stated), stated)
        if values.dtype.kind != "u" or values.shape[1] != 1:
            raise MeshError([Fault(f"has indices that are none (accessor {stated})", EXPORT)])
        corners: Ints = values[:, 0].astype(np.int64)
        if len(corners) and corners.max() >= vertices:
            raise MeshError([Fault(f"has a triangle with vertex {corners.max()} of {vertices} (mesh {mesh})", EXPORT)])
        return corners

    def _accessor(self, table: Any, stated: Any) -> Any:
        """(count, columns) as the file has them."""
        if "sparse" in table or "bufferView" not in table:
            raise MeshError([Fault(f"has sparse or empty accessors (accessor {stated}), which are not read",
                                   "export it without compression and morphing")])  # fmt: skip
        view = self._at("bufferViews", table["bufferView"])
        for name in view.get("extensions") or ():
            if "compression" in str(name):
                raise MeshError([Fault(f"is compressed by {in_quotes(name)}, which is not read",
                                       "export it without compression")])  # fmt: skip
        kind, columns = np.dtype(_TYPES[table["componentType"]]), _COLUMNS[table["type"]]
        row = kind.itemsize * columns
        count, inner = _size(table["count"]), _size(table.get("byteOffset", 0))
        start, length = _size(view.get("byteOffset", 0)), _size(view["byteLength"])
        stride = _size(view.get("byteStride", row))
        data = self._buffer(view["buffer"])
        if start + length > len(data):
            raise MeshError([Fault(f"is cut short: a view ends at byte {start + length:,} of {len(data):,}", EXPORT)])
        if count == 0:
            return np.zeros((0, columns), kind)
        self._decoded += NUMBER_BYTES * count * columns
        if self._decoded > max(DECODED_FREELY, DECODED_TIMES * sum(map(len, self._buffers.values()))):
            raise MeshError([Fault("reads the same vertices or indices again and again for other triangles",
                                   "give each mesh vertices of its own")])  # fmt: skip
        if stride < row or inner + (count - 1) * stride + row > length:
            raise MeshError([Fault(f"has an accessor that goes beyond its view (accessor {stated})", EXPORT)])
        steps = (stride, kind.itemsize)
        return np.ndarray((count, columns), kind, data, start + inner, steps).astype(kind.newbyteorder("="))

    def _buffer(self, stated: Any) -> bytes:
        table = self._at("buffers", stated)
        if stated not in self._buffers:
            uri = table.get("uri")
            data = self.binary if uri is None else self._uri(str(uri))
            if data is None:
                raise MeshError([Fault(f"has no data for buffer {stated}", EXPORT)])
            if _size(table["byteLength"]) > len(data):
                raise MeshError([Fault(f"has {len(data):,} bytes of the {table['byteLength']:,} of buffer {stated}",
                                       EXPORT)])  # fmt: skip
            self._buffers[stated] = data
        return self._buffers[stated]

    def _uri(self, uri: str) -> bytes:
        if uri.startswith("data:"):
            return base64.b64decode(uri.partition(",")[2])
        name = unquote(uri)
        folder = self.path.parent
        path = folder / name
        inside = os.path.join(os.path.realpath(folder), "")
        beside = "://" not in name and "\x00" not in name and os.path.realpath(path).startswith(inside)
        if not beside or not self.boundary.allows(path):
            raise MeshError([Fault(f"names the buffer {in_quotes(name)}, outside of its folder", "export it as GLB")])
        if not self.boundary.is_file(path) or not_a_file(path):
            raise MeshError([Fault(f"names the buffer {in_quotes(name)}, which is not there",
                                   "put it beside the file, or export GLB")])  # fmt: skip
        try:
            data = self.boundary.read(path)
        except OSError:  # no more what it was, or outside
            raise MeshError(
                [Fault(f"names the buffer {in_quotes(name)}, which cannot be read", "export GLB")]
            ) from None
        self.files.append(path)
        return data

    def _list(self, table: Any, key: str) -> list[Any]:
        value = table.get(key, [])
        if not isinstance(value, list):
            raise MeshError([Fault(f"is no valid glTF: {key} is no list", EXPORT)])
        return value

    def _at(self, key: str, k: Any) -> dict[str, Any]:
        """Element k of a list of the header."""
        every = self._list(self.header, key)
        table = every[self._index(k, len(every), key)]
        if not isinstance(table, dict):
            raise MeshError([Fault(f"is no valid glTF: an element of {key} is no table", EXPORT)])
        return table

    def _index(self, k: Any, count: int, what: str) -> int:
        if isinstance(k, bool) or not isinstance(k, int) or not 0 <= k < count:
            raise MeshError([Fault(f"names {what} {str(k)[:20]}, and there are {count}", EXPORT)])
        return k


def _size(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < 1 << 48:
        raise MeshError([Fault(f"states {str(value)[:20]} for a size", EXPORT)])
    return value


def _text(value: Any) -> str:
    return value if isinstance(value, str) else ""


def _triangles(corners: Ints, mode: int, mesh: int) -> Ints:
    if mode == _TRIANGLES:
        if len(corners) % 3:
            raise MeshError([Fault(f"has {len(corners)} corners of triangles, no multiple of 3 (mesh {mesh})", EXPORT)])
        return corners.reshape(-1, 3)
    n = np.arange(max(len(corners) - 2, 0))
    if mode == _FAN:
        return np.asarray(corners[np.column_stack([n * 0, n + 1, n + 2])])
    return np.asarray(corners[np.column_stack([n, n + 1 + n % 2, n + 2 - n % 2])])


def _matrix(table: dict[str, Any], what: str) -> Array:
    """The pose of a node in its parent, 4×4."""

    def numbers(key: str, size: int, usual: list[float]) -> Array:
        values = table.get(key, usual)
        fits = isinstance(values, list) and len(values) == size
        if not fits or not all(isinstance(v, int | float) and abs(v) <= LARGEST_NUMBER for v in values):
            raise MeshError([Fault(f"has a {key} of {what} that is not {size} numbers", EXPORT)])
        return np.array(values, dtype=np.float64)

    if table.keys().isdisjoint(_PLACING):
        return np.eye(4)
    if "matrix" in table:
        return np.asarray(numbers("matrix", 16, []).reshape(4, 4).T)
    X = np.eye(4)
    x, y, z, w = numbers("rotation", 4, [0.0, 0.0, 0.0, 1.0])
    size = w * w + x * x + y * y + z * z
    if not size > 0.0:
        raise MeshError([Fault(f"has a rotation of {what} that is zero", EXPORT)])
    s = 2.0 / size
    X[:3, :3] = [
        [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
        [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)],
        [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)],
    ]
    X[:3, :3] *= numbers("scale", 3, [1.0, 1.0, 1.0])
    X[:3, 3] = numbers("translation", 3, [0.0, 0.0, 0.0])
    return X
