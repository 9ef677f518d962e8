"""Meshes of another unit: that many times larger or smaller, and right where they are read so.

One part, or all meshes of a description beside the frames of its joints. What a mesh file in another unit looks like is
known: the factors of `FACTORS`. A factor is proposed where surfaces of the scaled mesh mate with others, and is a cause
only where rules that are asked again find less and nothing worse.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from kinform.consistency.causes.asking import OF_JOINTS, Again, Asked, asked, changed, is_serious, overlapping
from kinform.consistency.causes.displaced import SURFACES, surface_count
from kinform.consistency.causes.mates import mates_of
from kinform.consistency.causes.movable import parts_of
from kinform.consistency.comparisons.answers import answers
from kinform.consistency.context import Context
from kinform.design import Design
from kinform.frozen import dataclass
from kinform.model.arrays import freeze
from kinform.model.assembly import Mesh, Part
from kinform.model.findings import Finding
from kinform.model.surfaces import MeshSurfaces, Surface

FACTORS = (1e-3, 1e3, 1.0 / 25.4, 25.4, 0.1, 10.0, 25.4e-3, 1.0 / 25.4e-3, 1e-2, 1e2)
"""By which a mesh has to be multiplied: metres and millimetres, inches and millimetres, centimetres and millimetres,
inches and metres, centimetres and metres."""
PARTS_TRIED = 6
"""Parts that are tried, at most: the ones that most findings are about."""
TRIED = 10
"""Hypotheses of which contacts are looked for, at most."""
MOST_PARTS = 300
"""Parts of a design of which this is asked, at most."""
LEAST = 0.75
"""Of what mates more: one shaft in its bore, or two of planes and bores in line. One plane alone is chance."""
SMALLEST = 2
"""Links with findings from which all meshes of a description may be of another unit."""


@dataclass(frozen=True, eq=False)
class Scaled:
    """A factor that is proved, for these parts, and what it resolves."""

    parts: tuple[str, ...]
    factor: float
    whole: bool
    """All meshes of a description."""
    asked: Asked


def scaled(context: Context, findings: Sequence[Finding], again: Again) -> Scaled | None:
    """The factor that resolves most, if any does."""
    proved: list[Scaled] = []
    if len(context.assembly.parts) > MOST_PARTS:
        return None
    for count, (names, factor, whole) in enumerate(_hypotheses(context, findings)):
        if count >= TRIED:
            break
        parts = [context.assembly.part(name) for name in names]
        design = changed(context, *_scaled_parts(context, parts, factor))
        if not whole and not overlapping(design) <= overlapping(context.design):
            continue
        found = asked(design, findings, again)
        if found is None:
            continue
        agrees = _agreeing(found.design) > _agreeing(context.design)
        if agrees or (not whole and any(map(is_serious, found.resolved))):
            proved.append(Scaled(names, factor, whole, found))
            if not any(map(is_serious, found.findings)):
                break
    return max(proved, key=lambda one: one.asked.weight, default=None)


def _agreeing(design: Design) -> int:
    """How many stated joints the geometry agrees with."""
    return sum(one.answer == "agrees" for one in answers(design))


def _hypotheses(context: Context, findings: Sequence[Finding]) -> Iterator[tuple[tuple[str, ...], float, bool]]:
    """Parts and factors, those after which most surfaces mate first."""
    of_links = bool(context.assembly.descriptions)
    serious = [f for f in findings if is_serious(f) or (of_links and f.code in OF_JOINTS)]
    for description in context.assembly.descriptions:
        names = tuple(sorted(name for link in description.links for name in link.parts if _has_mesh(context, name)))
        about = {name for f in serious for word in f.subject for name in parts_of(context, word)} & set(names)
        if len(about) >= SMALLEST and len(names) > 1:
            for factor in FACTORS[:4]:
                yield names, factor, True
    for finding in serious:
        if finding.code == "KF110":
            names = tuple(name for name in finding.subject if name in context.assembly.named_parts)
            if names and all(_has_mesh(context, name) for name in names):
                yield from ((names, factor, False) for factor in FACTORS[:2])
    counts: dict[str, int] = {}
    for finding in serious:
        for name in {part for word in finding.subject for part in parts_of(context, word)}:
            counts[name] = counts.get(name, 0) + 1
    most = sorted(counts, key=lambda name: (-counts[name], name))[:PARTS_TRIED]
    ranked = []
    for place, name in enumerate(most):
        part = context.assembly.part(name)
        if part.mesh is None:
            continue
        others = [other for other in context.assembly.parts if other is not part and other.mesh is not None]
        if surface_count(context, [part]) * surface_count(context, others) > SURFACES / len(FACTORS):
            continue
        now = _mating(context, part, others, 1.0)
        for number, factor in enumerate(FACTORS):
            mating = _mating(context, part, others, factor)
            if mating > max(now, LEAST):
                ranked.append((-mating, place, number, name))
    for _, _, number, name in sorted(ranked):
        yield (name,), FACTORS[number], False


def _mating(context: Context, part: Part, others: Sequence[Part], scale: float) -> float:
    """How many surfaces of a part mate with those of others where it is so many times as large, by a half those that
    are not firm."""
    mates = mates_of([part], others, context.design.surfaces, scale)
    met = mates.met(np.zeros(3))
    return float((met & mates.firm).sum()) + 0.5 * float((met & ~mates.firm).sum())


def _has_mesh(context: Context, name: str) -> bool:
    return context.assembly.part(name).mesh is not None


def _scaled_parts(context: Context, parts: Sequence[Part], factor: float) -> tuple[list[Part], dict[str, MeshSurfaces]]:
    """The parts with scaled meshes, and the surfaces of these."""
    surfaces, meshes = dict[str, MeshSurfaces](), dict[str, Mesh]()
    scaled_parts = []
    for part in parts:
        assert part.mesh is not None
        old = part.mesh.digest
        if old not in meshes:
            mesh = meshes[old] = _scaled_mesh(part.mesh, factor)
            known = context.design.surfaces[old]
            of_mesh = tuple(_scaled_surface(surface, factor) for surface in known.surfaces)
            surfaces[mesh.digest] = replace(known, digest=mesh.digest, surfaces=of_mesh, noise=factor * known.noise)
        # the part frame is off the origin of the file by `origin`, which is scaled as well
        X = part.X_WP.copy()
        X[:3, 3] += X[:3, :3] @ ((factor - 1.0) * part.mesh.origin)
        scaled_parts.append(replace(part, mesh=meshes[old], X_WP=freeze(X), scale=factor * part.scale))
    return scaled_parts, surfaces


def _scaled_mesh(mesh: Mesh, factor: float) -> Mesh:
    vertices = mesh.vertices * factor
    health = replace(mesh.health, volume=mesh.health.volume * factor**3, weld=mesh.health.weld * factor)
    digest = hashlib.sha256(f"{mesh.digest} times {factor!r}".encode()).hexdigest()
    return replace(
        mesh, vertices=freeze(vertices), health=health, digest=digest, origin=freeze(mesh.origin * factor),
        resolution=mesh.resolution * factor,
    )  # fmt: skip


def _scaled_surface(surface: Surface, factor: float) -> Surface:
    return replace(
        surface,
        point=freeze(surface.point * factor),
        radius=surface.radius * factor,
        area=surface.area * factor**2,
        extent=(surface.extent[0] * factor, surface.extent[1] * factor),
        residual=surface.residual * factor,
        point_uncertainty=surface.point_uncertainty * factor,
        chord=surface.chord * factor,
        minor_radius=surface.minor_radius * factor,
        pitch=surface.pitch * factor,
    )
