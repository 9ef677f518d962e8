"""Standard parts by name, shape and copies: screws, nuts, washers, pins, circlips, balls, bearings.

By name as `standard_names` tells. By shape, a screw is a head and a longer, thinner shank about one axis, a washer a
flat ring, a pin a plain rod, a ball a sphere; as knobs, wheels and spacers have these shapes, too, they count only
with copies of the same part, or with the drive of a screw.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

import numpy as np

from kinform.foundation.algebra.vectors import norm
from kinform.foundation.words import counted
from kinform.frozen import dataclass
from kinform.kinematics.partition.constants import COAXIAL_OFF, SAME_AXIS
from kinform.kinematics.partition.standard_names import StandardKind, kind_by_name
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part
from kinform.model.names import PartName
from kinform.model.surfaces import MeshSurfaces, Surface

ALL_ROUND = np.radians(300.0)
"""rad: what of a cylinder is there at least where it tells what a part is. Chosen, not measured."""
TURNED = 0.9
"""Share of its area that lies about one axis, across it or flat along it, of screws, nuts, washers and pins. Chosen,
not measured."""
HEAD = (1.25, 2.6)
"""Radius of a screw's head by that of its shank: 1.5 to 2.2 in the standards."""
SHANK = 1.0
"""Length of a screw's shank at least, by its radius. Chosen, not measured."""


HOLDERS = ("screw", "nut", "washer", "rivet", "circlip")
"""Kinds that hold other parts together; pins may be pivots."""


@dataclass(frozen=True)
class StandardPart:
    """What a part is, and how that was told."""

    kind: StandardKind
    evidence: str


def standard_parts(assembly: Assembly, surfaces: Mapping[str, MeshSurfaces]) -> dict[PartName, StandardPart]:
    """The standard parts of an assembly, by name."""
    copies = Counter(_alike(part) for part in assembly.parts if part.mesh is not None)
    out = {}
    for part in sorted(assembly.parts, key=lambda part: part.name):
        found = _by_name(part.name)
        if found is None and part.mesh is not None and part.mesh.digest in surfaces:
            found = by_shape(surfaces[part.mesh.digest].surfaces, copies[_alike(part)])
        if found is not None:
            out[part.name] = found
    return out


def _alike(part: Part) -> tuple[int, float]:
    """What copies have in common, however they were placed: facets, and volume to five digits."""
    assert part.mesh is not None
    return len(part.mesh.faces), float(f"{abs(part.mesh.health.volume or 0.0):.5g}")


def _by_name(name: str) -> StandardPart | None:
    found = kind_by_name(name)
    return None if found is None else StandardPart(*found)


def by_shape(surfaces: Sequence[Surface], copies: int) -> StandardPart | None:
    """By its surfaces, and by how many parts are like it."""
    total = sum(surface.area for surface in surfaces)
    # Share of its area that is one sphere, of a ball. Chosen, not measured.
    if sum(s.area for s in surfaces if s.kind == "sphere" and s.side > 0) > 0.9 * total:
        return StandardPart("ball", f"a sphere, {counted(copies, 'copy', 'copies')}") if copies >= 3 else None
    round_ = [s for s in surfaces if s.kind == "cylinder" and s.sweep > ALL_ROUND]
    if not round_:
        return None
    main = max(round_, key=lambda s: s.area)
    if _turned(surfaces, main) < TURNED * total:
        return None
    rods = [s for s in round_ if s.side > 0 and _coaxial(s, main)]
    bores = [s for s in round_ if s.side < 0 and _coaxial(s, main)]
    hexagon = _hexagon(surfaces, main.axis)
    many = f"{counted(copies, 'copy', 'copies')} of it"
    if not rods:
        flats = _flats(surfaces, main)
        wide = 2.0 * max(flats, default=0.0)
        # Height of a nut at most, by its width across flats: beyond, it is a spacer. Standard nuts have 0.4 to 0.9.
        nut = len(bores) == 1 and hexagon and len(flats) == 6 and _reach(surfaces, main.axis) < 1.3 * wide
        return StandardPart("nut", f"a hexagon with a bore, {many}") if nut and copies >= 2 else None
    high, low = max(s.radius for s in rods), min(s.radius for s in rods)
    length = max(s.extent[1] - s.extent[0] for s in rods if s.radius == low)
    whole = _reach(surfaces, main.axis)
    if bores:
        # Height of a washer at most, as a share of its outer radius. Chosen, not measured.
        flat = whole < 0.3 * high and len(rods) == len(bores) == 1 and not hexagon
        return StandardPart("washer", f"a flat ring, {many}") if flat and copies >= 3 else None
    head = HEAD[0] * low <= high <= HEAD[1] * low and length >= SHANK * low
    if head and (hexagon or copies >= 3):
        drive = "with a hexagon, " if hexagon else ""
        return StandardPart("screw", f"a head and a shank, {drive}{many}")
    if hexagon and len(rods) == 1 and length >= SHANK * low and copies >= 2:
        return StandardPart("screw", f"a hexagon and a shank, {many}")
    # Length of a pin at least, by its radius. Chosen, not measured.
    if len(rods) == 1 and whole >= 2.0 * high and copies >= 3 and not hexagon:
        only = sum(s.area for s in surfaces if s.kind in ("cylinder", "plane", "cone", "torus"))
        plain = only > 0.98 * total and len([s for s in surfaces if s.kind == "plane"]) == 2
        return StandardPart("pin", f"a plain rod, {many}") if plain else None
    return None


