"""COLLADA (DAE): geometries placed by a tree of nodes, in metres.

pycollada reads it; trimesh, which uses that too, leaves the unit aside. `<unit meter>` is applied, as RViz and Gazebo
do; `up_axis` is where a file is an assembly, so that its z is up, and not where it is the mesh of a robot's link, as
these programs have it. Archives, entities and external document types are refused. Skins are left out.
"""

from __future__ import annotations

import functools
import io
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from kinform.form.constants import LARGEST_NUMBER, UNPACKED_BYTES
from kinform.form.meshes.raw import Fault, MeshError, RawMesh, is_coordinate, prevailing
from kinform.form.scenes.declarations import refuse_declarations
from kinform.form.scenes.scene import EXPORT, SCENE_DEEP, SCENE_NODES, Node, Scene, refuse_facets
from kinform.form.sources import AS_IT_IS, Reading
from kinform.formats.description.poses import about, pose
from kinform.foundation.colours import told
from kinform.foundation.words import counted
from kinform.model.arrays import Array

_UP = {
    "X_UP": np.array([[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]),
    "Y_UP": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "Z_UP": np.eye(3),
}
"""Rotations (3, 3) from the axes of a file to those with z up."""


def read_dae(data: bytes, path: Path, reading: Reading = AS_IT_IS) -> Scene:
    """The scene of a file. Raises MeshError."""
    reader = _Reader(data)
    roots = tuple(reader.node(node, 0) for node in reader.roots)
    up = np.eye(4)
    up[:3, :3] = _UP[str(reader.document.assetInfo.upaxis)]
    if not np.array_equal(up, np.eye(4)):
        reader.nodes.append(Node("", up, None, roots))
        roots = (len(reader.nodes) - 1,)
    return Scene(tuple(reader.meshes), tuple(reader.nodes), roots, "m", tuple(reader.notes()))


def read_dae_mesh(data: bytes) -> RawMesh:
    """All that a file places, in one mesh in metres, its axes as they are. Raises MeshError."""
    try:
        return _as_one(data)
    except MeshError:
        raise
    except Exception as error:  # pycollada reads some of a file when it is asked for that
        raise _unreadable(error) from None


def _as_one(data: bytes) -> RawMesh:
    reader = _Reader(data)
    roots = [reader.node(node, 0) for node in reader.roots]
    refuse_facets(Scene(tuple(reader.meshes), tuple(reader.nodes), tuple(roots), "m"))
    vertices, faces, count = [], [], 0
    colours: list[str | None] = []
    for k, X in _placed(reader.nodes, roots, np.eye(4)):
        raw = reader.meshes[k][1]
        vertices.append(raw.vertices @ X[:3, :3].T + X[:3, 3])
        faces.append((raw.faces if np.linalg.det(X[:3, :3]) >= 0.0 else raw.faces[:, ::-1]) + count)
        colours.append(raw.colour)
        count += len(raw.vertices)
    if not vertices:
        why = "".join(f"; {note}" for note in reader.notes())
        raise MeshError([Fault(f"is empty: it has no triangle{why}", EXPORT)])
    every = np.concatenate(vertices)
    if not is_coordinate(every).all():
        raise MeshError([Fault(f"has coordinates that are no finite numbers up to {LARGEST_NUMBER:g}", EXPORT)])
    single = float(np.finfo(np.float32).eps) * float(np.abs(every).max())
    return RawMesh(every, np.concatenate(faces), written=single, colour=prevailing(every, faces, colours))


def _placed(nodes: list[Node], below: list[int] | tuple[int, ...], X: Array) -> Iterator[tuple[int, Array]]:
    """Each mesh, by its number, with the matrix (4, 4) that places it."""
    for k in below:
        here = X @ nodes[k].X
        mesh = nodes[k].mesh
        if mesh is not None:
            yield mesh, here
        yield from _placed(nodes, nodes[k].children, here)


class _Reader:
    def __init__(self, data: bytes):
        import collada

        _check(data)
        broken = [collada.common.DaeError]
        try:
            self.document: Any = _document_type()(io.BytesIO(data), ignore=broken)
        except Exception as error:  # what it stumbles over is whatever it did not think of
            raise _unreadable(error) from None
        self.metres = float(self.document.assetInfo.unitmeter or 1.0)
        if not 0.0 < self.metres < LARGEST_NUMBER:
            raise MeshError([Fault(f"states a unit of {self.metres:g} m", EXPORT)])
        scene = self.document.scene
        self.roots = [] if scene is None else list(scene.nodes)
        self.meshes: list[tuple[str, RawMesh]] = []
        self.nodes: list[Node] = []
        self.skins = 0
        self._number: dict[tuple[Any, ...], int | None] = {}
        self._nodes: dict[int, int] = {}

    def notes(self) -> Iterator[str]:
        """What was left out."""
        if self.skins:
            yield f"{counted(self.skins, 'skinned mesh', 'skinned meshes')} taken without their skin"
        errors = [" ".join(str(error).split())[:100] for error in self.document.errors]
        if errors:
            yield f"{counted(len(errors), 'element')} that cannot be read: {errors[0]}"

    def node(self, node: Any, deep: int) -> int:
        """The number of a node of the file, with all below it; the same for each place that names the node."""
        stated = getattr(node, "node", node)  # an <instance_node> names another node
        if id(stated) not in self._nodes:
            self._nodes[id(stated)] = self._new_node(stated, deep)
        return self._nodes[id(stated)]

    def _new_node(self, node: Any, deep: int) -> int:
        import collada

        if deep > SCENE_DEEP or len(self.nodes) > SCENE_NODES:
            raise MeshError([Fault(f"has nodes more than {SCENE_DEEP} deep in each other, or too many", EXPORT)])
        X = _matrix(node)
        X[:3, 3] *= self.metres
        children: list[int] = []
        for child in node.children:
            if isinstance(child, collada.scene.Node):
                children.append(self.node(child, deep + 1))
            elif isinstance(child, collada.scene.GeometryNode):
                children += self._leaf(child.geometry, child.materials)
            elif isinstance(child, collada.scene.ControllerNode):
                self.skins += 1
                children += self._leaf(child.controller.geometry, child.materials)
        if not np.isfinite(X).all():
            raise MeshError([Fault("places a node by numbers that are not finite", EXPORT)])
        self.nodes.append(_joined(_name(node), X, children, self.nodes))
        return len(self.nodes) - 1

    def _leaf(self, geometry: Any, materials: Any) -> list[int]:
        """A node for a geometry in these materials; none where it has no triangle."""
        colours = {str(bound.symbol): _colour(bound.target) for bound in materials}
        key = (geometry.id, tuple(sorted((symbol, colour or "") for symbol, colour in colours.items())))
        if key not in self._number:
            raw = self._mesh(geometry, colours)
            self._number[key] = None if raw is None else len(self.meshes)
            if raw is not None:
                self.meshes.append((geometry.name or geometry.id or "", raw))
        k = self._number[key]
        if k is None:
            return []
        self.nodes.append(Node("", np.eye(4), k))
        return [len(self.nodes) - 1]

    def _mesh(self, geometry: Any, materials: Mapping[str, str | None]) -> RawMesh | None:
        import collada

        vertices, faces, count = [], [], 0
        colours: list[str | None] = []
        for primitive in geometry.primitives:
            if isinstance(primitive, collada.polylist.Polylist):  # polygons are polylists too
                primitive = primitive.triangleset()
            if not isinstance(primitive, collada.triangleset.TriangleSet) or not len(primitive):
                continue
            points = np.asarray(primitive.vertex, dtype=np.float64)
            corners = np.asarray(primitive.vertex_index, dtype=np.int64)
            if corners.min() < 0 or corners.max() >= len(points):
                raise MeshError([Fault("has a triangle of vertices that are not there", EXPORT)])
            if not is_coordinate(points).all():
                raise MeshError([Fault(f"has coordinates that are no finite numbers up to {LARGEST_NUMBER:g}", EXPORT)])
            vertices.append(points * self.metres)
            faces.append(corners + count)
            colours.append(materials.get(str(primitive.material)))
            count += len(points)
        if not vertices:
            return None
        every = np.concatenate(vertices)
        single = float(np.finfo(np.float32).eps) * float(np.abs(every).max())
        return RawMesh(every, np.concatenate(faces), written=single, colour=prevailing(every, faces, colours))


@functools.cache
def _document_type() -> Any:
    """The document of pycollada; nodes of a library are read after those that they name.

    Read in another order, they are tried again for each one that was read: a second for a hundred, a minute for 3000.
    """
    import collada

    def load_nodes(document: Any) -> None:
        for library in document.xmlnode.findall(document.tag("library_nodes")):
            nodes = library.findall(document.tag("node"))
            known = set(nodes)
            others = [element for element in library if element not in known]
            library[:] = [*others, *_named_first(nodes, document.tag("instance_node"))]
        collada.Collada._loadNodes(document)

    return type("Document", (collada.Collada,), {"_loadNodes": load_nodes})


def _named_first(nodes: list[Any], instance: str) -> list[Any]:
    """The nodes, each after those that it names, else as they are; what names itself in a circle stays in it."""
    by_id = {node.get("id"): node for node in nodes}
    ordered: dict[Any, None] = {}
    begun: set[Any] = set()
    todo = [(node, False) for node in reversed(nodes)]
    while todo:
        node, ready = todo.pop()
        if ready:
            ordered[node] = None
        elif node not in begun:
            begun.add(node)
            todo.append((node, True))
            named = [by_id.get((inner.get("url") or "").removeprefix("#")) for inner in node.iter(instance)]
            todo += [(other, False) for other in reversed(named) if other is not None]
    return list(ordered)


def _colour(material: Any) -> str | None:
    """What a material scatters; None where that is a texture."""
    diffuse = getattr(getattr(material, "effect", None), "diffuse", None)
    try:
        return told([float(v) for v in diffuse]) if isinstance(diffuse, tuple | list) else None
    except (TypeError, ValueError):
        return None


def _unreadable(error: Exception) -> MeshError:
    words = " ".join(str(error).split()) or type(error).__name__
    return MeshError([Fault(f"cannot be read as DAE: {words[:200]}", EXPORT)])


def _check(data: bytes) -> None:
    """Refuse what would be expanded beyond its size, or read from elsewhere."""
    if data.startswith(b"version https://git-lfs"):
        raise MeshError([Fault("is a pointer of Git LFS, not the mesh", "fetch it: git lfs pull")])
    if data[:2] == b"PK":
        raise MeshError([Fault("is an archive", "unpack it, and name the .dae")])
    if len(data) > UNPACKED_BYTES:
        raise MeshError([Fault(f"has {len(data):,} bytes, and {UNPACKED_BYTES:,} are the most", "divide it")])
    refuse_declarations(data)


def _joined(name: str, X: Array, children: list[int], nodes: list[Node]) -> Node:
    """A node; one that only holds a single mesh is that mesh, with its name."""
    if len(children) == 1 and nodes[children[0]].name == "" and not nodes[children[0]].children:
        return Node(name, X, nodes[children[0]].mesh)
    return Node(name, X, None, tuple(children))


def _matrix(node: Any) -> Array:
    """What the steps of a node make together, (4, 4). pycollada takes the axes of turns for unit vectors, and shears
    where they are rounded."""
    import collada

    X = np.eye(4)
    for step in node.transforms:
        if isinstance(step, collada.scene.RotateTransform):
            axis = float(step.x), float(step.y), float(step.z)
            if step.angle != 0.0 and not any(axis):
                raise MeshError([Fault("turns a node about an axis that is zero", EXPORT)])
            X = X @ pose(about(axis, math.radians(step.angle)), (0.0, 0.0, 0.0))
        else:
            X = X @ np.array(step.matrix, dtype=np.float64)
    return X


def _name(node: Any) -> str:
    element = getattr(node, "xmlnode", None)
    name = None if element is None else element.get("name") or element.get("id")
    return str(name or getattr(node, "id", None) or "")
