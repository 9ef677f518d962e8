"""Threads: helicoids found by the helices that a tessellated thread has as edges.

Facets of a thread are too coarse to say what their pitch is, and its flanks fall apart in pieces that look like
planes or nothing. But whatever the tessellation, the borders of its flanks are polylines with every vertex on a true
helix: edges along which the distance from the axis stays and the height grows with the angle, all by one amount.
Candidates for the axis are those of coaxial cylinders (crests, roots, shanks) and of the linear line complex of
what is left (see `lines`); a least squares over the polylines then gives axis and pitch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import canonical_sign, cross, dot, perpendicular
from kinform.foundation.constants import COVERAGE
from kinform.foundation.graphs.components import components
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED, TINY
from kinform.foundation.sorting import among, distinct, median
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.constants import ROWS
from kinform.surfaces.describe import ROUNDED_SCATTER, Description, standoffs
from kinform.surfaces.groups import columns_of, slices
from kinform.surfaces.polygons.noise import Scale
from kinform.surfaces.polygons.patchwork import Patchwork
from kinform.surfaces.swept.lines import THREAD_POLYGONS, Line

LEVEL = 2e-3
"""Share of its length by which an edge along a helix may change its distance from the axis. Chosen, not measured."""
LEVEL_NOISES = 4
"""The same in noises, for short edges: that of both ends, twice."""
WIDE = (8.0, 4.0, 2.0, 1.0, 1.0)
"""Multiples of the width in which helices are looked for while axis and advance are refined. Chosen, not measured."""
HELIX_STEP = 0.85
"""rad: greatest angle of an edge about the axis: a thread has eight vertices a turn, at least."""
ARC = 1.1
"""Length of such an edge along its helix, in its own lengths, at most: 1.031, with room."""
STEEP = (2e-3, 4.0)
"""Range of the advance a radian, in radii, of a thread: lead angles from 0.1° to 76°."""
ADVANCE_NOISES = 3
"""Noises, over its angle, by which the advance of an edge is uncertain: of both ends, with room."""
ADVANCE_SHOWS = 0.3
"""Largest relative uncertainty of the advance of an edge that suggests one. Chosen, not measured."""
ALIKE_ADVANCE = 5e-3
"""Relative spread of the advance along the edges of one thread, besides the rounding of each. Chosen, not measured."""
TURNED = 0.7
"""Fewest turns of helix, counted along all polylines of a thread. Chosen, not measured."""
TILT = 0.12
"""Largest root mean square of the normals' share of the speed of the screw, over the facets of a thread. Chosen, not
measured."""
LEAN = 0.3
"""Mean of that, as a share of the slope of the helix: beyond, the facets are as well a ring, or a helix of another
pitch. Chosen, not measured."""


@dataclass(frozen=True, eq=False)
class _Screw:
    axis: Array
    point: Array
    advance: float
    """Along the axis a radian, right-handed positive."""

    @property
    def frame(self) -> tuple[Array, Array]:
        """Two unit vectors across the axis, from the first of which azimuths count."""
        u, v = perpendicular(self.axis)
        return -u, -v

    def polar(self, points: Array) -> tuple[Array, Array, Array]:
        """Height, distance and azimuth of points (n, 3)."""
        arm = points - self.point
        x, y = (arm @ across for across in self.frame)
        return arm @ self.axis, np.hypot(x, y), np.arctan2(y, x)

    def lean(self, centres: Array, normals: Array) -> tuple[Array, Array]:
        """Share (n,) of the screw's speed along the normals there, and the slope (n,) of the helices."""
        turning = cross(np.broadcast_to(self.axis, centres.shape), centres - self.point)
        velocity = turning + self.advance * self.axis
        size = np.maximum(np.linalg.norm(velocity, axis=1), TINY)
        return dot(normals, velocity) / size, np.abs(self.advance) / size


@dataclass(frozen=True, eq=False)
class _Helices:
    """Edges (vertices, (m, 2)) that run along the helices of one screw, and their polylines."""

    ends: Ints
    polyline: Ints
    """(m,) of each edge."""
    turn: Array
    """(m,) rad."""


