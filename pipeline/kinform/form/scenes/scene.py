"""A scene: meshes in frames of their own, placed by a tree of nodes; and its parts, each a mesh with a name and a pose.

A node gives its name to what lies below it. A root that is alone and has no mesh is the file itself and gives none.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from kinform.form.constants import FRAME_ROUNDING, NAME_LENGTH, PARTS_MOST
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
    """The parts in the order of the file. Raises MeshError where a node scales askew, a name is longer than a part may
    have, or there are too many; these are counted before any is placed."""
    counts = count_placed(scene)
    if counts.meshes > PARTS_MOST:
        raise MeshError([Fault(f"has {many(counts.meshes)} parts, and {PARTS_MOST:,} are the most", "divide it")])
    return list(_Walk(scene, named=True).parts())


COUNTED_MOST = 10**15
"""Copies up to which a number of them is printed: what doubles at every level soon has hundreds of digits."""


def many(count: int) -> str:
    """The number of copies that a scene places, as messages show it."""
    return f"{count:,}" if count < COUNTED_MOST else f"more than {COUNTED_MOST:,}"


@dataclass(frozen=True)
class Placed:
    """How much a scene places, each thing counted as often as it is placed."""

    nodes: int
    meshes: int
    facets: int


def count_placed(scene: Scene) -> Placed:
    """How much a scene places, from what is below each node, without placing any of it. Raises MeshError where nodes
    are in each other in a circle or too deep, or where more are placed than a scene may have."""
    below: dict[int, tuple[int, int, int, int]] = {}
    held = _held(scene)
    entered: set[int] = set()
    todo = [k for k in scene.roots if held[k]]
    while todo:
        k = todo[-1]
        if k in below:
            todo.pop()
            continue
        node = scene.nodes[k]
        children = [child for child in node.children if held[child]]
        if k not in entered:
            entered.add(k)
            todo += [child for child in dict.fromkeys(children) if child not in below]
            continue
        if any(child not in below for child in children):  # a child that waits for this node
            raise MeshError([_DEEP])
        of = [below[child] for child in children]
        facets = 0 if node.mesh is None else len(scene.meshes[node.mesh][1].faces)
        below[k] = (
            1 + sum(counts[0] for counts in of),
            (node.mesh is not None) + sum(counts[1] for counts in of),
            facets + sum(counts[2] for counts in of),
            1 + max((counts[3] for counts in of), default=0),
        )
        todo.pop()
    roots = [below[k] for k in scene.roots if held[k]]
    if max((counts[3] for counts in roots), default=0) > SCENE_DEEP + 1:
        raise MeshError([_DEEP])
    placed = Placed(*(sum(counts[n] for counts in roots) for n in range(3)))
    if placed.nodes > SCENE_NODES:
        message = f"places {many(placed.nodes)} nodes, and {SCENE_NODES:,} are the most"
        raise MeshError([Fault(message, "divide it")])
    return placed


_DEEP = Fault(f"has nodes more than {SCENE_DEEP} deep in each other, or in a circle", EXPORT)


def _held(scene: Scene) -> list[bool]:
    """Whether there is a mesh in or below each node."""
    nodes = scene.nodes
    above: list[list[int]] = [[] for _ in nodes]
    for k, node in enumerate(nodes):
        for child in set(node.children):
            above[child].append(k)
    held = [False] * len(nodes)
    todo = [k for k, node in enumerate(nodes) if node.mesh is not None]
    while todo:
        k = todo.pop()
        if not held[k]:
            held[k] = True
            todo += above[k]
    return held


class _Walk:
    """Goes through a tree that `count_placed` has let pass, depth first, in the order of the file. Parts have names
    where these are asked for."""

    def __init__(self, scene: Scene, named: bool):
        self.scene, self.named = scene, named
        self.held = _held(scene)

    def parts(self) -> Iterator[ScenePart]:
        roots, X = [k for k in self.scene.roots if self.held[k]], np.eye(4)
        while len(roots) == 1 and self.scene.nodes[roots[0]].mesh is None:
            node = self.scene.nodes[roots[0]]
            roots, X = [k for k in node.children if self.held[k]], X @ node.X
        yield from self._below(roots, "", "", X)

    def _below(self, nodes: list[int], prefix: str, original: str, X: Array) -> Iterator[ScenePart]:
        free = distinct(set())
        for k in nodes:
            node = self.scene.nodes[k]
            said = ""
            if self.named:
                said = node.name or ("" if node.mesh is None else self.scene.meshes[node.mesh][0])
            own = free(plain(said) or ("group" if node.mesh is None else "part")) if self.named else ""
            name, told, X_here = prefix + own, original + said, X @ node.X
            if len(name) > NAME_LENGTH:
                message = f"has names of more than {NAME_LENGTH} characters: {in_quotes(name)}"
                raise MeshError([Fault(message, "shorten them")])
            inner = [child for child in node.children if self.held[child]]
            if inner:
                deeper = (f"{name}/", f"{told}/") if self.named else ("", "")
                below = list(self._below(inner, *deeper, X_here))
                yield from below
            if node.mesh is not None:
                if inner and self.named:
                    taken = {"/".join(part.name.split("/")[: name.count("/") + 2]) for part in below}
                    name = distinct(taken)(f"{name}/{own}")
                pose, scale = _pose_and_scale(X_here, name)
                yield ScenePart(name, told, node.mesh, pose, scale)


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


FACETS_MOST = 10_000_000
"""Facets of the copies that become one mesh: as many as the largest file of one has (`UNPACKED_BYTES`)."""


def refuse_facets(scene: Scene) -> None:
    """Raise MeshError where a scene places more facets than one mesh may have."""
    facets = count_placed(scene).facets
    if facets > FACETS_MOST:
        message = f"places {many(facets)} facets, and {FACETS_MOST:,} are the most in one mesh"
        raise MeshError([Fault(message, "divide it")])


def whole(scene: Scene) -> RawMesh:
    """All parts of a scene in one mesh, where they stand. Raises MeshError where it has none, or too many."""
    from kinform.form.meshes.raw import scaled

    refuse_facets(scene)
    parts = list(_Walk(scene, named=False).parts())
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
    every = np.concatenate(vertices)
    return RawMesh(every, np.concatenate(faces), written=written, colour=prevailing(every, faces, colours))
