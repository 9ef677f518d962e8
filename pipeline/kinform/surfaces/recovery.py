"""The method, from a mesh to its surfaces; `kinform.surfaces` explains it.

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
from kinform.surfaces.constants import EPS32, THREAD_FACET
from kinform.surfaces.describe import Description, curved, flat, freeform
from kinform.surfaces.groups import distinct, members
from kinform.surfaces.kinds.kind import Batch
from kinform.surfaces.polygons.facets import Facets
from kinform.surfaces.polygons.noise import Scale
from kinform.surfaces.polygons.patchwork import Patchwork
from kinform.surfaces.regions.candidates import Candidates
from kinform.surfaces.regions.merge import coincident_planes, coincident_regions
from kinform.surfaces.regions.partition import CURVED, Partition, Region, partition
from kinform.surfaces.swept.sliding import sliding
from kinform.surfaces.swept.threads import threads

LENGTHS = ("radius", "minor_radius", "pitch", "residual", "point_uncertainty", "chord")
NUMBERS = ("kind", "half_angle", "side", "sweep", "axis_uncertainty")
"""Fields of a description that are scaled with the mesh, and that are not."""


def recover(mesh: Mesh, tolerances: Tolerances) -> MeshSurfaces:
    """The surfaces of a welded mesh; what no analytic surface explains is freeform.

    Every facet belongs to exactly one surface. The mesh need not be closed. Results are in the part
    frame (m, rad), by descending area, then lowest facet index.
    """
    diagonal = mesh.diagonal
    if not len(mesh.faces) or diagonal <= 0 or not np.isfinite(mesh.vertices).all():
        return MeshSurfaces(mesh.digest, (), np.zeros(0, np.int64), 0.0)
    rounding = max(EPS32 * float(np.abs(mesh.vertices).max()), mesh.resolution)
    centre = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
    vertices, faces, order = _canonical_order((mesh.vertices - centre) / diagonal, mesh.faces)
    facets = Facets.of(vertices, faces)
    scale = Scale.of(facets, rounding / diagonal, tolerances)
    work = Patchwork.of(facets, scale, tolerances)
    descriptions = _describe(work, partition(work, scale), scale)
    return _assemble(mesh, work, descriptions, order, centre, diagonal)


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
    """Merges what is one surface and measures every surface: curved ones, threads, planes, what slides on itself in one
    way, and freeform patches, each among what those before it left."""
    out: list[Description] = []
    for kind in CURVED:
        regions = [region for region in parts.regions if region.kind is kind]
        if regions:
            out += _surfaces_of_kind(work, regions, scale)
    rest, alone = parts.freeform.copy(), parts.planes.copy()
    small = (alone >= 0) & (work.area < THREAD_FACET * work.area.sum())
    for thread in threads(work, (rest >= 0) | small, out, scale):
        out.append(thread)
        rest[thread.polygons] = alone[thread.polygons] = -1
    alone[alone >= 0] = np.unique(alone[alone >= 0], return_inverse=True)[1]
    out += flat(work, coincident_planes(work, alone, scale), scale)
    for surface in sliding(work, rest, scale):
        chord = freeform(work, surface.polygons, _inner(work, rest, surface.polygons)).chord
        out.append(replace(surface, chord=chord))
        rest[surface.polygons] = -1
    return out + [freeform(work, patch, _inner(work, rest, patch)) for patch in members(rest)]


def _surfaces_of_kind(work: Patchwork, regions: list[Region], scale: Scale) -> list[Description]:
    """The surfaces of regions of one kind, those that are one surface put together."""
    polygons = [region.polygons for region in regions]
    surfaces = Candidates(
        regions[0].kind,
        np.array([region.params for region in regions]),
        np.array([region.side for region in regions]),
        np.full(len(regions), scale.fit),
    )
    root = coincident_regions(work, surfaces, polygons, scale)
    heads, group = np.unique(root, return_inverse=True)
    keys = np.repeat(group, [len(p) for p in polygons]) * np.int64(work.count) + np.concatenate(polygons)
    batch = Batch.of_keys(work, np.sort(keys), len(heads))
    loosest = np.zeros(len(heads))
    np.maximum.at(loosest, group, np.array([region.tolerance for region in regions]))
    loosest[np.bincount(group) > 1] = scale.fit
    return curved(surfaces.of(heads).within(loosest), batch, scale)


def _inner(work: Patchwork, number: Ints, polygons: Ints) -> Ints:
    """Smooth edges inside the patch that these polygons are."""
    _, edges = work.sides.expand(polygons)
    edges = distinct(edges)
    edges = edges[work.smooth[edges]]
    inside: Ints = edges[number[work.a[edges]] == number[work.b[edges]]]
    return inside


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
    faces = members(labels)
    surfaces = tuple(_surface(descriptions[k], float(area[k]), faces[i], centre, diagonal) for i, k in enumerate(rank))
    squares = sum(item.squares for item in descriptions)
    samples = sum(item.samples for item in descriptions)
    noise = diagonal * float(np.sqrt(squares / samples)) if samples else 0.0
    freeze(labels)
    return MeshSurfaces(mesh.digest, surfaces, labels, noise)


def _surface(item: Description, area: float, faces: Ints, centre: Array, diagonal: float) -> Surface:
    lengths = {name: getattr(item, name) * diagonal for name in LENGTHS}
    numbers = {name: getattr(item, name) for name in NUMBERS}
    return Surface(
        axis=freeze(item.axis + 0.0),
        point=freeze(item.point * diagonal + centre if item.kind != "freeform" else np.zeros(3)),
        extent=(item.extent[0] * diagonal, item.extent[1] * diagonal),
        area=area * diagonal**2,
        faces=freeze(faces),
        **numbers,
        **lengths,
    )