def threads(work: Patchwork, loose: Flags, about: Sequence[Line], scale: Scale) -> list[Description]:
    """Helicoids about these lines among the loose polygons (P,) of a mesh, each with all its flanks."""
    free = loose.copy()
    out: list[Description] = []
    if int(free.sum()) < THREAD_POLYGONS:
        return out
    edges = _beside(work, free)
    for (axis, point), level in _with_helices(work, edges, about, scale):
        if int(free.sum()) < THREAD_POLYGONS:
            break
        beside = level.take(among(level, edges).nonzero()[0]) if out else level
        thread = _about(work, free, edges, beside, _Screw(axis, point, 0.0), scale)
        if thread is not None:
            out.append(thread)
            free[thread.polygons] = False
            edges = _beside(work, free)
    return out


def _beside(work: Patchwork, free: Flags) -> Ints:
    """Edges of free polygons."""
    return np.flatnonzero(free[work.a] | ((work.b >= 0) & free[work.b]))


def _about(
    work: Patchwork, free: Flags, edges: Ints, level: Ints, start: _Screw, scale: Scale
) -> Description | None:  # fmt: skip
    """The thread about a line, if there is one, among free polygons, whose edges these are; those that may be level are
    known."""
    if len(edges) < THREAD_POLYGONS:
        return None
    best: tuple[float, _Screw, Ints] | None = None
    for advance in _advances(work, level, start, scale):
        screw = _refine(work, edges, replace(start, advance=advance), scale)
        if screw is None:
            continue
        helices = _helices(work, edges, screw, scale)
        members = np.zeros(0, np.int64) if helices is None else _members(work, free, helices, screw)
        if helices is None or len(members) < THREAD_POLYGONS:
            continue
        # diagonals of a regular mesh make short helices of another pitch
        score = float((np.bincount(helices.polyline, helices.turn) ** 2).sum())
        if best is None or score > best[0]:
            best = (score, screw, members)
    if best is None:
        return None
    return _description(work, edges, best[1], best[2], scale)


