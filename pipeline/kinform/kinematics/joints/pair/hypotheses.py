"""Elementary motions that the surfaces of a pair suggest: turns and screws about axes, slides along directions.

Every lower pair is spanned by such motions, so it is enough to test each of them against each patch.
Axes that agree within what clearances and fits allow are one axis, fitted to all that support it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np

from kinform.foundation.algebra.screws import rotation, translation
from kinform.foundation.algebra.vectors import canonical, cross, foot, norm, perpendicular, sine, weighted_mean
from kinform.foundation.rounding import ARITHMETIC, SOLVED
from kinform.frozen import dataclass
from kinform.kinematics.constants import SAME_DIRECTION
from kinform.kinematics.joints.pair.constants import SAME_PITCH, VAGUE_AXIS
from kinform.kinematics.joints.pair.evidence import COAXIAL, Evidence, Item, Line
from kinform.kinematics.joints.pair.least_held import slides_across, turns_about
from kinform.kinematics.screws.wording import components
from kinform.mechanism.constants import SIGMAS
from kinform.model.arrays import Array

MOST_DIRECTIONS = 24
"""Directions tried, the best supported first: parts of real robots have hundreds of tiny planes. Chosen, not
measured."""
MOST_NORMALS = 12
"""Normals of planes, the heaviest first, of which each two suggest the line in which their planes meet. Chosen, not
measured."""
MOST_FACES = 6
"""Of these, how many suggest slides across themselves. Chosen, not measured."""
MOST_SLIDES = 72
"""Slides that are tried in all. Chosen, not measured."""
SEPARATE_CENTRES = 1e-3
"""Share of the contact's size from which on two centres of balls suggest the line through them. Chosen, not
measured."""
DISTINCT_SLIDE = 0.25
"""Directions that differ by less than this share of the alignment are tried once. Chosen, not measured."""
LEAST_MEETING = 0.1
"""Planes at a smaller angle (sine) have no line in common that could be told. Chosen, not measured."""
ONE_NORMAL = 1e-3
"""Relative spread of normals below which they say one direction only. Chosen, not measured."""
LEAST_POSITION = 1e-7
"""Share of a patch's length below which its place counts as no better known: keeps the weights of fits comparable.
Chosen, not measured."""


Value = TypeVar("Value")
Merge = Callable[[Value, Value], Value]
Direction = tuple[Array, float]
"""A unit direction and its weight (m²)."""


@dataclass(frozen=True, eq=False)
class Motion:
    """One candidate freedom: `turn` about an axis through a point, or a slide along it."""

    turn: bool
    twist: Array
    """(6,) scaled, unit."""
    axis: Array
    point: Array
    curved: bool
    """Suggested by a cylinder, cone or sphere rather than by planes alone."""
    pitch: float = 0.0
    """m a turn; of a turn that advances, right-handed positive."""


def candidate_motions(evidence: Evidence, alignment: float) -> tuple[Motion, ...]:
    """Candidate motions in a fixed order, best supported first."""
    lines = coaxial_lines(evidence, alignment)
    centres = _centres(evidence)
    normals = _directions([(i.patch.axis, i.area) for i in evidence.items if i.patch.kind == "plane"], alignment)
    directions = _slides(evidence, lines, normals, alignment)
    frame, out = evidence.frame, []
    for line in lines:
        out.append(Motion(True, rotation(line.axis, line.point, frame), line.axis, line.point, True))
    for line in lines:
        for pitch in _pitches(evidence, line):
            twist = rotation(line.axis, line.point, frame, pitch)
            out.append(Motion(True, twist, line.axis, line.point, True, pitch))
    for centre in centres:
        turns = [*turns_about(evidence, centre), *(d for d, _ in directions), *(n for n, _ in normals)]
        apart = SEPARATE_CENTRES * frame.length
        turns += [canonical(c - centre) for c in centres if norm(c - centre) > apart]
        out += [Motion(True, rotation(d, centre, frame), d, centre, True) for d in turns]
    for direction, curved in directions:
        out.append(Motion(False, translation(direction), direction, frame.centre, curved))
    for normal, _ in normals:
        centre = _middle(evidence, normal, alignment)
        out.append(Motion(True, rotation(normal, centre, frame), normal, centre, False))
    return tuple(out)


def _merge(values: Iterable[Value], agree: Callable[[Value, Value], bool], merge: Merge[Value]) -> list[Value]:
    """The values, each merged with the first before it that it agrees with."""
    merged: list[Value] = []
    for value in values:
        n = next((n for n, other in enumerate(merged) if agree(other, value)), None)
        if n is None:
            merged.append(value)
        else:
            merged[n] = merge(merged[n], value)
    return merged


def _pitches(evidence: Evidence, line: Line) -> list[float]:
    """Pitches (m a turn) of the threads on a line; those that agree are one, by their areas."""
    items = sorted((evidence.items[k] for k in line.items), key=lambda i: (-i.area, i.index))
    threads = [(item.patch.pitch, item.area) for item in items if item.patch.kind == "helicoid"]
    pitches = _merge(
        threads,
        lambda a, b: abs(b[0] - a[0]) <= SAME_PITCH * abs(a[0]),
        lambda a, b: ((a[0] * a[1] + b[0] * b[1]) / (a[1] + b[1]), a[1] + b[1]),
    )
    return [pitch for pitch, _ in pitches]


def coaxial_lines(evidence: Evidence, alignment: float) -> list[Line]:
    """Clusters of coaxial patches, each with the line fitted to its members, the best supported first; of evidence that
    was asked for them before they are known."""
    if alignment not in evidence.lines:
        evidence.lines[alignment] = _coaxial_lines(evidence, alignment)
    return evidence.lines[alignment]


def _coaxial_lines(evidence: Evidence, alignment: float) -> list[Line]:
    items = evidence.items
    coaxial = sorted((k for k, i in enumerate(items) if i.patch.kind in COAXIAL), key=lambda k: (-items[k].area, k))
    clusters = _merge(
        [[k] for k in coaxial],
        lambda a, b: _coaxial(items[a[0]], items[b[0]], alignment),
        lambda a, b: a + b,
    )
    lines = [_fit_line([items[k] for k in cluster], cluster) for cluster in clusters]
    return sorted(lines, key=lambda line: (-line.weight, line.items))


def _coaxial(a: Item, b: Item, alignment: float) -> bool:
    if sine(a.patch.axis, b.patch.axis) > np.sin(min(max(_tilt(a, alignment), _tilt(b, alignment)), 0.5 * np.pi)):
        return False
    apart = foot(a.patch.point, a.patch.axis, b.middle) - foot(b.patch.point, b.patch.axis, b.middle)
    reach = norm(b.middle - a.middle)
    return norm(apart) <= a.position + b.position + a.angle * reach


def _tilt(item: Item, alignment: float) -> float:
    """rad by which the axis of a patch may be off a line that it supports: its own `angle`, but no more than alignment,
    clearance and what an axis that is known at all is uncertain by."""
    engaged = float(np.ptp(item.points @ item.patch.axis))
    play = 2.0 * max(item.patch.gap, 0.0) / engaged if engaged > 0.0 else 0.0
    return max(alignment, min(item.angle, alignment + play + SIGMAS * VAGUE_AXIS))


def _fit_line(items: list[Item], indices: list[int]) -> Line:
    """The line of coaxial patches (Evidence.items of these `indices`), the largest first, by least squares.

    Unknown are two shifts and two tilts of the largest patch's axis. Each patch measures an offset from it at its own
    place along it, and a direction, with the weights of its fit and its clearance.
    """
    best = items[0]
    axis = canonical(best.patch.axis)
    if len(items) == 1:
        return Line(axis, foot(best.patch.point, axis, best.middle), best.area, tuple(indices))
    u, v = perpendicular(axis)
    origin = np.average([i.middle for i in items], axis=0, weights=[i.area for i in items])
    origin = foot(best.patch.point, axis, origin)
    normal_matrix, right = np.zeros((4, 4)), np.zeros(4)
    for item in items:
        along = item.patch.axis if item.patch.axis @ axis > 0.0 else -item.patch.axis
        z = float(axis @ (item.middle - origin))
        crossing = item.patch.point + along * ((z - float(axis @ (item.patch.point - origin))) / float(along @ axis))
        length = float(np.ptp((item.points - origin) @ axis)) + ARITHMETIC
        # what a patch does not know better than its fit and its clearance, it says less loudly
        position = max(item.position, LEAST_POSITION * length, ARITHMETIC)
        direction = max(item.patch.uncertainty[0], position / length)
        for k, unit in enumerate((u, v)):
            row = np.zeros(4)
            row[k], row[2 + k] = 1.0, z
            normal_matrix += np.outer(row, row) / position**2
            right += row * float(unit @ (crossing - origin)) / position**2
            normal_matrix[2 + k, 2 + k] += 1.0 / direction**2
            right[2 + k] += float(unit @ along) / direction**2
    weight = np.sqrt(np.diag(normal_matrix))
    solution = np.linalg.lstsq(normal_matrix / np.outer(weight, weight), right / weight, rcond=None)[0] / weight
    fitted = canonical(axis + solution[2] * u + solution[3] * v)
    return Line(fitted, origin + solution[0] * u + solution[1] * v, sum(i.area for i in items), tuple(indices))


def _centres(evidence: Evidence) -> list[Array]:
    """Centres of spherical patches, the largest first, those that agree merged."""
    slack = SOLVED * evidence.frame.length
    items = sorted((i for i in evidence.items if i.patch.kind == "sphere"), key=lambda i: -i.area)
    centres = _merge(
        [(item.patch.point, item.area, item.position) for item in items],
        lambda a, b: bool(norm(a[0] - b[0]) <= a[2] + b[2] + slack),
        lambda a, b: ((a[0] * a[1] + b[0] * b[1]) / (a[1] + b[1]), a[1] + b[1], max(a[2], b[2])),
    )
    return [centre for centre, _, _ in centres]


def _directions(candidates: Iterable[Direction], alignment: float) -> list[Direction]:
    """Directions merged up to sign within `alignment`, by their weights, the heaviest first."""

    near = math.sin(alignment)

    def mean(a: Direction, b: Direction) -> Direction:
        total = a[1] + b[1]
        direction = (a[0] * a[1] + (b[0] if b[0] @ a[0] > 0.0 else -b[0]) * b[1]) / total
        return direction / norm(direction), total

    merged = _merge(
        [(canonical(axis), weight) for axis, weight in sorted(candidates, key=lambda c: -c[1])],
        lambda a, b: sine(b[0], a[0]) <= near,
        mean,
    )
    return sorted(merged, key=lambda m: -m[1])[:MOST_DIRECTIONS]


def _slides(
    evidence: Evidence, lines: list[Line], normals: list[tuple[Array, float]], alignment: float
) -> list[tuple[Array, bool]]:
    """Directions that surfaces leave free, and whether a curved one does: axes, lines in which two planes meet, and
    directions in a plane, across the axes and those that facets beside it hold least."""
    planes = [(i.patch.axis, i.area) for i in evidence.items if i.patch.kind == "plane"]
    slides: list[tuple[Array, bool]] = [(line.axis, True) for line in lines]
    distinct = DISTINCT_SLIDE * math.sin(alignment)

    def add(direction: Array, curved: bool) -> None:
        if all(sine(direction, d) > distinct for d, _ in slides):
            slides.append((direction, curved))

    for axis, _ in _directions(
        [(i.patch.axis, i.area) for i in evidence.items if i.patch.kind == "extrusion"], alignment
    ):
        add(axis, True)
    heavy = [normal for normal, _ in normals[:MOST_NORMALS]]
    meeting = [cross(a, b) for k, a in enumerate(heavy) for b in heavy[:k]]
    for normal in heavy[:MOST_FACES]:
        meeting += [*slides_across(evidence, normal), *(cross(normal, line.axis) for line in lines)]
    for direction in meeting:
        if norm(direction) > LEAST_MEETING:
            add(_refine(canonical(direction), planes, alignment), False)
    return slides[:MOST_SLIDES]


def _refine(direction: Array, planes: list[tuple[Array, float]], alignment: float) -> Array:
    """The direction most perpendicular to all plane normals that are nearly so already."""
    if len(planes) < 2:
        return direction
    near = [(n, w) for n, w in planes if abs(float(n @ direction)) <= math.sin(alignment)]
    if len(near) < 2:
        return direction
    normals = np.array([n for n, _ in near])
    spread = normals.T @ (normals * np.array([w for _, w in near])[:, None])
    values, vectors = np.linalg.eigh(spread)
    if values[1] < ONE_NORMAL * values[2]:
        flat = direction - vectors[:, 2] * float(vectors[:, 2] @ direction)
        return canonical(flat)
    return canonical(vectors[:, 0])


def _middle(evidence: Evidence, normal: Array, alignment: float) -> Array:
    """Area centroid of the plane patches with this normal, or beside it on the normal of a line of contact across them,
    about any point of which the bodies turn exactly: where facets have the centroid is known to their size alone."""
    near = math.sin(alignment)
    members = [i for i in evidence.items if i.patch.kind == "plane" and sine(i.patch.axis, normal) <= near]
    points = np.concatenate([i.points for i in members])
    middle = weighted_mean(points, np.concatenate([i.weights for i in members]))
    lines = [i for i in evidence.items if i.patch.kind == "line" and sine(i.patch.axis, normal) < SAME_DIRECTION]
    if not lines:
        return middle
    line = max(lines, key=lambda i: (i.area, -i.index))
    return foot(line.middle, line.normals[0], middle)


def motion_words(motion: Motion) -> str:
    """In words: "rotation about (0, 0, 1)"."""
    axis = components(motion.axis)
    if motion.pitch:
        return f"screw motion about {axis}, {1e3 * motion.pitch:.4g} mm a turn"
    return f"{'rotation about' if motion.turn else 'translation along'} {axis}"
