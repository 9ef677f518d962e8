"""Geometric witnesses, replayed by booleans of manifold3d on the meshes of the results, and distances to their facets.

The finders measure with bounding volume trees of their own or of FCL. Here a depth is that of the deepest corner, or
middle of a facet, of the solid that two parts share: its distance to the surface of the part in which it lies, to all
facets of it. A gap is `min_gap` of manifold3d.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np
from manifold3d import Error, Manifold, Mesh64, OpType

from kinform.design import Design
from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly, Part
from kinform.model.findings import Witness
from kinform.replays.files import Files
from kinform.replays.outcome import NotReplayed, Outcome, held, refuted

FACETS_MOST = 2_000_000
"""Facets of all parts of one witness: as many take a minute."""
PARTS_MOST = 2_000
"""Parts of one witness."""
SAMPLES_MOST = 4_000
"""Points at which the depth of a shared solid is measured."""
DISTANCES_MOST = 20_000_000
"""Distances from a point to a facet that one depth may take: a few seconds."""
DEPTH_OFF = 0.25
"""Share by which two methods may differ on how deep parts are in each other: both take the deepest of some points."""
GAP_OFF = 0.01
"""Share by which they may differ on a gap, which is exact of the meshes in both."""
VOLUME_OFF = 0.02
"""Share by which a stated volume may exceed what parts share, ..."""
LEFT_OUT = 0.2
"""... and by which it may fall short: finders leave out pieces that facets explain."""
WAY_STEPS = 16
"""Places of a free way at which overlaps are looked for."""


@dataclass(frozen=True, eq=False)
class Sides:
    """Where the parts of a design are."""

    design: Design
    files: Files

    @property
    def assembly(self) -> Assembly:
        """The assembly."""
        return self.design.assembly

    @cached_property
    def _parts(self) -> dict[str, Part]:
        return {str(part.name): part for part in self.assembly.parts}

    @cached_property
    def size(self) -> float:
        """m: diagonal of the box around all meshes."""
        corners = [np.array(p.mesh.placed_box(p.X_WP)) for p in self.assembly.parts if p.mesh is not None]
        return float(np.linalg.norm(np.ptp(np.concatenate(corners), axis=0))) if corners else 0.0

    def part(self, name: str) -> Part:
        """The part of that name; NotReplayed where there is none."""
        part = self._parts.get(name)
        if part is None:
            raise NotReplayed(f"the results have no part '{name}'")
        return part

    def placed(self, name: str, X: Array | None = None) -> tuple[Array, Array]:
        """Vertices (n, 3) in the world, displaced by X, and facets (m, 3) of a part; NotReplayed without a mesh."""
        part = self.part(name)
        if part.mesh is None or not len(part.mesh.faces):
            raise NotReplayed(f"'{name}' has no mesh")
        pose = part.X_WP if X is None else X @ part.X_WP
        return part.mesh.vertices @ pose[:3, :3].T + pose[:3, 3], np.asarray(part.mesh.faces, dtype=np.int64)

    def solid(self, name: str, X: Array | None = None) -> Manifold:
        """The same as a solid; NotReplayed where manifold3d does not take the mesh."""
        vertices, faces = self.placed(name, X)
        solid = Manifold(Mesh64(np.ascontiguousarray(vertices), np.ascontiguousarray(faces, dtype=np.uint64)))
        if solid.status() != Error.NoError or solid.is_empty():
            raise NotReplayed(f"the mesh of '{name}' is no closed solid")
        return solid

    def check(self, names: Sequence[str]) -> None:
        """Raise NotReplayed where so many parts, or parts so large, are more than a replay may take."""
        facets = sum(len(self.placed(name)[1]) for name in names[:PARTS_MOST])
        if len(names) > PARTS_MOST or facets > FACETS_MOST:
            raise NotReplayed(f"the parts have {facets} facets: more than {FACETS_MOST} are not replayed")


def replay(witness: Witness, sides: Sides) -> Outcome:
    """Whether parts are where the witness says; raises NotReplayed."""
    stated = [witness.gap, witness.volume, *(witness.twist or ()), *(witness.step or ()), *(witness.moved or ())]
    stated += witness.depth or ()
    if not all(math.isfinite(x) for x in stated if x is not None):
        raise NotReplayed("its numbers are not finite")
    if witness.parts_back is not None and witness.parts_ahead is not None:
        return _blocked(witness, sides)
    if witness.first is None or witness.second is None:
        raise NotReplayed("the witness names no parts")
    sides.check([*witness.first, *witness.second])
    if witness.twist is not None and witness.step is not None:
        return _free_way(witness, sides)
    if witness.gap is None:
        raise NotReplayed("the witness states no distance")
    X = None if witness.moved is None else _displacement(np.array(witness.moved))
    if witness.gap < 0.0:
        return _overlap(witness, sides, X)
    return _apart(witness, sides, X)


def _blocked(witness: Witness, sides: Sides) -> Outcome:
    """Steps of a motion back and ahead, each of which drives two parts into each other."""
    if witness.twist is None or witness.step is None or witness.depth is None:
        raise NotReplayed("the witness states no motion")
    assert witness.parts_back is not None and witness.parts_ahead is not None
    for parts, size, depth in zip((witness.parts_back, witness.parts_ahead), witness.step, witness.depth, strict=True):
        sides.check(parts)
        found, _ = _depth(sides, parts[0], parts[1], _displacement(size * np.array(witness.twist)))
        if not _near(found, depth, DEPTH_OFF):
            return refuted(f"a step of {size:.3g} drives {_names(parts)} {_mm(found)} deep, not {_mm(depth)}")
    if not witness.step[0] < 0.0 < witness.step[1]:
        return refuted("the steps are of one sense")
    return held(f"steps of {witness.step[0]:.3g} and {witness.step[1]:.3g} drive the parts into each other")


def _overlap(witness: Witness, sides: Sides, X: Array | None) -> Outcome:
    """Two sides that are in each other: the deepest pair decides, volumes add up."""
    assert witness.first is not None and witness.second is not None and witness.gap is not None
    pairs = [_depth(sides, a, b, X) for a in witness.first for b in witness.second if a != b]
    depth, volume = max((d for d, _ in pairs), default=0.0), sum(v for _, v in pairs)
    names = _names((*witness.first, *witness.second))
    if not _near(depth, -witness.gap, DEPTH_OFF):
        return refuted(f"{names} are {_mm(depth)} deep in each other, not {_mm(-witness.gap)}")
    if witness.volume is not None and not (1.0 - LEFT_OUT) * volume <= witness.volume <= (1.0 + VOLUME_OFF) * volume:
        return refuted(f"{names} share {volume:.3g} m³, not {witness.volume:.3g}")
    return held(f"{names} are {_mm(depth)} deep in each other")


def _apart(witness: Witness, sides: Sides, X: Array | None) -> Outcome:
    """Two sides with a gap between them."""
    assert witness.first is not None and witness.second is not None and witness.gap is not None
    far = (1.0 + 2.0 * GAP_OFF) * witness.gap + sides.size * 1e-6
    boxes = {name: (v.min(axis=0), v.max(axis=0)) for name in witness.first for v in (sides.placed(name)[0],)}
    least = math.inf
    for name in witness.second:
        vertices, _ = sides.placed(name, X)
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        near = [a for a, (lo, hi) in boxes.items() if a != name and _box_gap(low, high, lo, hi) < min(far, least)]
        if near:
            other = sides.solid(name, X)
            least = min([least, *(float(sides.solid(a).min_gap(other, far)) for a in near)])
    least = min(least, far)
    floor = 1e-6 * sides.size
    names = f"{_names(witness.first)} and {_names(witness.second)}"
    if abs(least - witness.gap) > GAP_OFF * witness.gap + floor:
        more = "at least " if least == far else ""
        return refuted(f"{names} are {more}{_mm(least)} apart, not {_mm(witness.gap)}")
    return held(f"{names} are {_mm(least)} apart")


def _free_way(witness: Witness, sides: Sides) -> Outcome:
    """A motion of the second side that drives it deeper into nothing."""
    assert witness.first is not None and witness.second is not None
    assert witness.twist is not None and witness.step is not None
    start = np.eye(4) if witness.moved is None else _displacement(np.array(witness.moved))
    rest = {name: sides.solid(name) for name in witness.first}
    moving = {name: sides.solid(name) for name in witness.second}
    allowed = _shared(rest, moving, np.eye(4)) + 1e-9 * sides.size**3
    if witness.volume is None:
        raise NotReplayed("the witness states no volume")
    most = 0.0
    for size in np.linspace(*witness.step, WAY_STEPS):
        most = max(most, _shared(rest, moving, _displacement(float(size) * np.array(witness.twist)) @ start))
    names = _names(witness.second)
    if most > max(allowed, (1.0 + VOLUME_OFF) * witness.volume):
        return refuted(f"{names} share {most:.3g} m³ with what rests on the way")
    end = _displacement(witness.step[1] * np.array(witness.twist)) @ start
    corners = {name: sides.placed(name)[0] for name in witness.first}
    still = (np.min([v.min(axis=0) for v in corners.values()], axis=0),
             np.max([v.max(axis=0) for v in corners.values()], axis=0))  # fmt: skip
    for name in witness.second:
        vertices, _ = sides.placed(name, end)
        if _box_gap(vertices.min(axis=0), vertices.max(axis=0), *still) <= 0.0:
            return refuted(f"'{name}' has not left what rests at the end of the way")
    return held(f"nothing is in the way of {names}")


def _shared(rest: dict[str, Manifold], moving: dict[str, Manifold], X: Array) -> float:
    """m³ that two sides share, the second displaced by X."""
    moved = [solid.transform(X[:3]) for solid in moving.values()]
    total = 0.0
    for solid in rest.values():
        low, high = np.reshape(solid.bounding_box(), (2, 3))
        for other in moved:
            other_low, other_high = np.reshape(other.bounding_box(), (2, 3))
            if _box_gap(low, high, other_low, other_high) <= 0.0:
                total += max(0.0, float(Manifold.batch_boolean([solid, other], OpType.Intersect).volume()))
    return total


def _depth(sides: Sides, rests: str, moves: str, X: Array | None) -> tuple[float, float]:
    """How deep (m) two parts are in each other, and what they share (m³), the second displaced by X."""
    first, second = sides.solid(rests), sides.solid(moves, X)
    shared = Manifold.batch_boolean([first, second], OpType.Intersect)
    volume = float(shared.volume())
    if shared.is_empty() or volume <= 0.0:
        return 0.0, 0.0
    mesh = shared.to_mesh64()
    vertices, faces = np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts, dtype=np.int64)
    points = np.concatenate([vertices, vertices[faces].mean(axis=1)])
    points = points[:: max(1, math.ceil(len(points) / SAMPLES_MOST))]
    deepest = 0.0
    for name, pose in ((rests, None), (moves, X)):
        placed, facets = sides.placed(name, pose)
        corners = placed[facets]
        if len(points) * len(corners) > DISTANCES_MOST:
            points = points[:: math.ceil(len(points) * len(corners) / DISTANCES_MOST)]
        deepest = max(deepest, float(max(_distances(points, corners), default=0.0)))
    thick = 2.0 * volume / float(shared.surface_area())
    return max(deepest, thick), volume


def _distances(points: Array, corners: Array) -> Iterator[float]:
    """m: of each point to the nearest of the triangles (m, 3, 3)."""
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(ab, ac)
    square = (normal * normal).sum(axis=1)
    flat = square > 0.0
    edges = [(corners[:, k], corners[:, (k + 1) % 3] - corners[:, k]) for k in range(3)]
    for point in points:
        least = math.inf
        for start, way in edges:
            away = point - start
            long = (way * way).sum(axis=1)
            share = np.clip((away * way).sum(axis=1) / np.where(long > 0.0, long, 1.0), 0.0, 1.0)
            off = away - share[:, None] * way
            least = min(least, float((off * off).sum(axis=1).min()))
        away = (point - a)[flat]
        height = (away * normal[flat]).sum(axis=1)
        u = (np.cross(away, ac[flat]) * normal[flat]).sum(axis=1) / square[flat]
        v = (np.cross(ab[flat], away) * normal[flat]).sum(axis=1) / square[flat]
        inside = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)
        if inside.any():
            least = min(least, float((height[inside] ** 2 / square[flat][inside]).min()))
        yield math.sqrt(least)


def _displacement(twist: Array) -> Array:
    """(4, 4) exponential of a twist (6,), as a power series of its matrix."""
    from scipy.linalg import expm

    x, y, z = twist[:3]
    matrix = np.zeros((4, 4))
    matrix[:3, :3] = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]
    matrix[:3, 3] = twist[3:]
    return np.asarray(expm(matrix))


def _box_gap(low: Array, high: Array, other_low: Array, other_high: Array) -> float:
    """m: distance of two boxes; 0 where they meet."""
    return float(np.linalg.norm(np.maximum(0.0, np.maximum(other_low - high, low - other_high))))


def _near(found: float, claimed: float, share: float) -> bool:
    return abs(found - claimed) <= share * max(abs(claimed), abs(found))


def _names(parts: Sequence[str]) -> str:
    few = ", ".join(f"'{name}'" for name in parts[:3])
    return few if len(parts) <= 3 else f"{few} and {len(parts) - 3} more"


def _mm(value: float) -> str:
    return f"{1e3 * value:.3g} mm"