def _with_helices(work: Patchwork, edges: Ints, about: Sequence[Line], scale: Scale) -> list[tuple[Line, Ints]]:
    """Those of the lines about which edges may turn enough for `_advances`, each with edges that may be level there:
    bounds from lengths need no angles, are had of all lines at once, and leave few."""
    out: list[tuple[Line, Ints]] = []
    enough = (1.0 - SOLVED) * 2 * np.pi * TURNED
    shown = (1.0 - SOLVED) * ADVANCE_NOISES / ADVANCE_SHOWS * scale.noise
    for run in slices(len(about), max(ROWS // len(work.vertices), 1)):
        some = about[run]
        distance = _distances(work, some)
        line, place = _level(work, edges, distance, WIDE[0], scale).nonzero()
        edge = edges.take(place)
        one, other = (distance.take(line * distance.shape[1] + work.ends[:, end].take(edge)) for end in range(2))
        length = work.length.take(edge)
        rise = np.abs(dot(work.along(edge), columns_of(np.array([axis for axis, _ in some]), line)))
        across = np.sqrt(np.maximum(length * length - rise * rise, 0.0))
        turn = np.minimum(ARC * across / np.maximum(np.sqrt(one * other), TINY), HELIX_STEP)
        flat = (1.0 - SOLVED) * rise < STEEP[1] * turn * (one + other) / 2
        turned = np.bincount(line, np.where(flat & (rise > shown), turn, 0.0), len(some))
        out += [(some[k], edge[line == k]) for k in np.flatnonzero(turned >= enough).tolist()]
    return out


def _distances(work: Patchwork, about: Sequence[Line]) -> Array:
    """(n, V) of all vertices from n lines."""
    frames = np.array([perpendicular(axis) for axis, _ in about])[..., None]
    arms = work.columns[:, None] - np.array([point for _, point in about]).T[..., None]
    x, y = (
        arms[0] * across[:, 0] + arms[1] * across[:, 1] + arms[2] * across[:, 2]
        for across in (frames[:, 0], frames[:, 1])
    )
    return np.asarray(np.sqrt(x * x + y * y))


def _level(work: Patchwork, edges: Ints, distance: Array, wide: float, scale: Scale) -> Flags:
    """(…, m) edges whose ends, at these distances (…, V) from an axis, are as far from it as those of a helix may be,
    judged by their lengths: that needs no angles, and leaves few. An arc is no longer than HELIX_STEP / 2 over its sine
    in chords."""
    one, other = (distance.take(work.ends[:, end].take(edges), axis=-1) for end in range(2))
    room = LEVEL_NOISES * scale.noise
    return np.asarray(np.abs(other - one) <= ARC * wide * LEVEL * work.length.take(edges) + room)


def _slopes(
    work: Patchwork, ends: Ints, screw: _Screw, scale: Scale, wide: float = 1.0
) -> tuple[Array, Array, Array, Flags]:
    """Advance, its uncertainty and angle (m,) of edges, and which of them may run along a helix of an axis that is
    known `wide` times less well than in the end."""
    height, distance, azimuth = screw.polar(work.vertices.take(ends.ravel(), axis=0))
    rise, widening, turn = (x[1::2] - x[::2] for x in (height, distance, azimuth))
    mean = (distance[::2] + distance[1::2]) / 2
    turn -= 2 * np.pi * np.round(turn / (2 * np.pi))
    length = np.hypot(rise, mean * turn)
    level = np.abs(widening) <= wide * LEVEL * length + LEVEL_NOISES * scale.noise
    # an edge along a helix has an arc of at least a twentieth of its rise
    turning = (np.abs(turn) < HELIX_STEP) & (np.abs(turn) * mean > 0.05 * np.abs(rise)) & (np.abs(turn) > SINGLE)
    advance = np.where(turning, rise / np.where(turning, turn, 1.0), 0.0)
    doubt = ADVANCE_NOISES * scale.noise / np.maximum(np.abs(turn), 1e-9)
    steep = (np.abs(advance) > STEEP[0] * mean + doubt) & (np.abs(advance) < STEEP[1] * mean)
    return advance, doubt, turn, level & turning & steep


def _advances(work: Patchwork, edges: Ints, start: _Screw, scale: Scale) -> list[float]:
    """Advances that many of the edges, which may be level, have in common, the most turned first."""
    advance, doubt, turn, usable = _slopes(work, work.ends.take(edges, axis=0), start, scale, WIDE[0])
    rows = np.flatnonzero(usable & (doubt < ADVANCE_SHOWS * np.abs(advance)))
    out: list[float] = []
    if np.abs(turn[rows]).sum() < (1.0 - SOLVED) * 2 * np.pi * TURNED:
        return out
    # a thread of several starts and its diagonals suggest a few advances about one axis
    for _ in range(4):
        if len(rows) < THREAD_POLYGONS // 2:
            break
        order = rows[np.argsort(advance[rows], kind="stable")]
        values, weight = advance[order], np.abs(turn[order])
        reach = ALIKE_ADVANCE * np.abs(values) + median(doubt[order])
        total = np.r_[0.0, np.cumsum(weight)]
        low = np.searchsorted(values, values - reach)
        high = np.searchsorted(values, values + reach, side="right")
        held = total[high] - total[low]
        best = int(np.argmax(held))
        if held[best] < 2 * np.pi * TURNED:
            break
        inside = order[low[best] : high[best]]
        out.append(median(advance[inside]))
        rows = order[np.abs(values - out[-1]) > 2 * reach[best]]
    return out


def _helices(work: Patchwork, edges: Ints, screw: _Screw, scale: Scale, wide: float = 1.0) -> _Helices | None:
    """The edges along the screw's helices, joined to polylines, if they make enough of a thread."""
    ends = work.ends.take(edges, axis=0)
    advance, doubt, turn, usable = _slopes(work, ends, screw, scale, wide)
    near = usable & (np.abs(advance - screw.advance) <= 2 * wide * ALIKE_ADVANCE * abs(screw.advance) + doubt)
    if not near.any():
        return None
    ends, turn = ends[near], np.abs(turn[near])
    polyline = components(ends[:, 0], ends[:, 1], len(work.vertices))[ends[:, 0]]
    _, polyline = np.unique(polyline, return_inverse=True)
    turned = np.bincount(polyline, turn)
    # at least one polyline makes 0.4 turns
    if turned.sum() < 2 * np.pi * TURNED or turned.max() < 2 * np.pi * 0.4:
        return None
    # polylines below 2 % of the longest do not count
    keep = (np.bincount(polyline)[polyline] >= 2) & (turned[polyline] > 0.02 * turned.max())
    return _Helices(ends[keep], np.unique(polyline[keep], return_inverse=True)[1], turn[keep])


def _residuals(work: Patchwork, helices: _Helices, screw: _Screw, vertex: Ints, group: Ints) -> Array:
    """Heights above their helices and distances from their cylinders, of the polylines' vertices."""
    height, distance, azimuth = screw.polar(work.vertices[vertex])
    count = int(group.max()) + 1
    first = np.full(count, len(vertex))
    np.minimum.at(first, group, np.arange(len(vertex)))
    phase = height / screw.advance - azimuth
    phase -= phase[first][group]
    above = screw.advance * (phase - 2 * np.pi * np.round(phase / (2 * np.pi)))
    size = np.bincount(group)
    for values in (above, distance):
        values -= (np.bincount(group, values) / size)[group]
    return np.concatenate([above, distance])


def _step(screw: _Screw, change: Array) -> _Screw:
    """The screw with its axis tilted and shifted, and its advance changed, by (5,)."""
    u, v = screw.frame
    axis = screw.axis + change[0] * u + change[1] * v
    return _Screw(axis / np.linalg.norm(axis), screw.point + change[2] * u + change[3] * v, screw.advance + change[4])


def _solve(work: Patchwork, helices: _Helices, screw: _Screw, scale: Scale) -> tuple[_Screw, Array, float, float]:
    """One robust step: the screw, the covariance factors (5, 5), the scatter and the extent along the axis."""
    key = distinct(np.repeat(helices.polyline, 2) * np.int64(len(work.vertices)) + helices.ends.ravel())
    group, vertex = key // len(work.vertices), key % len(work.vertices)
    height = screw.polar(work.vertices[vertex])[0]
    middle = 0.5 * float(height.min() + height.max())
    screw = _Screw(screw.axis, screw.point + middle * screw.axis, screw.advance)
    step = 1e-6
    base = _residuals(work, helices, screw, vertex, group)
    columns = np.stack(
        [(_residuals(work, helices, _step(screw, step * e), vertex, group) - base) / step for e in np.eye(5)], axis=1
    )
    # A standard deviation in median magnitudes of a normal distribution: 1.4826, rounded up.
    scatter = max(1.5 * median(np.abs(base)), scale.rounding)
    weight = 1.0 / np.maximum(np.abs(base) / (COVERAGE * scatter), 1.0) ** 2
    matrix = (columns * weight[:, None]).T @ columns
    size = np.sqrt(np.maximum(np.diag(matrix), TINY))
    inverse = np.linalg.pinv(matrix / np.outer(size, size), hermitian=True, rcond=ARITHMETIC) / np.outer(size, size)
    change = -inverse @ (columns.T @ (weight * base))
    return _step(screw, change), inverse, scatter, float(np.ptp(height))


def _refine(work: Patchwork, edges: Ints, screw: _Screw, scale: Scale) -> _Screw | None:
    """The screw through the polylines of its helices."""
    for wide in WIDE:
        helices = _helices(work, edges, screw, scale, wide)
        if helices is None:
            return None
        moved = _solve(work, helices, screw, scale)[0]
        # an advance that changes by more in one step is that of another thread
        if not np.isfinite(moved.advance) or abs(moved.advance - screw.advance) > 0.1 * abs(screw.advance):
            return None
        screw = moved
    return screw


def _members(work: Patchwork, free: Flags, helices: _Helices, screw: _Screw) -> Ints:
    """Free polygons on the thread: those between one helix and the next, and pieces that hang together, border
    a helix, and lean neither way."""
    total = np.int64(len(work.vertices))
    line = np.full(len(work.vertices), -1)
    line[helices.ends] = helices.polyline[:, None]
    share, slope = screw.lean(work.centre, work.normal)
    every = np.arange(work.count)
    owner, vertex = work.corners.expand(every)
    key = distinct(owner * (total + 1) + line[vertex] + 1)
    lines = np.bincount(key // (total + 1), key % (total + 1) > 0, work.count)
    off = np.bincount(owner, line[vertex] < 0, work.count)
    along = _are_edges(work, helices)
    sided = np.bincount(np.r_[work.a[along], work.b[along & (work.b >= 0)]], minlength=work.count) > 0
    # skew triangles between two helices lean far to either side in turn
    between = free & sided & (lines <= 2) & (((off == 0) & (np.abs(share) < 0.6)) | (np.abs(share) < TILT))
    # a single facet may lean three times as far as all of them in the mean
    fitting = free & (np.abs(share) < 3 * TILT)
    use = work.smooth & fitting[work.a] & (work.b >= 0)
    use[use] &= fitting[work.b[use]]
    label = components(work.a[use], work.b[use], work.count)
    area = np.where(fitting, work.area, 0.0)
    whole = np.maximum(np.bincount(label, area, work.count), TINY)
    mean = np.bincount(label, area * share, work.count) / whole
    square = np.sqrt(np.bincount(label, area * share**2, work.count) / whole)
    steep = np.bincount(label, area * slope, work.count) / whole
    # a piece of flank touches helices with at least three corners
    touched = np.bincount(label[owner], (line[vertex] >= 0) & fitting[owner], work.count) >= 3
    good = touched & (square < TILT) & (np.abs(mean) < LEAN * steep)
    return np.flatnonzero(between | (fitting & good[label]))


def _are_edges(work: Patchwork, helices: _Helices) -> Flags:
    """(E,) which edges run along the helices."""
    total = np.int64(len(work.vertices))
    edges, along = np.sort(work.ends, axis=1), np.sort(helices.ends, axis=1)
    return among(edges[:, 0] * total + edges[:, 1], distinct(along[:, 0] * total + along[:, 1]))


def _chord(work: Patchwork, helices: _Helices, members: Ints) -> float:
    """How far facets may stand off the thread, from the angles between them where they are not its corners."""
    inside = np.zeros(work.count, bool)
    inside[members] = True
    # edges of more than 1 rad are crests and roots
    use = (work.b >= 0) & inside[work.a] & (work.angle < 1.0)
    use[use] &= inside[work.b[use]]
    use &= ~_are_edges(work, helices)
    return float(standoffs(work, np.flatnonzero(use)).max(initial=0.0))


def _description(work: Patchwork, edges: Ints, screw: _Screw, members: Ints, scale: Scale) -> Description | None:
    """The thread that these members make, with the uncertainty of its screw."""
    helices = _helices(work, edges, screw, scale)
    if helices is None:
        return None
    _, inverse, scatter, _ = _solve(work, helices, screw, scale)
    spread = COVERAGE * scatter * np.sqrt(np.maximum(np.diag(inverse), 0.0))
    weight, normal = work.area[members], work.normal[members]
    height, _, _ = screw.polar(work.vertices[helices.ends.ravel()])
    middle = 0.5 * float(height.min() + height.max())
    point = screw.point + middle * screw.axis
    axis = screw.axis * canonical_sign(screw.axis)
    arm = work.centre[members] - point
    radial = arm - (arm @ axis)[:, None] * axis
    distance = np.linalg.norm(radial, axis=1)
    outward = float(dot(normal, radial) / np.maximum(distance, TINY) @ weight)
    _, vertex = work.corners.expand(members)
    span = (work.vertices[vertex] - point) @ axis
    return Description(
        "helicoid", members, axis, point, radius=float(distance @ weight / weight.sum()),
        side=1 if outward >= 0 else -1, extent=(float(span.min()), float(span.max())), residual=scatter,
        axis_uncertainty=float(min(np.hypot(spread[0], spread[1]), np.pi / 2)),
        point_uncertainty=float(max(np.hypot(spread[2], spread[3]), ROUNDED_SCATTER * scale.rounding)),
        pitch=2 * np.pi * screw.advance,
        chord=_chord(work, helices, members),
    )  # fmt: skip
