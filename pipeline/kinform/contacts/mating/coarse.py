"""Shafts and bores that are tessellated so coarsely that they are prisms: rings of flats that stand for cylinders.

An 8-gon between collars in a round bore touches the bore with its corners only; no surface of one lies on a surface of
the other, and yet the bore holds it on all sides. From flats that do not mate nothing may be concluded. So a ring of
flats that a bore or a shaft encloses within the tolerance is a cylinder here, with a large chord error:

- a ring in a bore, or about a shaft, that is round: the two turn, whatever the ring was meant to be. Bars of up to
  `PRISM_SIDES` sides touch along few lines, and stay in doubt;
- a ring in a ring whose flats lie on those of the other. Up to `PRISM_SIDES` sides they are prisms (hexagon keys, nut
  traps), unless their play lets the corners pass the flats. From there on, nobody can tell prisms from coarse
  cylinders: the patch is a cylinder that says how many `sides` it has, and the joint is in doubt where that matters;
- a ring on flats of a hole that something else has torn open: the flats say how many `sides` the ring has;
- a ring in a ring whose flats do not meet: two tessellations of one cylinder;
- a shaft in a bore that was tessellated by tangents, so that its flats fit and its corners are too far away.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace

import numpy as np

from kinform.contacts.constants import MATING_REACH
from kinform.contacts.mating.analytic import TILT_LIKELY, cylinder_mate
from kinform.contacts.mating.mate import HALF_RADIUS_SHARE, MATING_TILT, Mate, radial_limit
from kinform.contacts.mating.patches import mated_patches
from kinform.contacts.search.pair_view import CLEARANCE_SHARE, NearSurfaces, PairView, PartView, SurfacePair
from kinform.foundation.meshes.boxes import facet_boxes
from kinform.foundation.meshes.rings import RING_SPARE, Ring, RingRow
from kinform.foundation.meshes.surface_table import CYLINDER, SurfaceTable
from kinform.foundation.rounding import SINGLE, SOLVED
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch

PRISM_SIDES = 6
"""Sides up to which bars and sockets whose flats lie on each other are prisms: hexagon keys and nuts. Nobody
tessellates a cylinder that coarsely, and from 12 sides on strips are found to be round. Chosen on 300 random shafts of
3 to 200 facets in bores of as many (play to 0.2 mm, with and without collars), judged on 300 others: 1 wrong and 108 in
doubt, after 119 wrong and 71 in doubt without rings; the one, an octagon that just cannot turn, is in doubt since."""
TORN_FLATS = 3
"""Flats of a ring on flats of another part from which on they go round it: fewer may be those of a D-shaft or a key."""
TANGENT_SHARE = 0.5
"""Share of the gap at the corners of a bore that the gap at its flats has at most, where the bore is taken to be
tessellated by tangents: the chord error is most of it then."""


@dataclass(frozen=True, eq=False)
class _Round:
    """A cylinder near the other part, or a ring of flats that may be one, in the frame of the pair (m)."""

    axis: Array
    point: Array
    corner: float
    flats: tuple[float, float]
    """Distances of the corners, and of the nearest and the farthest flat, from the axis."""
    side: float
    sides: int
    """Of a ring; 0: a cylinder."""
    surfaces: Ints
    low: Array
    high: Array
    row: int
    """Among the near surfaces, of a cylinder."""
    ring: Ring | None = None
    facets: Ints | None = None


def rounded(pair: PairView, patches: list[Patch], reach: float) -> list[Patch]:
    """The patches, with those of rings of flats that are or may be cylinders in place of what their flats say."""
    found = [_near_rows(part, near) for part, near in zip(pair.parts, pair.near, strict=True)]
    if not any(found) and not _any_by_tangents(pair):
        return patches
    rows, cylinders = [[row for row, _ in side] for side in found], [_cylinders(near) for near in pair.near]
    sides = [_with_rings(pair, k, patches, found[k], cylinders, rows) for k in (0, 1)]
    for first, second, radius in _coaxial(pair, sides, reach):
        patches = _read(pair, patches, first, second, radius)
    for k in (0, 1):
        for one in sides[k]:
            patches = _torn(patches, one, k)
    return patches


def _with_rings(
    pair: PairView, k: int, patches: list[Patch], found: list[tuple[RingRow, list[int]]], cylinders: list[list[_Round]],
    rows: list[list[RingRow]],
) -> list[_Round]:  # fmt: skip
    """The cylinders of part k, with those of its rings that anything may be said of."""
    out, lying = list(cylinders[k]), _lying(patches, k) if found else set()
    fit = _that_fit(pair, k, rows[k], cylinders[1 - k], rows[1 - k])
    for (row, at), fits in zip(found, fit, strict=True):
        if (fits or (len(row.surfaces) > PRISM_SIDES and _are_torn(lying, row.surfaces))) and row.ring:
            one = _ring(pair.parts[k], pair.near[k], row.ring, at)
            out += [] if one is None else [one]
    return out


def _torn(patches: list[Patch], ring: _Round, k: int) -> list[Patch]:
    """The patches; flats of a ring of part k that lie on flats of the other part, which are no ring there (a relief or
    a slot may have torn it), say how many `sides` the ring has."""
    if ring.sides <= PRISM_SIDES:
        return patches
    if not _are_torn(_lying(patches, k), ring.surfaces):
        return patches
    lies = [_lies(p) and p.surfaces[k] in ring.surfaces for p in patches]
    return [replace(p, sides=ring.sides) if flat else p for p, flat in zip(patches, lies, strict=True)]


def _lies(patch: Patch) -> bool:
    """Whether it is of planes that lie on each other."""
    return patch.kind == "plane" and not patch.one_sided


def _lying(patches: list[Patch], k: int) -> set[int]:
    """Planes of part k that lie on planes of the other part."""
    return {patch.surfaces[k] for patch in patches if _lies(patch)}


def _are_torn(lying: set[int], planes: Ints) -> bool:
    """Whether so many of the planes of a ring lie on others that these go round it."""
    return len(lying) >= TORN_FLATS and len(lying.intersection(planes.tolist())) >= TORN_FLATS


def _cylinders(near: NearSurfaces) -> list[_Round]:
    """Cylinders of one part that have facets near the other."""
    return [
        _Round(
            near.axes[k], near.points[k], float(near.radii[k]), (float(near.radii[k] - near.chords[k]),) * 2,
            float(near.sides[k]), 0, near.ids[k : k + 1], near.lows[k], near.highs[k], int(k),
        )
        for k in near.of_kind("cylinder")
    ]  # fmt: skip


def _near_rows(part: PartView, near: NearSurfaces) -> list[tuple[RingRow, list[int]]]:
    """Rows of flats of one part that may be rings, of which some planes have facets near the other; and where these
    planes are among the near surfaces."""
    rows = part.index.ring_rows(part.surfaces)
    place = {k: row for row, k in enumerate(near.ids.tolist())} if rows else {}
    every = [(row, [place[k] for k in row.surfaces.tolist() if k in place]) for row in rows]
    return [(row, at) for row, at in every if at]


def _that_fit(
    pair: PairView, k: int, rows: list[RingRow], cylinders: list[_Round], others: list[RingRow]
) -> list[bool]:
    """Which rows of part k may, by radii and axes at first sight, be in a cylinder or a ring of the other part or about
    one: most are not, and need not be looked at."""
    if not rows or not (cylinders or others):
        return [False] * len(rows)
    turns = [part.X_FP[:3, :3] for part in pair.parts]
    axes = np.array([*(one.axis for one in cylinders), *(turns[1 - k] @ row.axis for row in others)])
    side = np.array([*(one.side for one in cylinders), *(row.side for row in others)])
    corner = np.array([*(one.corner for one in cylinders), *(row.corner for row in others)])
    flat = np.array([*(one.flats[1] for one in cylinders), *(row.flat for row in others)])
    least, out = np.cos(TILT_LIKELY * MATING_TILT) - SINGLE, []
    for row in rows:
        gap = np.minimum(np.minimum(np.abs(corner - row.corner), np.abs(flat - row.corner)), np.abs(row.flat - corner))
        rough = 2.0 * RING_SPARE * (row.corner + corner)
        off = gap > radial_limit(pair.play, (1.0 + RING_SPARE) * max(row.corner, row.flat)) + rough
        out.append(bool((~off & (row.side * side <= 0.0) & (np.abs(axes @ (turns[k] @ row.axis)) >= least)).any()))
    return out


def _ring(part: PartView, near: NearSurfaces, ring: Ring, at: list[int]) -> _Round | None:
    """A ring that has flats `at` these places of the near surfaces; None where no facets there are its own."""
    facets = np.concatenate([near.facets[k] for k in at])
    facets = facets[np.isin(facets, ring.facets)]
    if not len(facets):
        return None
    R_FP, p_FP = part.X_FP[:3, :3], part.X_FP[:3, 3]
    low, high = facet_boxes(part.vertices, part.faces[facets])
    return _Round(
        R_FP @ ring.axis, R_FP @ ring.point + p_FP, ring.corner, ring.flats, float(ring.side), ring.sides,
        ring.surfaces, low.min(axis=0), high.max(axis=0), -1, ring, facets,
    )  # fmt: skip


def _coaxial(pair: PairView, sides: list[list[_Round]], reach: float) -> Iterator[tuple[_Round, _Round, float]]:
    """Pairs of which one may enclose the other, the largest first, and the radius (m) of what encloses."""
    met = []
    for i, j in np.argwhere(_may_enclose(pair, sides)).tolist():
        a, b = sides[0][i], sides[1][j]
        radius = _enclosing(pair, a, b)
        if radius is None:
            continue
        apart = np.maximum(a.low - b.high, b.low - a.high).max()
        if apart > reach or abs(float(a.axis @ b.axis)) < np.cos(TILT_LIKELY * MATING_TILT):
            continue
        met.append((a, b, radius))
    yield from sorted(met, key=lambda ab: (-ab[0].corner, int(ab[0].surfaces[0]), int(ab[1].surfaces[0])))


def _may_enclose(pair: PairView, sides: list[list[_Round]]) -> Flags:
    """(n, m): rounds of either part of which one may enclose the other as far as their radii tell at first sight."""
    if not (sides[0] and sides[1]):
        return np.zeros((len(sides[0]), len(sides[1])), bool)
    (side_a, corner_a, flat_a), (side_b, corner_b, flat_b) = (
        np.array([(one.side, one.corner, one.flats[1]) for one in part]).T for part in sides
    )
    inner = (side_a > 0.0)[:, None]
    bar = np.where(inner, corner_a[:, None], corner_b)
    outer, flat = np.where(inner, corner_b, corner_a[:, None]), np.where(inner, flat_b, flat_a[:, None])
    play = np.maximum(pair.play, CLEARANCE_SHARE * bar)
    # of the smaller radius of the two it is less
    limit = (1.0 + SOLVED) * MATING_REACH * np.minimum(play, bar / HALF_RADIUS_SHARE)
    off = np.minimum(np.abs(outer - bar), np.abs(flat - bar))
    return np.asarray((side_a[:, None] * side_b <= 0.0) & (off <= limit))


def _bar_and_socket(first: _Round, second: _Round) -> tuple[_Round, _Round]:
    return (first, second) if first.side > 0.0 else (second, first)


def _enclosing(pair: PairView, first: _Round, second: _Round) -> float | None:
    """m: radius of that of the two that may enclose the other; None where it does not by their radii, or they mate as
    what they are."""
    bar, socket = _bar_and_socket(first, second)
    # the bar comes near all flats of the socket, or both are chords of circles that fit
    radius = min(socket.flats[1], socket.corner, key=lambda r: abs(r - bar.corner))
    if abs(radius - bar.corner) > radial_limit(pair.play, min(bar.corner, radius)):
        return None
    if first.ring is None and second.ring is None and not _by_tangents(pair, bar, socket):
        return None
    return radius


def _read(pair: PairView, patches: list[Patch], first: _Round, second: _Round, radius: float) -> list[Patch]:
    """The patches with the reading of these two, of which that which encloses has this radius (m)."""
    bar, socket = _bar_and_socket(first, second)
    between = [_between(patch, first, second) for patch in patches]
    flats = any(
        inside and patch.kind in ("plane", "other") and not patch.one_sided
        for patch, inside in zip(patches, between, strict=True)
    )
    sides = max(bar.sides, socket.sides)
    if flats and sides <= PRISM_SIDES and bar.corner > socket.flats[0]:
        return patches
    found = _patches(pair, first, second, {id(socket): radius, id(bar): bar.corner})
    if not found:
        return patches
    few = min((n for n in (bar.sides, socket.sides) if n), default=PRISM_SIDES + 1) <= PRISM_SIDES
    alike = bar.sides == socket.sides > 0 and bar.corner > socket.flats[0]
    doubtful = flats or few or alike
    found = [replace(patch, sides=sides if doubtful else 0) for patch in found]
    return [patch for patch, inside in zip(patches, between, strict=True) if not inside] + found


def _by_tangents(pair: PairView, bar: _Round, socket: _Round) -> bool:
    """Whether two cylinders do not mate as such, only because the corners of the bore stand off its flats."""
    apart = abs(socket.corner - bar.corner)
    near = abs(socket.flats[1] - bar.corner)
    return apart > radial_limit(pair.play, bar.corner) and near <= TANGENT_SHARE * apart


def _any_by_tangents(pair: PairView) -> bool:
    """Whether that is so of any two of the near cylinders, wherever they are."""
    a, b = pair.near
    rows, columns = a.of_kind("cylinder"), b.of_kind("cylinder")
    if not len(rows) or not len(columns):
        return False
    first, second, senses = a.radii[rows][:, None], b.radii[columns][None], a.sides[rows][:, None] * b.sides[columns]
    inner = a.sides[rows][:, None] > 0.0
    bar, bore = np.where(inner, first, second), np.where(inner, second, first)
    flats = bore - np.where(inner, b.chords[columns][None], a.chords[rows][:, None])
    apart = np.abs(bore - bar)
    play = np.maximum(pair.play, CLEARANCE_SHARE * bar)
    limit = MATING_REACH * np.minimum(play, bar / HALF_RADIUS_SHARE)
    by_tangents = (apart > limit) & (np.abs(flats - bar) <= TANGENT_SHARE * apart)
    return bool((by_tangents & (senses <= 0.0)).any())


def _between(patch: Patch, first: _Round, second: _Round) -> bool:
    """Whether a patch lies between surfaces of these two."""
    return patch.surfaces[0] in first.surfaces and patch.surfaces[1] in second.surfaces


def _patches(pair: PairView, first: _Round, second: _Round, radii: dict[int, float]) -> list[Patch]:
    """What touches of these two as cylinders of these radii."""
    parts, rows = [], []
    for part, near, one in zip(pair.parts, pair.near, (first, second), strict=True):
        parts.append(_relabelled(part, one))
        rows.append(_only(near, one.row, radii[id(one)]) if one.ring is None else _row(one, radii[id(one)]))
    view = replace(pair, a=parts[0], b=parts[1])
    surfaces = SurfacePair(rows[0], rows[1], 0, 0)
    mate: Mate | None = cylinder_mate(view, surfaces)
    return [] if mate is None else mated_patches(view, [mate])


def _relabelled(part: PartView, one: _Round) -> PartView:
    """The part with the flats of a ring as one surface."""
    if one.ring is None:
        return part
    labels = part.surfaces.labels.copy()
    labels[one.ring.facets] = one.surfaces[0]
    return replace(part, surfaces=replace(part.surfaces, labels=labels))


def _only(near: NearSurfaces, row: int, radius: float) -> NearSurfaces:
    """One of the near surfaces, a cylinder, with this radius (m)."""
    columns = {field.name: getattr(near, field.name)[row : row + 1] for field in fields(NearSurfaces)}
    return NearSurfaces(**columns | {"radii": np.array([radius])})


def _row(one: _Round, radius: float) -> NearSurfaces:
    """A ring as a cylinder of this radius (m)."""
    ring = one.ring
    assert ring is not None
    assert one.facets is not None
    chord = max(abs(one.corner - radius), abs(radius - one.flats[0]))
    numbers = {
        "radii": radius, "minor_radii": 0.0, "half_angles": 0.0, "pitches": 0.0, "sides": one.side,
        "axis_uncertainty": ring.turn, "point_uncertainty": ring.shift, "slacks": chord + ring.shift, "chords": chord,
        "residuals": ring.shift,
        "rims": 0.0, "areas": 0.0,
    }  # fmt: skip
    table = SurfaceTable(
        kinds=np.array([CYLINDER]),
        axes=one.axis[None],
        points=one.point[None],
        extents=np.array([ring.extent]),
        **{name: np.array([value]) for name, value in numbers.items()},
    )
    columns = {field.name: getattr(table, field.name) for field in fields(SurfaceTable)}
    return NearSurfaces(**columns, ids=one.surfaces[:1], lows=one.low[None], highs=one.high[None], facets=(one.facets,))
