"""Whether parts that contact lets go leave the assembly along a straight line."""

from __future__ import annotations

import math
from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace

import numpy as np

from kinform.collisions.driving.alone import slide_end
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.algebra.vectors import perpendicular
from kinform.foundation.rounding import SINGLE
from kinform.kinematics.mobility.guides import overlap_along, preserved
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.requirements.evidence import WayOut

MOST_FACES = 4
"""Directions of faces that are looked along: of a box there are three. Chosen, not measured."""
HALF_ROUND = math.radians(1.0)
"""rad by which what goes round a part has to be more than a half. Chosen, not measured: normals of meshes are off by
less."""


def way_out(shapes: Shapes, parts: Sequence[str], direction: Array) -> WayOut:
    """How far the parts go together along the unit direction (3,), all others at rest."""
    meshed = {name for names in shapes.body_parts.values() for name in names}
    moving = sorted(meshed.intersection(parts))
    still = sorted(meshed.difference(parts))
    if not moving:
        return WayOut("unknown", reason="it has no mesh")
    end = slide_end(shapes, direction, still, moving)
    if end.status == "unknown" or end.value is None:
        return WayOut("free" if end.status == "unbounded" else "unknown", reason=end.reason)
    guides = _guides(shapes, moving, direction)
    if any(_tight(shapes, guide) for guide in guides if {*guide.parts} == {*end.parts}):
        first, second = end.parts
        return WayOut("unknown", reason=f"'{first}' and '{second}' are pressed into each other, and friction may hold")
    if shapes.contacts is not None and shapes.overlapping(*end.parts):
        return WayOut("unknown", reason=f"'{end.parts[0]}' and '{end.parts[1]}' overlap as drawn")
    stopped_by = tuple(str(part) for part in end.parts if part in still)
    return WayOut("stopped", end.value, _guided(shapes, guides, set(moving), direction), stopped_by)


def face_normals(shapes: Shapes, parts: Sequence[str]) -> Array:
    """(k, 3) unit normals, up to sign, of the largest flat faces of parts: the directions in which gaps beside them and
    channels that they fit run. Sorted by area."""
    found: list[tuple[float, Array]] = []
    for name in parts:
        part = shapes.part(name)
        known = None if part.mesh is None else shapes.surfaces.get(part.mesh.digest)
        flat = [] if known is None else [surface for surface in known.surfaces if surface.kind == "plane"]
        found += [(float(surface.area), part.X_WP[:3, :3] @ surface.axis) for surface in flat]
    out: list[Array] = []
    for _, normal in sorted(found, key=lambda item: -item[0]):
        if all(abs(float(normal @ other)) < math.cos(HALF_ROUND) for other in out):
            out.append(normal)
    return np.array(out[:MOST_FACES]).reshape(-1, 3)


def displaced(shapes: Shapes, parts: Sequence[str], by: Array) -> Shapes:
    """The meshes with some parts displaced (3,) m to where they have left their contacts."""
    moving = set(parts)
    shift = np.eye(4)
    shift[:3, 3] = by
    placed = tuple(
        replace(part, X_WP=shift @ part.X_WP) if part.name in moving else part for part in shapes.assembly.parts
    )
    return Shapes(replace(shapes.assembly, parts=placed), shapes.surfaces, None, shapes.body_parts)


def _guides(shapes: Shapes, moving: Sequence[str], direction: Array) -> list[Patch]:
    """The contacts along which the parts slide."""
    twist, of = np.concatenate([np.zeros(3), direction])[None], set(moving)
    patches = () if shapes.contacts is None else shapes.contacts.patches
    return [p for p in patches if len(of.intersection(p.parts)) == 1 and len(p.points) and preserved(p, twist)]


def _guided(shapes: Shapes, guides: Sequence[Patch], moving: AbstractSet[str], direction: Array) -> float:
    """m up to which the contacts that are not left yet keep the parts on the line; 0 where they never do."""
    assembly, surfaces, _ = shapes.design()
    spans = [overlap_along(assembly, surfaces, [guide], direction, moving) for guide in guides]
    ends = {k: span[1] for k, span in enumerate(spans) if span is not None and span[1] > 0.0}
    across = np.stack(perpendicular(direction), axis=1)
    for end in sorted(set(ends.values()), reverse=True):
        normals = [
            g.normals if g.parts[1] in moving else -g.normals for k, g in enumerate(guides) if ends.get(k, 0.0) >= end
        ]
        if _surround(np.concatenate(normals) @ across):
            return end
    return 0.0


def _surround(normals: Array) -> bool:
    """Whether directions (n, 2) leave no way that goes against none of them."""
    angles = np.sort(np.arctan2(normals[:, 1], normals[:, 0]))
    gaps = np.diff(np.append(angles, angles[0] + 2.0 * np.pi))
    return bool(gaps.max() < np.pi - HALF_ROUND)


def _tight(shapes: Shapes, guide: Patch) -> bool:
    """Whether the two parts press on each other where one slides along the other: by more than rounding of meshes."""
    return guide.gap < -SINGLE * min(shapes.mesh(name).diagonal for name in guide.parts)
