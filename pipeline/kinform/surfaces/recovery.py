"""The method, from a mesh to its surfaces; `kinform.surfaces` explains it.

Works in unit coordinates (centred, span 1) and in a canonical order of vertices and facets, so that
neither the size of a part nor the order in its file changes what is found.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from kinform.foundation.algebra.vectors import box
from kinform.foundation.constants import EPS32, LITTLE_FACETS
from kinform.foundation.memory import keep_heap, uncollected
from kinform.foundation.records import made
from kinform.foundation.sorting import ascending, coarse
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints, freeze
from kinform.model.assembly import Mesh
from kinform.model.surfaces import MeshSurfaces, Surface
from kinform.model.tolerances import Tolerances
from kinform.surfaces.describe import Description, curved, flat, freeform, patch_chords
from kinform.surfaces.groups import members
from kinform.surfaces.kinds.batch import Batch
from kinform.surfaces.polygons.facets import Facets
from kinform.surfaces.polygons.noise import Scale, Scales
from kinform.surfaces.polygons.patchwork import Patchwork
from kinform.surfaces.regions.candidates import Candidates
from kinform.surfaces.regions.merge import coincident_planes, coincident_regions
from kinform.surfaces.regions.partition import CURVED, Region, partition
from kinform.surfaces.swept.lines import lines, turning_lines
from kinform.surfaces.swept.sliding import sliding
from kinform.surfaces.swept.threads import threads

PACK = 200_000
"""Facets of meshes that are recovered at once, at most. A step of numpy takes as long to begin as for a few hundred
rows: so100 (60,000 facets in 13 meshes) takes 1.0 s of processor in one pack and 2.0 s mesh by mesh; packs of 400,000
gain 7 % over packs of 100,000, those of 200,000 5 %, for 140 and 60 MB more."""


def recover(mesh: Mesh, tolerances: Tolerances) -> MeshSurfaces:
    """The surfaces of a welded mesh; what no analytic surface explains is freeform.

    Every facet belongs to exactly one surface. The mesh need not be closed. Results are in the part
    frame (m, rad), by descending area, then lowest facet index.
    """
    return recover_all([mesh], tolerances)[0]


@uncollected()
def recover_all(meshes: Sequence[Mesh], tolerances: Tolerances) -> list[MeshSurfaces]:
    """`recover` of each mesh, to the same bits, in fewer and larger steps: most of the time of a small mesh goes into
    beginning steps. Nothing that is made here is in a cycle, so that none are searched for."""
    keep_heap()
    solid = [_is_solid(mesh) for mesh in meshes]
    starts = [_Start.of(mesh, tolerances) for mesh, there in zip(meshes, solid, strict=True) if there]
    described = iter(_describe_all(starts)) if starts else iter(())
    begun = iter(starts)
    return [
        _assemble(mesh, next(begun), *next(described))
        if there
        else MeshSurfaces(mesh.digest, (), np.zeros(0, np.int64), 0.0)
        for mesh, there in zip(meshes, solid, strict=True)
    ]


def packs(facets: Sequence[int], jobs: int = 1) -> list[list[int]]:
    """Positions of meshes of so many facets, the largest first, in packs that `recover_all` takes at once: none of more
    than `constants.PACK` facets in which there are several meshes, and as many as jobs where there is enough to do."""
    several = jobs > 1 and sum(facets) > LITTLE_FACETS
    most = min(PACK, sum(facets) // jobs) if several else PACK
    out: list[list[int]] = []
    held = most + 1
    for k in sorted(range(len(facets)), key=lambda k: -facets[k]):
        if held + facets[k] > most:
            out.append([])
            held = 0
        out[-1].append(k)
        held += facets[k]
    return out


def _is_solid(mesh: Mesh) -> bool:
    return bool(len(mesh.faces) and mesh.diagonal > 0 and np.isfinite(mesh.vertices).all())


@dataclass(frozen=True, eq=False)
class _Start:
    """A mesh in unit coordinates, in polygons."""

    work: Patchwork
    scale: Scale
    order: Ints
    """(F,) number in the file of each facet."""
    centre: Array
    span: float

    @classmethod
    def of(cls, mesh: Mesh, tolerances: Tolerances) -> _Start:
        """That of a mesh with extent."""
        rounding = max(EPS32 * float(np.abs(mesh.vertices).max()), mesh.resolution)
        low, high = box(mesh.vertices)
        centre = (low + high) / 2
        size = mesh.size.span
        vertices, faces, order = _canonical_order((mesh.vertices - centre) / size, mesh.faces)
        facets = Facets.of(vertices, faces)
        scale = Scale.of(facets, rounding / size, tolerances)
        return cls(Patchwork.of(facets, scale, tolerances), scale, order, centre, size)


def _canonical_order(vertices: Array, faces: Ints) -> tuple[Array, Ints, Ints]:
    """(vertices, faces, original number of each face), sorted by coordinates."""
    by_place = np.lexsort(vertices.T[::-1])
    place = np.empty(len(vertices), np.int64)
    place[by_place] = np.arange(len(vertices))
    a, b, c = (place.take(faces[:, k]) for k in range(3))
    first, second = (a <= b) & (a <= c), (b < a) & (b <= c)
    corners = [np.where(first, x, np.where(second, y, z)) for x, y, z in ((a, b, c), (b, c, a), (c, a, b))]
    order = ascending(corners[2], len(vertices))
    for corner in (corners[1], corners[0]):
        order = order.take(ascending(corner.take(order), len(vertices)))
    return vertices.take(by_place, axis=0), np.stack([corner.take(order) for corner in corners], axis=1), order


def _describe_all(starts: Sequence[_Start]) -> list[tuple[list[Description], Ints]]:
    """(surfaces, number of that of each polygon) of every mesh: curved ones, threads, planes, what slides on itself in
    one way, and freeform patches, each among what those before it left.

    The surfaces' polygons are those of all meshes joined.
    """
    joint, scales = Patchwork.joined([start.work for start in starts]), Scales.of([start.scale for start in starts])
    ends = np.cumsum([0, *(start.work.count for start in starts)]).tolist()
    runs = [slice(*run) for run in zip(ends, ends[1:], strict=False)]
    found: list[list[Description]] = [[] for _ in starts]

    def add(surfaces: Iterable[Description]) -> None:
        for surface in surfaces:
            found[joint.mesh.item(surface.polygons[0])].append(surface)

    parts = partition(joint, scales)
    for kind in CURVED:
        regions = [region for region in parts.regions if region.kind is kind]
        regions.sort(key=lambda region: int(joint.mesh[region.polygons[0]]))
        add(_surfaces_of_kind(joint, regions, scales) if regions else ())
    planes, patches = parts.planes, parts.freeform
    # Share of the area of a mesh below which a plane may be a facet of a thread. Chosen, not measured.
    loose = (patches >= 0) | ((planes >= 0) & (joint.area < 2e-2 * joint.total[joint.mesh]))
    for start, run, others, turning in zip(starts, runs, list(found), turning_lines(joint, loose), strict=True):
        for thread in threads(start.work, loose[run], lines(joint, others, turning), start.scale):
            polygons = thread.polygons + run.start
            add([thread._replace(polygons=polygons)])
            planes[polygons] = patches[polygons] = -1
    add(flat(joint, _planes(starts, planes, runs), scales))
    chords = patch_chords(joint, patches)
    for surface in sliding(joint, patches, scales):
        add([surface._replace(chord=float(chords[patches[surface.polygons]].max()))])
        patches[surface.polygons] = -1
    add(freeform(patch, float(chords[patches[patch[0]]])) for patch in members(patches))
    owner = _owners(found, joint.count)
    return [(surfaces, owner[run]) for surfaces, run in zip(found, runs, strict=True)]


def _planes(starts: Sequence[_Start], planes: Ints, runs: Sequence[slice]) -> Ints:
    """(P,) numbers of the planes of all meshes, of polygons with any number from 0 on; -1 elsewhere."""
    out = np.full(len(planes), -1)
    count: int = 0
    for start, run in zip(starts, runs, strict=True):
        there = np.flatnonzero(planes[run] >= 0)
        alone = np.full(start.work.count, -1)
        alone[there] = np.arange(len(there))
        out[run][there] = coincident_planes(start.work, alone, start.scale)[there] + count
        count += len(there)
    return out


def _owners(found: Sequence[Sequence[Description]], count: int) -> Ints:
    """(P,) number in its mesh of the surface of each polygon."""
    polygons = [surface.polygons for surfaces in found for surface in surfaces]
    numbers = np.concatenate([np.arange(len(surfaces)) for surfaces in found])
    owner = np.full(count, -1)
    owner[np.concatenate(polygons)] = numbers.repeat([len(mine) for mine in polygons])
    return owner


def _surfaces_of_kind(work: Patchwork, regions: list[Region], scales: Scales) -> list[Description]:
    """The surfaces of regions of one kind, sorted by mesh, those that are one surface put together."""
    fit = scales.fit[[work.mesh[region.polygons[0]] for region in regions]]
    polygons = [region.polygons for region in regions]
    surfaces = Candidates(
        regions[0].kind,
        np.array([region.params for region in regions]),
        np.array([region.side for region in regions]),
        fit,
    )
    root = coincident_regions(work, surfaces, polygons, scales)
    heads, group = np.unique(root, return_inverse=True)
    keys = np.repeat(group, [len(p) for p in polygons]) * np.int64(work.count) + np.concatenate(polygons)
    batch = Batch.of_keys(work, np.sort(keys), len(heads))
    loosest = np.zeros(len(heads))
    np.maximum.at(loosest, group, np.array([region.tolerance for region in regions]))
    several = np.bincount(group) > 1
    loosest[several] = fit[heads][several]
    return curved(surfaces.of(heads).within(loosest), batch, scales.at(batch.mesh))


def _assemble(mesh: Mesh, start: _Start, descriptions: list[Description], owner: Ints) -> MeshSurfaces:
    """Back to metres and to the mesh's own facets, in the promised order; `owner` says which surface each polygon is
    of."""
    work, order, centre, span = start.work, start.order, start.centre, start.span
    facet_owner = np.empty(len(order), np.int64)
    facet_owner[order] = owner[work.polygon]
    area: Array = np.bincount(owner[work.polygon], work.facet_area, len(descriptions)).astype(float)
    first = np.full(len(descriptions), len(order))
    np.minimum.at(first, facet_owner, np.arange(len(order)))
    rank = np.lexsort((first, -coarse(area)))
    position = np.empty(len(rank), np.int64)
    position[rank] = np.arange(len(rank))
    labels = position[facet_owner]
    squares = sum(item.squares for item in descriptions)
    samples = sum(item.samples for item in descriptions)
    noise = span * float(np.sqrt(squares / samples)) if samples else 0.0
    surfaces = _surfaces([descriptions[k] for k in rank.tolist()], area[rank] * span**2, members(labels), centre, span)
    freeze(labels)
    return MeshSurfaces(mesh.digest, surfaces, labels, noise)


def _surfaces(
    items: list[Description], areas: Array, faces: list[Ints], centre: Array, span: float
) -> tuple[Surface, ...]:  # fmt: skip
    """The surfaces in metres, in this order; `areas` are in square metres."""
    axes = np.array([item.axis for item in items]) + 0.0
    points = np.array([item.point for item in items]) * span + centre
    points[[item.kind == "freeform" for item in items]] = 0.0
    freeze(axes)
    freeze(points)
    return tuple(
        _surface(item, axis, point, size, freeze(mine), span)
        for item, axis, point, size, mine in zip(items, axes, points, areas.tolist(), faces, strict=True)
    )


def _surface(item: Description, axis: Array, point: Array, area: float, faces: Ints, span: float) -> Surface:
    return made(
        Surface,
        kind=item.kind,
        axis=axis,
        point=point,
        radius=item.radius * span,
        half_angle=item.half_angle,
        side=item.side,
        area=area,
        extent=(item.extent[0] * span, item.extent[1] * span),
        sweep=item.sweep,
        residual=item.residual * span,
        axis_uncertainty=item.axis_uncertainty,
        point_uncertainty=item.point_uncertainty * span,
        chord=item.chord * span,
        faces=faces,
        minor_radius=item.minor_radius * span,
        pitch=item.pitch * span,
    )
