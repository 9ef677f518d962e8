"""Whether parts that contact lets go leave the assembly along a straight line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.collisions.driving.alone import slide_end
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.rounding import SINGLE
from kinform.kinematics.mobility.guides import overlap_along, preserved
from kinform.model.arrays import Array
from kinform.model.contacts import Patch
from kinform.requirements.evidence import WayOut


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
    assembly, surfaces, _ = shapes.design()
    span = overlap_along(assembly, surfaces, guides, direction, set(moving))
    left = 0.0 if span is None else max(span[1], 0.0)
    return WayOut("stopped", end.value, left, tuple(str(part) for part in end.parts if part in still))


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


def _tight(shapes: Shapes, guide: Patch) -> bool:
    """Whether the two parts press on each other where one slides along the other: by more than rounding of meshes."""
    return guide.gap < -SINGLE * min(shapes.mesh(name).diagonal for name in guide.parts)
