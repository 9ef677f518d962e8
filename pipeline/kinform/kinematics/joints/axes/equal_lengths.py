"""Four-bars whose sides are equal within their uncertainty, made exactly so: parallelograms, kites, rhombs.

Such loops pass flat poses in which two branches of their motion meet. Sides that differ by the rounding of a mesh file
part the branches by a hair, and a simulation that is exact turns the corner: the parallelogram leaves its flat pose as
an antiparallelogram, which no machine does. Nobody draws sides that are equal to eight digits and means them to differ.

Known here: pins, the points in which hinges of one direction cross a plane; sides between them; the least shifts of the
pins, each weighed by its uncertainty, that make sides equal (Gauss and Newton). A parallelogram as it is drawn, not
crossed, has opposite sides that are equal vectors: that says more than equal lengths where several cranks stand in one
row, and holds in the flat pose too. Pins that would have to be shifted by more than their bounds are left as they are,
with all sides that need them, and the rest is tried again.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from kinform.foundation.algebra.vectors import cross, norm, perpendicular
from kinform.foundation.graphs.graph import blocks
from kinform.foundation.rounding import ARITHMETIC, SINGLE, TINY
from kinform.frozen import dataclass
from kinform.kinematics.joints.axes.bounds import MoveBounds
from kinform.kinematics.joints.axes.constants import FITTING_ROUNDS, MET
from kinform.kinematics.joints.axes.snapping import LINES
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.mechanism.joint_graph import JointGraph
from kinform.model.arrays import Array
from kinform.model.kinematics import Joint

MOST_COMPARED_JOINTS = 400
"""Blocks with more joints are left as they are: loops of four bodies grow with their square. Chosen, not measured."""
EQUAL_SIDES = 4e-15
"""Share of the assembly's size by which sides that are equal differ: a few roundings of its coordinates."""


@dataclass(frozen=True, eq=False)
class _Pin:
    """Joints of one block on one line."""

    joints: tuple[int, ...]
    place: Array
    """(2,) m: where the line crosses the plane."""
    sigma: float
    """m: standard uncertainty of the best known of its joints."""
    most: float
    """m by which all of them may be shifted."""


@dataclass(frozen=True)
class _Equality:
    """Sides a → b and c → d, by their pins, that are equal: as vectors, or in length."""

    a: int
    b: int
    c: int
    d: int
    vectors: bool

    @property
    def pins(self) -> tuple[int, int, int, int]:
        return self.a, self.b, self.c, self.d


def equalise_lengths(graph: JointGraph, bounds: MoveBounds, size: float) -> tuple[Joint, ...]:
    """The joints, with sides of four-bars that are equal within the bounds made equal; `size` of the assembly (m)."""
    out = list(graph.joints)
    for block in blocks(len(graph.bodies), graph.edges):
        if 4 <= len(block) <= MOST_COMPARED_JOINTS:
            for members in _parallel([k for k in block if _is_hinge(out[k])], out):
                for k, joint in _equal_sides(graph, members, out, bounds, size):
                    out[k] = joint
    return tuple(out)


def _is_hinge(joint: Joint) -> bool:
    return joint.type in LINES and joint.status != "ambiguous"


def _parallel(candidates: Sequence[int], joints: Sequence[Joint]) -> list[list[int]]:
    """Joints whose axes are exactly parallel, as snapping makes them; four at least."""
    bundles: list[list[int]] = []
    for k in candidates:
        for bundle in bundles:
            if norm(cross(_axis(joints[bundle[0]]), _axis(joints[k]))) < ARITHMETIC:
                bundle.append(k)
                break
        else:
            bundles.append([k])
    return [bundle for bundle in bundles if len(bundle) >= 4]


def _axis(joint: Joint) -> Array:
    assert joint.axis is not None
    return joint.axis


def _point(joint: Joint) -> Array:
    assert joint.point is not None
    return joint.point


def _equal_sides(
    graph: JointGraph, members: Sequence[int], joints: Sequence[Joint], bounds: MoveBounds, size: float
) -> Iterator[tuple[int, Joint]]:
    """(index, joint) of those of parallel joints that are shifted."""
    plane = np.array(perpendicular(_axis(joints[members[0]])))
    pins = _pins(members, joints, bounds, plane, size)
    pin_of = {k: n for n, pin in enumerate(pins) for k in pin.joints}
    edges = {k: graph.edges[k] for k in members}
    equalities = [e for cycle in _cycles(edges) for e in _equalities([pin_of[k] for k in cycle], pins)]
    for pin, shift in zip(pins, _shifts(pins, equalities, size), strict=True):
        if shift.any():
            yield from ((k, _shifted(joints[k], shift @ plane)) for k in pin.joints)


def _pins(members: Sequence[int], joints: Sequence[Joint], bounds: MoveBounds, plane: Array, size: float) -> list[_Pin]:
    """Lines of the joints, those that are on one line exactly together."""
    pins: list[_Pin] = []
    for k in members:
        place = plane @ _point(joints[k])
        sigma, most = float(bounds.sigma[k, 1]), float(bounds.most[k, 1])
        for n, pin in enumerate(pins):
            # lines that were made coaxial are apart by rounding only
            if norm(pin.place - place) <= ARITHMETIC * size:
                pins[n] = _Pin((*pin.joints, k), pin.place, min(pin.sigma, sigma), min(pin.most, most))
                break
        else:
            pins.append(_Pin((k,), place, sigma, most))
    return pins


