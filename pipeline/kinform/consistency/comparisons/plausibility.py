"""Whether the sizes of an assembly can be what the designer meant.

A mesh file carries no unit, so the commonest mistake is a factor of 1000. Contacts, joints and mobility are the same at
any size, and no size proves a mistake; nothing but these doubts depends on it:

- more than 20 m across, or more than 1000 m³ of solid material (8000 t of steel, more than the structure of the
  largest land machines): a warning. A device of 50 mm read in metres is about 50 m across, with some 10 000 m³;
- below 3 mm across, unless the unit is um (then 3 um): a warning;
- one part a hundred times larger than all others together: a warning;
- a part or link whose stated mass would be right if its mesh were a thousand times smaller or larger: an error;
- parts of two sizes, a thousand times apart, with a hundred times between the two sorts: an error. Some are in metres,
  the others in millimetres.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from kinform.consistency.comparisons.links import Weighed, weighed
from kinform.foundation.words import length, mass, number, quoted, volume
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part, Source
from kinform.model.findings import Severity, Witness, computed

LARGE = 20.0
"""Diagonal (m) above which the units are doubted: few machines are larger, and one of 20 mm in metres is. Chosen, not
measured."""
MASSIVE = 1000.0
"""Volume of solid material (m³) above which the units are doubted: 8000 t of steel. Chosen, not measured."""
TINY: Mapping[str, float] = {"um": 3e-6}
"""Diagonal (m) below which the units are doubted, for each unit; `TINY_ELSE` where not listed."""
TINY_ELSE = 3e-3
"""m: few assemblies are smaller, and one of 3 m in millimetres is. Chosen, not measured."""
OUTLIER = 100.0
"""A part so many times larger than all others together is doubted: less than the 1000 between metres and millimetres,
more than a base plate is larger than what stands on it. Chosen, not measured."""
MIXED = 1000.0
"""Parts whose largest is so many times larger than the smallest, with a gap between two sizes of `OUTLIER`, are in
different units: metres and millimetres."""
MIXED_ROUNDING = 1e-3
"""By so much less may they differ: the same part in metres and in millimetres has numbers that are rounded."""
WRONG_SCALE = 1e9
"""By so much a density is off where a mesh is in metres and is in millimetres, or the other way round."""
SCALE_SPREAD = 50.0
"""Factor about `WRONG_SCALE` within which a density says a wrong unit: hulls of 10 to 25 000 kg/m³ are right ones."""
HULL_DENSITY = 500.0
"""kg/m³: mass over the volume of the convex hull, as parts of robots have it; in the middle of what there is."""
SCALE_OUTLIER = 20.0
"""Factor by which a shape with such a density must also be larger or smaller than the middle one of the others: what a
placeholder of a nanogram is stated for is not."""


@dataclass(frozen=True)
class Doubt:
    """One implausible size."""

    severity: Severity
    subject: tuple[str, ...]
    message: str
    found: str
    source: Source
    witness: Witness | None = None
    """Of an error."""


def doubts(assembly: Assembly) -> tuple[Doubt, ...]:
    """What is implausible about the sizes of the assembly and of its parts; stick models by the points
    of their intended joints."""
    scaled = tuple(_scaled(assembly))
    if scaled:
        return scaled
    size = extent(assembly)
    whole = _of_the_whole(assembly, size) if size is not None else None
    mixed = _mixed(assembly)
    if mixed is not None:
        return (mixed,)
    return tuple(_outliers(assembly)) or (() if whole is None else (whole,))  # which part it is says more


def _scaled(assembly: Assembly) -> Iterator[Doubt]:
    """Shapes whose stated mass says that they are off by a thousand: their hull would weigh so much times too little
    or too much."""
    bodies = [body for body in weighed(assembly) if body.size > 0.0]
    for body in bodies:
        if not body.possible or body.hull is None or body.hull.volume <= 0.0:
            continue
        others = sorted(other.size for other in bodies if other is not body)
        middle = others[len(others) // 2] if others else 0.0
        if middle > 0.0 and 1.0 / SCALE_OUTLIER < body.size / middle < SCALE_OUTLIER:
            continue
        density = body.mass / body.hull.volume
        for factor, other in ((WRONG_SCALE, "smaller"), (1.0 / WRONG_SCALE, "larger")):
            if not 1.0 / SCALE_SPREAD < density * factor / HULL_DENSITY < SCALE_SPREAD:
                continue
            text = length(body.size, assembly.units)
            message = (
                f"the geometry of {body.what} is {text} across, and with its stated {mass(body.mass)} that is "
                f"{number(density, 2)} kg/m³; 1000 times {other} it would be {number(density * factor, 2)} kg/m³"
            )
            first = max(body.parts, key=lambda part: 0.0 if part.mesh is None else part.mesh.diagonal)
            yield Doubt(
                "error", (body.name, str(first.name)), message, f"{text} across", first.source,
                _by_density(body, body.hull.volume),
            )  # fmt: skip


def _by_density(body: Weighed, hull: float) -> Witness | None:
    """That no scale but another by a thousand makes its hull as dense as parts are."""
    names = [part.name for part in body.parts if part.mesh is not None]
    if body.mass > HULL_DENSITY * hull:
        densest = HULL_DENSITY * WRONG_SCALE / SCALE_SPREAD
        return computed("density of the hull", body.mass / hull, densest, parts=names, mass=body.mass)
    lightest = HULL_DENSITY / WRONG_SCALE * SCALE_SPREAD
    return computed("hull of a mass", hull / body.mass, 1.0 / lightest, parts=names, mass=body.mass)


def extent(assembly: Assembly) -> float | None:
    """Diagonal (m) of the box around all meshes in their poses, or around the points of the intended
    joints of a stick model; None where there are fewer than two."""
    boxes = _boxes(assembly)
    if boxes:
        corners = np.concatenate(list(boxes.values()))
    else:
        points = [joint.point for joint in assembly.function.joints if joint.point is not None]
        if len(points) < 2:
            return None
        corners = np.array(points)
    return float(np.linalg.norm(np.ptp(corners, axis=0)))


def _of_the_whole(assembly: Assembly, size: float) -> Doubt | None:
    """What is doubtful about an assembly of this size (m): too large, too heavy or too small for its units."""
    units = assembly.units
    tiny = TINY.get(units, TINY_ELSE)
    material = sum(_material(part) for part in assembly.parts)
    across = f"{length(size, units)} across"

    def doubt(message: str, size_found: str = across) -> Doubt:
        return Doubt("warning", (assembly.name,), message, size_found, assembly.source)

    if material > MASSIVE:
        amount = volume(material, units)
        return doubt(
            f"the parts hold {amount} of solid material with units = '{units}': no mechanism is that heavy",
            f"{across}, {amount} of material",
        )
    if size > LARGE:
        return doubt(f"the assembly is {across} with units = '{units}': unusually large for a mechanism")
    if 0.0 < size < tiny:
        return doubt(f"the assembly is only {across} with units = '{units}': unusually small")
    return None


def _mixed(assembly: Assembly) -> Doubt | None:
    """Parts that are all so much larger than the others that the two sorts are in different units."""
    meshed = ((p.mesh.diagonal, p) for p in assembly.parts if p.mesh is not None and p.mesh.diagonal > 0.0)
    sized = sorted(meshed, key=lambda item: (item[0], item[1].name))
    sizes = np.array([size for size, _ in sized])
    apart = np.flatnonzero(sizes[1:] > OUTLIER * sizes[:-1])
    if not len(apart) or sizes[-1] < (1.0 - MIXED_ROUNDING) * MIXED * sizes[0]:
        return None
    small, large = (sized[k] for k in (apart[0], apart[0] + 1))
    few = [part for _, part in (sized[: apart[0] + 1] if 2 * apart[0] < len(sized) - 1 else sized[apart[0] + 1 :])]
    texts = [f"{quoted([part.name])} is {length(size, assembly.units)} across" for size, part in (small, large)]
    message = f"parts are in different units: {texts[0]}, {texts[1]}, and none is between"
    witness = computed("ratio of sizes", large[0] / small[0], OUTLIER, parts=[small[1].name, large[1].name])
    return Doubt("error", tuple(sorted(p.name for p in few)), message, texts[0], few[0].source, witness)


def _outliers(assembly: Assembly) -> Iterator[Doubt]:
    """Parts that dwarf all others together: perhaps their own `units` are wrong."""
    boxes = _boxes(assembly)
    if len(boxes) < 2:
        return
    rests = dict(zip(boxes, _rests(np.array(list(boxes.values()))), strict=True))
    for part in assembly.parts:
        if part.name not in boxes:
            continue
        rest = float(np.linalg.norm(rests[part.name]))
        size = float(np.linalg.norm(np.ptp(boxes[part.name], axis=0)))
        if rest > 0.0 and size > OUTLIER * rest:
            text = length(size, assembly.units)
            message = (
                f"{quoted([part.name])} is {text} across, read with units = '{part.units}', "
                f"and all other parts together {length(rest, assembly.units)}"
            )
            yield Doubt("warning", (part.name,), message, f"{text} across", part.source)


def _rests(boxes: Array) -> Array:
    """(n, 3) sizes of the box around all boxes (n, 2, 3) but one, for each that is left out."""
    none = np.full((1, 3), np.inf)

    def least_of_others(values: Array) -> Array:
        before = np.minimum.accumulate(np.concatenate([none, values[:-1]]))
        after = np.minimum.accumulate(np.concatenate([none, values[:0:-1]]))[::-1]
        return np.asarray(np.minimum(before, after))

    return -least_of_others(-boxes[:, 1]) - least_of_others(boxes[:, 0])


def _boxes(assembly: Assembly) -> dict[str, Array]:
    """Box of each part with a mesh, by name."""
    return {part.name: _box(part) for part in assembly.parts if part.mesh is not None and len(part.mesh.vertices)}


def _box(part: Part) -> Array:
    """(2, 3) corners of the part's box in the world (m)."""
    assert part.mesh is not None
    return np.array(part.mesh.placed_box(part.X_WP))


def _material(part: Part) -> float:
    """Volume of the part's material (m³), 0 when it is not known."""
    if part.mesh is None or not part.solid or not part.mesh.health.watertight:
        return 0.0
    return abs(part.mesh.health.volume)
