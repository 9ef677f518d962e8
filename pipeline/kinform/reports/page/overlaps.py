"""The solids in which two parts overlap, cut out again for the eye; their size and depth are in the results."""

from __future__ import annotations

import math

import numpy as np
from manifold3d import Error, Manifold, Mesh64

from kinform.design import Design
from kinform.foundation.current_work import working_on
from kinform.foundation.processes import threads_ran
from kinform.model.assembly import Part
from kinform.model.contacts import Interference
from kinform.reports.page.meshes import Shape, shape_of_facets

MOST_OVERLAPS = 200
"""Overlaps that are cut out; further ones are marked at their place alone."""


def overlap_shapes(design: Design) -> list[Shape | None]:
    """The overlap of each interference in the world (m); None where a mesh is no manifold."""
    found = [] if design.contacts is None else list(design.contacts.interferences)
    parts = {part.name: part for part in design.assembly.parts}
    centre, scale = _scaling(design)
    solids: dict[str, Manifold | None] = {}
    shapes: list[Shape | None] = []
    for item in found[:MOST_OVERLAPS]:
        with working_on(*item.parts):
            both = [_solid(parts[name], solids, centre, scale) for name in item.parts]
            shapes.append(_common(both[0], both[1], item, centre, scale))
    return shapes + [None] * (len(found) - len(shapes))


def _common(
    a: Manifold | None, b: Manifold | None, item: Interference, centre: np.ndarray, scale: float
) -> Shape | None:
    if a is None or b is None:
        return None
    mesh = (a ^ b).to_mesh64()
    corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts, dtype=np.int64)]
    if not len(corners):
        return None
    # an order of its own, whatever order manifold3d went about it in
    corners = corners[np.lexsort(tuple(corners.reshape(len(corners), 9).T[::-1]))]
    return shape_of_facets(corners * scale + centre)


def _scaling(design: Design) -> tuple[np.ndarray, float]:
    """A centre and a power of two that bring the assembly to the order of 1."""
    boxes = [p.mesh.box @ p.X_WP[:3, :3].T + p.X_WP[:3, 3] for p in design.assembly.parts if p.mesh is not None]
    if not boxes:
        return np.zeros(3), 1.0
    places = np.concatenate(boxes)
    low, high = places.min(axis=0), places.max(axis=0)
    return 0.5 * (low + high), 2.0 ** math.ceil(math.log2(max(float((high - low).max()), 1e-300)))


def _solid(part: Part, known: dict[str, Manifold | None], centre: np.ndarray, scale: float) -> Manifold | None:
    mesh = part.mesh
    if mesh is None or not mesh.health.watertight or mesh.health.manifold_status != "NoError":
        return None
    if part.name not in known:
        threads_ran()
        places = (mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3] - centre) / scale
        faces = mesh.faces if mesh.health.volume >= 0.0 else mesh.faces[:, ::-1]
        solid = Manifold(Mesh64(np.ascontiguousarray(places), np.ascontiguousarray(faces, dtype=np.uint64)))
        known[part.name] = solid if solid.status() == Error.NoError and not solid.is_empty() else None
    return known[part.name]
