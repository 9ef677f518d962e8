"""An assembly of meshes that a program holds: trimesh's meshes and scenes, arrays, solids that can be tessellated.

None of their libraries is needed: a mesh is what has `vertices` and `faces`, a solid what has `tessellate(tolerance,
angular_tolerance)`, as those of build123d and CadQuery, a scene what has a `graph` and `geometry`, as trimesh's.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from kinform.form.constants import STEP_TURN
from kinform.form.meshes.health import build_mesh
from kinform.form.meshes.raw import Fault, MeshError, RawMesh, is_coordinate, scaled
from kinform.form.problems import Problems
from kinform.form.readers.poses import shift
from kinform.form.scenes.scene import Node, Scene, ScenePart, parts_of
from kinform.foundation.name_hints import did_you_mean, in_quotes
from kinform.foundation.units import UNITS, metres_per
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part, Source, Subassembly
from kinform.model.function import Function
from kinform.model.names import PartName
from kinform.model.tolerances import Tolerances

WHERE = "(python)"
"""In place of a file, in what is told of such parts."""


def is_scene_object(value: Any) -> bool:
    """Whether this is a scene: what has a graph of transforms, and geometry by name."""
    return hasattr(value, "graph") and isinstance(getattr(value, "geometry", None), Mapping)


def from_meshes(
    meshes: Any,
    *,
    units: str | None = None,
    name: str = "assembly",
    density: float | None = None,
    deviation: float | None = None,
) -> Assembly:
    """An assembly of `meshes`: {name: mesh or (mesh, pose)}, or a scene of trimesh, whose nodes are sub-assemblies.

    A mesh has `vertices` (n, 3) and `faces` (m, 3), or is a pair of such arrays, or has `tessellate`, then at most
    `deviation` off, a thousandth of its size by default. A pose is a matrix (4, 4), or a location of build123d.
    `units` is the unit of all lengths, poses and deviation included; a scene may state its own. `density` (kg/m³) is
    that of all parts. Raises InputError with every problem.
    """
    problems = Problems()
    unit = units if units is not None else getattr(meshes, "units", None)
    if unit not in UNITS:
        said = "the unit of length is not stated" if unit is None else f"unknown unit {in_quotes(str(unit))}"
        remedy = 'state it: units="mm"' if unit is None else did_you_mean(str(unit), UNITS, "units")
        problems.add(said, WHERE, None, remedy)
        unit = "m"
    parts: list[Part] = []
    try:
        scene = _of_scene(meshes) if is_scene_object(meshes) else _of_mapping(meshes, deviation, problems)
        placed = parts_of(scene)
        parts = [part for item in placed if (part := _part(item, scene, unit, density, problems)) is not None]
    except MeshError as error:
        _complain(error, "the assembly", problems)
    if not parts and not len(problems):
        problems.add("there is no mesh", WHERE, None, "give {name: mesh}")
    problems.raise_if_any()
    return Assembly(
        name=name,
        units=unit,
        parts=tuple(sorted(parts, key=lambda part: part.name)),
        groups=(),
        assumptions=(),
        ground=None,
        tolerances=Tolerances(),
        infer_fasteners=False,
        function=Function(),
        simulation=None,
        subassemblies=tuple(_subassemblies(parts)),
        source=Source(WHERE),
        files=(),
    )


def _part(item: ScenePart, scene: Scene, unit: str, density: float | None, problems: Problems) -> Part | None:
    metres = metres_per(unit)
    raw = scene.meshes[item.mesh][1]
    try:
        if item.scale != (1.0, 1.0, 1.0):
            raw = scaled(raw, item.scale)
        mesh = build_mesh(raw, metres, None, path="", body=item.name, solid=True)
    except MeshError as error:
        _complain(error, in_quotes(item.name), problems)
        return None
    X = item.X.copy()
    X[:3, 3] *= metres
    pose = shift(X, mesh.origin)
    return Part(PartName(item.name), mesh, pose, True, None, density, None, unit, Source(WHERE))


def _subassemblies(parts: list[Part]) -> Iterable[Subassembly]:
    names = {part.name.rsplit("/", k)[0] for part in parts for k in range(1, part.name.count("/") + 1)}
    return (Subassembly(name, WHERE, None, Source(WHERE)) for name in sorted(names))


def _complain(error: MeshError, what: str, problems: Problems) -> None:
    for fault in error.faults:
        problems.add(f"{what} {fault.message}", WHERE, None, fault.remedy)


def _of_mapping(meshes: Any, deviation: float | None, problems: Problems) -> Scene:
    """Each mesh a node of the scene, in its pose."""
    if not isinstance(meshes, Mapping):
        raise MeshError([Fault(f"is a {type(meshes).__name__}", "give {name: mesh or (mesh, pose)}, or a scene")])
    raws: list[tuple[str, RawMesh]] = []
    nodes: list[Node] = []
    for name, value in meshes.items():
        try:
            if not isinstance(name, str) or not name.strip():
                raise MeshError([Fault("has no name that is a text", "name each mesh")])
            shape, X = (value[0], _pose(value[1])) if _is_posed(value) else (value, np.eye(4))
            raws.append((name, _raw(shape, deviation)))
            nodes.append(Node(name, X, len(raws) - 1))
        except MeshError as error:
            _complain(error, in_quotes(str(name)), problems)
    return Scene(tuple(raws), tuple(nodes), tuple(range(len(nodes))), None)


def _of_scene(scene: Any) -> Scene:
    """The tree of a trimesh scene, its meshes once each."""
    raws = [(str(name), _raw(mesh, None)) for name, mesh in scene.geometry.items() if len(getattr(mesh, "faces", ()))]
    number = {name: k for k, (name, _) in enumerate(raws)}
    tree = scene.graph.transforms
    names = list(tree.nodes)
    place = {name: k for k, name in enumerate(names)}
    nodes = []
    for name in names:
        above = tree.parents.get(name)
        X = np.eye(4) if above is None else _pose(tree.edge_data[above, name].get("matrix", np.eye(4)))
        mesh = number.get(str(tree.node_data[name].get("geometry")))
        nodes.append(Node(str(name), X, mesh, tuple(place[child] for child in tree.children.get(name, ()))))
    roots = tuple(k for k, name in enumerate(names) if tree.parents.get(name) is None)
    return Scene(tuple(raws), tuple(nodes), roots, None)


def _is_posed(value: Any) -> bool:
    """Whether this is a mesh with a pose, and not a pair of arrays."""
    if not isinstance(value, tuple) or len(value) != 2:
        return False
    return _is_shape(value[0]) or isinstance(value[0], tuple)


def _is_shape(value: Any) -> bool:
    return hasattr(value, "faces") or hasattr(value, "tessellate")


def _pose(stated: Any) -> Array:
    """A matrix (4, 4); also of a location that holds a transformation of OpenCASCADE."""
    if hasattr(stated, "wrapped") and hasattr(stated.wrapped, "Transformation"):
        moved = stated.wrapped.Transformation()
        stated = [[moved.Value(i, j) for j in (1, 2, 3, 4)] for i in (1, 2, 3)] + [[0.0, 0.0, 0.0, 1.0]]
    try:
        X = np.array(stated, dtype=np.float64)
    except (TypeError, ValueError):
        X = np.zeros(0)
    if X.shape != (4, 4) or not is_coordinate(X).all() or not np.array_equal(X[3], [0.0, 0.0, 0.0, 1.0]):
        raise MeshError([Fault("has a pose that is no matrix (4, 4) of finite numbers", "give one matrix")])
    return X


def _raw(shape: Any, deviation: float | None) -> RawMesh:
    """Vertices and faces of whatever has them."""
    if not isinstance(shape, tuple) and hasattr(shape, "tessellate"):
        vertices, faces = _tessellated(shape, deviation)
    elif isinstance(shape, tuple) and len(shape) == 2:
        vertices, faces = shape
    else:
        vertices, faces = (getattr(shape, key, None) for key in ("vertices", "faces"))
    if vertices is None or faces is None or callable(vertices) or callable(faces):
        kind = type(shape).__name__
        raise MeshError([Fault(f"is a {kind}, which has neither vertices and faces nor tessellate", "give a mesh")])
    try:
        points, corners = np.array(vertices, dtype=np.float64), np.array(faces)
    except (TypeError, ValueError):
        points, corners = np.zeros(0), np.zeros(0)
    if points.ndim != 2 or points.shape[1] != 3 or corners.ndim != 2 or corners.shape[1] != 3:
        raise MeshError([Fault("has no vertices (n, 3), or no faces (m, 3)", "triangulate it")])
    if not is_coordinate(points).all():
        raise MeshError([Fault("has coordinates that are not finite, or beyond all places", "correct them")])
    whole = corners.astype(np.int64)
    if (whole != corners).any() or (len(whole) and (whole.min() < 0 or whole.max() >= len(points))):
        raise MeshError([Fault("has faces of vertices that are not there", "correct them")])
    from kinform.form.meshes.by_trimesh import colour_of_mesh

    return RawMesh(points, whole, colour=colour_of_mesh(shape))


def _tessellated(shape: Any, deviation: float | None) -> tuple[Any, Any]:
    """Vertices and triangles of a solid, in its own unit; a thousandth of its size off where nothing is stated."""
    try:
        # Deviation of facets of solids that a program holds, in diagonals: `STEP_TURN` decides for what is round, and
        # this only for what is nearly flat. Chosen, not measured.
        size = 1e-3 * _diagonal(shape) if deviation is None else deviation
        vertices, faces = shape.tessellate(size, STEP_TURN)
        return [_xyz(vertex) for vertex in vertices], [tuple(face) for face in faces]
    except MeshError:
        raise
    except Exception as error:  # of other people's code
        words = " ".join(str(error).split()) or type(error).__name__
        raise MeshError([Fault(f"cannot be tessellated: {words[:200]}", "give vertices and faces")]) from None


def _diagonal(shape: Any) -> float:
    """Of the bounding box, as build123d has it, or CadQuery."""
    if hasattr(shape, "bounding_box"):
        return float(shape.bounding_box().diagonal)
    if hasattr(shape, "BoundingBox"):
        return float(shape.BoundingBox().DiagonalLength)
    raise MeshError([Fault("does not tell its size, to which a deviation is chosen", "state deviation")])


def _xyz(vertex: Any) -> tuple[float, ...]:
    return tuple(vertex.toTuple()) if hasattr(vertex, "toTuple") else tuple(vertex)