def _flats(surfaces: Sequence[Surface], main: Surface) -> list[float]:
    """m: how far the planes along the axis of the main cylinder lie beside it."""
    beside = [s for s in surfaces if s.kind == "plane" and abs(float(s.axis @ main.axis)) < 0.05]
    return [abs(float((s.point - main.point) @ s.axis)) for s in beside]


def _turned(surfaces: Sequence[Surface], main: Surface) -> float:
    """m²: what is turned about the axis of its main cylinder, lies across it, or is a flat along it close by."""
    rods = [s.radius for s in surfaces if s.kind == "cylinder" and s.side > 0 and _coaxial(s, main)]
    flats = _flats(surfaces, main)
    reach = max(rods) if rods else max(flats, default=0.0) if len(flats) == 6 else 0.0
    area = 0.0
    for s in surfaces:
        if s.kind == "plane":
            along = abs(float(s.axis @ main.axis))
            close = abs(float((s.point - main.point) @ s.axis)) <= 1.01 * reach
            area += s.area if along > 0.999 or (along < 0.05 and close) else 0.0
        elif s.kind in ("cylinder", "cone", "torus", "revolution", "helicoid"):
            gap = s.point - main.point
            off = norm(gap - (gap @ main.axis) * main.axis)
            on = off < COAXIAL_OFF * main.radius and abs(float(s.axis @ main.axis)) > 0.999
            area += s.area if on else 0.0
        elif s.kind == "sphere":
            gap = s.point - main.point
            area += s.area if norm(gap - (gap @ main.axis) * main.axis) < 0.1 * main.radius else 0.0
    return area


def _coaxial(one: Surface, other: Surface) -> bool:
    gap = one.point - other.point
    off = norm(gap - (gap @ other.axis) * other.axis)
    return abs(float(one.axis @ other.axis)) > np.cos(SAME_AXIS) and off < COAXIAL_OFF * one.radius


def _hexagon(surfaces: Sequence[Surface], axis: Array) -> bool:
    """Whether six planes stand round the axis, at equal distances, 60° from each other."""
    beside = [s for s in surfaces if s.kind == "plane" and abs(float(s.axis @ axis)) < np.sin(SAME_AXIS)]
    if len(beside) < 6:
        return False
    for first in beside:
        turned = [float(s.axis @ first.axis) for s in beside]
        # By how much the cosine between faces of a hexagon may be off. 1.3° on the angle of 60°.
        if all(any(abs(t - c) < 0.02 for t in turned) for c in (1.0, 0.5, -0.5, -1.0)):
            return len(turned) >= 6
    return False


def _reach(surfaces: Sequence[Surface], axis: Array) -> float:
    """How long the part is along its axis, by the planes across it and what is round."""
    ends = [float(s.point @ axis) for s in surfaces if s.kind == "plane" and abs(float(s.axis @ axis)) > 0.999]
    for s in surfaces:
        if s.kind == "cylinder" and abs(float(s.axis @ axis)) > 0.999:
            ends += [float((s.point + t * s.axis) @ axis) for t in s.extent]
    return max(ends) - min(ends) if ends else 0.0
