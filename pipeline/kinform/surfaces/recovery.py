"""The method, from a mesh to its surfaces.

Works in unit coordinates (centred, diagonal 1) and in a canonical order of vertices and facets, so that
neither the size of a part nor the order in its file changes what is found.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.model.arrays import Array, Ints, freeze
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces, Surface
from kinform.model.tolerances import Tolerances
from kinform.surfaces.describe import Description, curved, flat, freeform
from kinform.surfaces.kinds.kind import Batch
from kinform.surfaces.polygons.facets import fabric, scatter
from kinform.surfaces.polygons.patchwork import Patchwork, Scale, build
from kinform.surfaces.regions.merge import coincident_planes, coincident_regions
from kinform.surfaces.regions.partition import CURVED, Partition, partition
from kinform.surfaces.swept.sliding import sliding
from kinform.surfaces.swept.threads import threads

__all__ = ["recover"]

EPS32 = float(np.finfo(np.float32).eps)
SMALL = 2e-2
"""Share of the area below which a plane may be a facet of a thread."""


def recover(mesh: Mesh, tolerances: Tolerances) -> MeshSurfaces:
    """Planes, cylinders, cones and spheres of a welded mesh; the rest is freeform.

    Every facet belongs to exactly one surface. The mesh need not be closed. Results are in the part
    frame (m, rad), by descending area, then lowest facet index.
    """
    diagonal = mesh.diagonal
    if not len(mesh.faces) or diagonal <= 0 or not np.isfinite(mesh.vertices).all():
        return MeshSurfaces(mesh.digest, (), np.zeros(0, np.int64), 0.0)
    largest = float(np.abs(mesh.vertices).max())
    centre = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
    vertices, faces, order = _canonical_order((mesh.vertices - centre) / diagonal, mesh.faces)
    woven = fabric(vertices, faces)
    scale = _scale(EPS32 * largest / diagonal, scatter(woven, tolerances.smooth_edge), tolerances)
    work = build(woven, scale, tolerances)
    descriptions = _describe(work, partition(work, scale), scale)
    return _assemble(mesh, work, descriptions, order, centre, diagonal)


def _scale(rounding: float, scattered: float, tolerances: Tolerances) -> Scale:
    """Vertices that scatter more than they were stored with widen everything to four standard deviations."""
    noise = max(tolerances.fit / 10, 1.5 * rounding)
    fit = max(tolerances.fit, 10 * noise)
    if 2 * scattered > noise:
        return Scale(max(rounding, scattered), scattered, noise=4 * scattered, fit=max(fit, 5 * scattered))
    return Scale(rounding, 0.0, noise=noise, fit=fit)


def _canonical_order(vertices: Array, faces: Ints) -> tuple[Array, Ints, Ints]:
    """(vertices, faces, original number of each face), sorted by coordinates."""
    by_place = np.lexsort(vertices.T[::-1])
    place = np.empty(len(vertices), np.int64)
    place[by_place] = np.arange(len(vertices))
    renamed = place[faces]
    first = np.argmin(renamed, axis=1)
    rows = np.arange(len(faces))[:, None]
    turned = renamed[rows, (first[:, None] + np.arange(3)) % 3]
    order = np.lexsort(turned.T[::-1])
    return vertices[by_place], turned[order], order


def _describe(work: Patchwork, parts: Partition, scale: Scale) -> list[Description]:
    """Merges what is one surface and measures every surface."""
    out: list[Description] = []
    for kind in CURVED:
        regions = [region for region in parts.regions if region.kind is kind]
        if not regions:
            continue
        polygons = [region.polygons for region in regions]
        params = np.array([region.params for region in regions])
        side = np.array([region.side for region in regions])
        tolerance = np.array([region.tolerance for region in regions])
        root = coincident_regions(work, kind, polygons, params, side, scale)
        heads, group = np.unique(root, return_inverse=True)
        sizes = [len(p) for p in polygons]
        region_of = np.repeat(group, sizes)
        polygon = np.concatenate(polygons)
        arranged = np.lexsort((polygon, region_of))
        batch = Batch(work, region_of[arranged], polygon[arranged], len(heads))
        loosest = np.zeros(len(heads))
        np.maximum.at(loosest, group, tolerance)
        merged = np.bincount(group) > 1
        loosest = np.where(merged, scale.fit, loosest)
        out.extend(curved(kind, batch, params[heads], side[heads], loosest, scale))
    rest, alone = parts.freeform.copy(), parts.planes.copy()
    small = (alone >= 0) & (work.area < SMALL * work.area.sum())
    for found in threads(work, (rest >= 0) | small, out, scale):
        out.append(found)
        rest[found.polygons] = alone[found.polygons] = -1
    alone[alone >= 0] = np.unique(alone[alone >= 0], return_inverse=True)[1]
    planes = coincident_planes(work, alone, scale)
    out.extend(flat(work, planes, scale))
    for found in sliding(work, rest, scale):
        chord = freeform(work, found.polygons, _inner(work, rest, found.polygons)).chord
        out.append(replace(found, chord=chord))
        rest[found.polygons] = -1
    inner = np.flatnonzero(work.smooth)
    inner = inner[(rest[work.a[inner]] >= 0) & (rest[work.a[inner]] == rest[work.b[inner]])]
    order = np.argsort(rest[work.a[inner]], kind="stable")
    inner, owner = inner[order], rest[work.a[inner[order]]]
    for patch in _groups(rest):
        low, high = np.searchsorted(owner, [rest[patch[0]], rest[patch[0]] + 1])
        out.append(freeform(work, patch, inner[low:high]))
    return out


def _inner(work: Patchwork, number: Ints, polygons: Ints) -> Ints:
    """Smooth edges inside the patch that these polygons are."""
    _, edges = work.sides.expand(polygons)
    edges = np.unique(edges)
    edges = edges[work.smooth[edges]]
    inside: Ints = edges[number[work.a[edges]] == number[work.b[edges]]]
    return inside


def _groups(numbers: Ints) -> list[Ints]:
    """Polygons of each number, ascending."""
    member = np.flatnonzero(numbers >= 0)
    if not len(member):
        return []
    ordered = member[np.argsort(numbers[member], kind="stable")]
    cuts = np.flatnonzero(np.diff(numbers[ordered])) + 1
    return list(np.split(ordered, cuts))


def _assemble(
    mesh: Mesh, work: Patchwork, descriptions: list[Description], order: Ints, centre: Array, diagonal: float
) -> MeshSurfaces:
    """Back to metres and to the mesh's own facets, in the promised order."""
    owner = np.full(work.count, -1)
    for number, item in enumerate(descriptions):
        owner[item.polygons] = number
    facet_owner = np.empty(len(order), np.int64)
    facet_owner[order] = owner[work.polygon]
    area = np.bincount(owner[work.polygon], work.facet_area, len(descriptions))
    first = np.full(len(descriptions), len(order))
    np.minimum.at(first, facet_owner, np.arange(len(order)))
    rank = np.lexsort((first, -area))
    position = np.empty(len(rank), np.int64)
    position[rank] = np.arange(len(rank))
    labels = position[facet_owner]
    faces = _groups(labels)
    surfaces = tuple(_surface(descriptions[k], float(area[k]), faces[i], centre, diagonal) for i, k in enumerate(rank))
    squares = sum(item.squares for item in descriptions)
    samples = sum(item.samples for item in descriptions)
    noise = diagonal * float(np.sqrt(squares / samples)) if samples else 0.0
    freeze(labels)
    return MeshSurfaces(mesh.digest, surfaces, labels, noise)


def _surface(item: Description, area: float, faces: Ints, centre: Array, diagonal: float) -> Surface:
    located = item.kind != "freeform"
    point = item.point * diagonal + centre if located else np.zeros(3)
    axis = item.axis + 0.0
    for array in (axis, point, faces):
        freeze(array)
    return Surface(
        kind=item.kind,
        axis=axis,
        point=point,
        radius=item.radius * diagonal,
        half_angle=item.half_angle,
        minor_radius=item.minor_radius * diagonal,
        pitch=item.pitch * diagonal,
        side=item.side,
        area=area * diagonal**2,
        extent=(item.extent[0] * diagonal, item.extent[1] * diagonal),
        sweep=item.sweep,
        residual=item.residual * diagonal,
        axis_uncertainty=item.axis_uncertainty,
        point_uncertainty=item.point_uncertainty * diagonal,
        chord=item.chord * diagonal,
        faces=faces,
    )
