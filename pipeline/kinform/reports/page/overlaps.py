"""The solids in which two parts overlap, cut out again for the eye; their size and depth are in the results."""

from __future__ import annotations

from kinform.contacts.overlap.solids import ScaledSolid, bounds_volume, overlap_of, scaled_solid
from kinform.design import Design
from kinform.foundation.algebra.displacements import inverse
from kinform.foundation.current_work import working_on
from kinform.model.assembly import Part
from kinform.reports.page.meshes import Shape, shape_of_facets

MOST_OVERLAPS = 200
"""Overlaps that are cut out; further ones are marked at their place alone. Chosen, not measured."""


def overlap_shapes(design: Design) -> list[Shape | None]:
    """The overlap of each interference in the world (m); None where a mesh is no manifold."""
    found = [] if design.contacts is None else list(design.contacts.interferences)
    solids: dict[tuple[str, int], ScaledSolid | None] = {}
    shapes: list[Shape | None] = []
    for item in found[:MOST_OVERLAPS]:
        first, second = map(design.assembly.part, item.parts)
        with working_on(*item.parts):
            shapes.append(_common(first, second, solids))
    return shapes + [None] * (len(found) - len(shapes))


def _common(a: Part, b: Part, solids: dict[tuple[str, int], ScaledSolid | None]) -> Shape | None:
    """The overlap of two parts."""
    first, second = (_solid(part, role, solids) for role, part in enumerate((a, b)))
    if first is None or second is None:
        return None
    corners = overlap_of(first, first.of(second, inverse(a.X_WP) @ b.X_WP), 0.0).corners
    return shape_of_facets(corners @ a.X_WP[:3, :3].T + a.X_WP[:3, 3]) if len(corners) else None


def _solid(part: Part, role: int, known: dict[tuple[str, int], ScaledSolid | None]) -> ScaledSolid | None:
    """The part's mesh as a solid, where it bounds one."""
    mesh = part.mesh
    if mesh is None or not bounds_volume(mesh):
        return None
    key = (mesh.digest, role)
    if key not in known:
        known[key] = scaled_solid(mesh, role)
    return known[key]
