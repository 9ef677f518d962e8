"""A scene: meshes in frames of their own, placed by a tree of nodes; and its parts, each a mesh with a name and a pose.

A node gives its name to what lies below it. A root that is alone and has no mesh is the file itself and gives none.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from kinform.form.constants import FRAME_ROUNDING, PARTS_MOST
from kinform.form.meshes.raw import Fault, MeshError, RawMesh, prevailing
from kinform.formats.description.tree import distinct
from kinform.foundation.name_hints import in_quotes
from kinform.frozen import dataclass
from kinform.model.arrays import Array

SCENE_DEEP = 64
"""Nodes of a scene in each other: twice what sub-assemblies may have, for each may have a frame of its own."""
SCENE_NODES = 400_000
"""Nodes that a scene places, counted each time that they are: four for each of the parts that a design may have."""


EXPORT = "export the file again"
"""The remedy where nothing else helps."""


@dataclass(frozen=True, eq=False)
class Node:
    """A frame with what is in it. Several nodes may have the same child: it is there as often."""

    name: str
    X: Array
    """4×4, of this node in its parent, in units of the file; it may scale."""
    mesh: int | None
    children: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Scene:
    """What a file says."""

    meshes: tuple[tuple[str, RawMesh], ...]
    """With the name that the file gives, or ""."""
    nodes: tuple[Node, ...]
    roots: tuple[int, ...]
    units: str | None
    """Of all its lengths; None where the format has none."""
    notes: tuple[str, ...] = ()
    files: tuple[Path, ...] = ()
    """Other files that were read."""
    shown: str | None = None
    """The unit in which people know the lengths of this file, where it is another than `units`."""


@dataclass(frozen=True, eq=False)
class ScenePart:
    """A mesh where it stands: x ↦ X·(scale·x)."""

    name: str
    original: str
    """As the file has it, "/" between what contains each other."""
    mesh: int
    X: Array
    """4×4, a pose, in units of the file."""
    scale: tuple[float, float, float]


def body_names(scene: Scene) -> list[str]:
    """A name for each mesh, in the order of the file: repeated ones get #2, #3."""
    free = distinct(set())
    return [free(plain(name) or "mesh") for name, _ in scene.meshes]


def plain(name: str) -> str:
    """A name that a part can have: "/" and what no text file holds become "_"."""
    kept = "".join("_" if c == "/" or c == "\x00" or "\ud800" <= c <= "\udfff" else c for c in name)
    return kept.strip()


def parts_of(scene: Scene) -> list[ScenePart]:
    """The parts in the order of the file. Raises MeshError where a node scales askew, or there are too many."""
    return list(_Walk(scene).parts())


class _Walk:
    """Goes through the tree, depth first, in the order of the file."""

    def __init__(self, scene: Scene):
        self.scene = scene
        self.visited = 0
        self.held = self._held()

    def _held(self) -> list[bool]:
        """Whether there is a mesh in or below each node."""
        nodes = self.scene.nodes
        above: list[list[int]] = [[] for _ in nodes]
        for k, node in enumerate(nodes):
            for child in node.children:
                above[child].append(k)
        held = [False] * len(nodes)
        todo = [k for k, node in enumerate(nodes) if node.mesh is not None]
        while todo:
            k = todo.pop()
            if not held[k]:
                held[k] = True
                todo += above[k]
        return held

    def parts(self) -> Iterator[ScenePart]:
        roots, X = [k for k in self.scene.roots if self.held[k]], np.eye(4)
        deep = 0
        while len(roots) == 1 and self.scene.nodes[roots[0]].mesh is None:
            node = self.scene.nodes[roots[0]]
            roots, X = [k for k in node.children if self.held[k]], X @ node.X
            deep += 1
            self._count(deep)
        yield from self._below(roots, "", "", X, deep)

    def _count(self, deep: int) -> None:
        self.visited += 1
        if deep > SCENE_DEEP:
            raise MeshError([Fault(f"has nodes more than {SCENE_DEEP} deep in each other, or in a circle", EXPORT)])
        if self.visited > SCENE_NODES:
            raise MeshError([Fault(f"places more than {SCENE_NODES:,} nodes", "divide it")])

    def _below(self, nodes: list[int], prefix: str, original: str, X: Array, deep: int) -> Iterator[ScenePart]:
        free = distinct(set())
        for k in nodes:
            self._count(deep)
            node = self.scene.nodes[k]
            said = node.name or ("" if node.mesh is None else self.scene.meshes[node.mesh][0])
            own = free(plain(said) or ("group" if node.mesh is None else "part"))
            name, told, X_here = prefix + own, original + said, X @ node.X
            inner = [child for child in node.children if self.held[child]]
            if inner:
                below = list(self._below(inner, f"{name}/", f"{told}/", X_here, deep + 1))
                yield from below
                taken = {"/".join(part.name.split("/")[: name.count("/") + 2]) for part in below}
                own_name = distinct(taken)(f"{name}/{own}")
            else:
                own_name = name
            if node.mesh is not None:
                pose, scale = _pose_and_scale(X_here, name)
                yield ScenePart(own_name, told, node.mesh, pose, scale)


def _pose_and_scale(X: Array, name: str) -> tuple[Array, tuple[float, float, float]]:
    """A pose, and factors along the axes of the mesh before it, that are the given matrix together."""
    columns = X[:3, :3].T
    lengths = np.sqrt((columns * columns).sum(axis=1))
    if not np.isfinite(X).all() or not (lengths > 0.0).all():
        raise MeshError([Fault(f"places {in_quotes(name)} by a matrix that is none of a solid", EXPORT)])
    x, y, z = columns / lengths[:, None]
    askew = max(abs(float((a * b).sum())) for a, b in ((x, y), (y, z), (z, x)))
    if askew > FRAME_ROUNDING:
        raise MeshError([Fault(f"shears {in_quotes(name)}, as unequal scales of turned nodes do",
                               "apply the scales to the meshes before it is exported")])  # fmt: skip
    y = y - (x * y).sum() * x
    y = y / np.sqrt((y * y).sum())
    last = np.cross(x, y)
    lengths[2] *= 1.0 if (last * z).sum() > 0.0 else -1.0
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, y, last])
    pose[:3, 3] = X[:3, 3]
    near = [round(float(v)) if abs(abs(v) - 1.0) < FRAME_ROUNDING else float(v) for v in lengths]
    return pose, (float(near[0]), float(near[1]), float(near[2]))


def whole(scene: Scene) -> RawMesh:
    """All parts of a scene in one mesh, where they stand. Raises MeshError where it has none."""
    from kinform.form.meshes.raw import scaled

    parts = parts_of(scene)
    if not parts:
        raise MeshError([Fault("is empty: it has no triangle", EXPORT)])
    vertices, faces, count = [], [], 0
    colours: list[str | None] = []
    written = 0.0
    for part in parts:
        raw = scaled(scene.meshes[part.mesh][1], part.scale)
        vertices.append(raw.vertices @ part.X[:3, :3].T + part.X[:3, 3])
        faces.append(raw.faces + count)
        colours.append(raw.colour)
        written = max(written, raw.written)
        count += len(raw.vertices)
        if sum(map(len, faces)) > PARTS_MOST * 1000:
            raise MeshError([Fault("places more than a hundred million facets", "divide it")])
    every = np.concatenate(vertices)
    return RawMesh(every, np.concatenate(faces), written=written, colour=prevailing(every, faces, colours))