def _cycles(edges: dict[int, tuple[int, int]]) -> list[tuple[int, int, int, int]]:
    """Loops of four joints, in the order of walking through four bodies."""
    joint_of = {frozenset(edge): k for k, edge in edges.items()}
    around: dict[int, list[int]] = {}
    for a, b in edges.values():
        around.setdefault(a, []).append(b)
        around.setdefault(b, []).append(a)
    ends: dict[tuple[int, int], list[int]] = {}
    for middle in sorted(around):
        for pair in combinations(sorted(around[middle]), 2):
            ends.setdefault(pair, []).append(middle)
    cycles = []
    for (a, c), middles in sorted(ends.items()):
        for b, d in combinations(middles, 2):
            # each loop has two pairs of opposite bodies: it is met twice
            if a < b:
                walk = ((a, b), (b, c), (c, d), (d, a))
                first, second, third, fourth = (joint_of[frozenset(edge)] for edge in walk)
                cycles.append((first, second, third, fourth))
    return cycles


def _equalities(cycle: Sequence[int], pins: Sequence[_Pin]) -> Iterator[_Equality]:
    """Which sides of a loop of four pins are equal within their bounds, where that makes it fold flat."""
    if len(set(cycle)) < 4:
        return
    slack = sum(pins[n].most for n in cycle)
    places = [pins[n].place for n in cycle]
    sides = [places[(k + 1) % 4] - places[k] for k in range(4)]
    lengths = [norm(side) for side in sides]
    # Times what the pins of a loop may be shifted by in all that each of its sides is long at least: shorter sides are
    # equal to anything.
    if min(lengths) <= 100.0 * slack:
        return

    def equal(i: int, j: int) -> bool:
        return abs(lengths[i] - lengths[j]) <= slack

    def sides_of(i: int, j: int, vectors: bool = False) -> _Equality:
        # walked in opposite senses, so that equal vectors are those of a parallelogram
        return _Equality(cycle[i], cycle[(i + 1) % 4], cycle[(j + 1) % 4], cycle[j], vectors)

    if equal(0, 2) and equal(1, 3):
        drawn_open = norm(sides[0] + sides[2]) <= slack
        # of vectors one pair of sides says it all
        yield sides_of(0, 2, drawn_open)
        if not drawn_open:
            yield sides_of(1, 3)
    for i, j in ((0, 1), (1, 2)):
        if equal(i, j) and equal(i + 2, (j + 2) % 4):
            yield sides_of(i, j)
            yield sides_of(i + 2, (j + 2) % 4)


def _shifts(pins: Sequence[_Pin], equalities: Sequence[_Equality], size: float) -> Array:
    """(pins, 2) m: the least shifts that make sides equal, none beyond its pin's bound."""
    rest = list(equalities)
    start = np.array([pin.place for pin in pins]).reshape(-1, 2)
    start = start - start.mean(axis=0)
    most = np.array([pin.most for pin in pins])
    while rest:
        if np.abs(_unequal(start, rest)).max() <= EQUAL_SIDES * size:
            break
        shifts = _solve(start, np.array([pin.sigma for pin in pins]), rest)
        excess = np.linalg.norm(shifts, axis=1) / np.maximum(most, TINY)
        worst = int(np.argmax(excess))
        if excess[worst] <= 1.0:
            closed = np.abs(_unequal(start + shifts, rest)).max() <= EQUAL_SIDES * size
            return shifts if closed else np.zeros_like(start)
        rest = [e for e in rest if worst not in e.pins]
    return np.zeros_like(start)


def _solve(start: Array, sigma: Array, equalities: Sequence[_Equality]) -> Array:
    """(pins, 2) m: least shifts in terms of the uncertainties, by Gauss and Newton."""
    weigh = np.repeat(sigma / sigma.max(), 2)
    shifts = np.zeros_like(start)
    for _ in range(FITTING_ROUNDS):
        places = start + shifts
        rows, missing = _rows(places, equalities), _unequal(places, equalities)
        step = np.linalg.lstsq(rows * weigh, -missing, rcond=SINGLE)[0] * weigh
        shifts = shifts + step.reshape(-1, 2)
        if np.abs(step).max() <= MET * float(np.abs(start).max()):
            break
    return shifts


def _unequal(places: Array, equalities: Sequence[_Equality]) -> Array:
    """m: what sides differ by; two numbers where vectors are compared, else one."""
    out: list[float] = []
    for e in equalities:
        one, other = places[e.b] - places[e.a], places[e.d] - places[e.c]
        difference = one - other if e.vectors else [norm(one) - norm(other)]
        out.extend(float(x) for x in difference)
    return np.array(out)


def _rows(places: Array, equalities: Sequence[_Equality]) -> Array:
    """Derivatives of `_unequal` by the coordinates of all pins."""
    rows = []
    for e in equalities:
        one, other = places[e.b] - places[e.a], places[e.d] - places[e.c]
        along = [(np.eye(2)[k], np.eye(2)[k]) for k in range(2)]
        if not e.vectors:
            along = [(one / norm(one), other / norm(other))]
        for first, second in along:
            row = np.zeros_like(places)
            row[e.b] += first
            row[e.a] -= first
            row[e.d] -= second
            row[e.c] += second
            rows.append(row.ravel())
    return np.array(rows)


def _shifted(joint: Joint, shift: Array) -> Joint:
    point = _point(joint) + shift
    return replace(joint, point=point, twists=twists_of(joint.type, joint.axis, point, joint.pitch, joint.axis2))
