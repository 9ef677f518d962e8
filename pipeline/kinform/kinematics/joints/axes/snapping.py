"""Makes joint axes across the assembly exactly parallel, perpendicular, coaxial and concurrent where their
uncertainty says so.

Without this a four-bar whose axes differ by the rounding of a mesh file is a rigid structure to the
rank of its closure, and a wrong trajectory to a simulation. What was moved is the misfit (`misfit`). Axes that
differ by more than the uncertainty of their fits are the designer's error and stay as they are; so do axes
that are known so badly that their uncertainty would allow what the alignment does not (`bounds`). Whatever
would have to move by more is left out of what is made to agree, the worst first, and the rest is tried again.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.foundation.algebra.vectors import canonical, cross, norm, perpendicular, sine
from kinform.foundation.records import altered
from kinform.foundation.rounding import SOLVED, TINY
from kinform.frozen import dataclass
from kinform.kinematics.joints.axes.bounds import MoveBounds
from kinform.kinematics.joints.axes.concurrence import Locus, meeting_shifts
from kinform.kinematics.joints.axes.constants import MET
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.mechanism.constants import SIGMAS
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.kinematics import Joint

LINES = ("revolute", "cylindrical", "screw")
"""Joints whose axis is a line, not only a direction."""


@dataclass(frozen=True, eq=False)
class _Axis:
    """Axis of one joint with the uncertainty of its direction (rad) and of its line (m); of a spherical
    joint the centre, where `axis` is None."""

    joint: int
    name: str
    axis: Array | None
    point: Array
    line: bool
    angle: float
    position: float
    most_angle: float
    """rad, and m: the most that it may be moved by in all, by alignment and uncertainty."""
    most_distance: float
    allowed: float
    """m: the most that it may be shifted by in all, by the alignment alone."""

    @property
    def direction(self) -> Array:
        """(3,) unit, of a joint that has one."""
        assert self.axis is not None
        return self.axis

    def foot(self, axis: Array) -> Array:
        """Where the line, made parallel to `axis`, crosses the plane through the origin."""
        foot: Array = self.point - axis * float(axis @ self.point)
        return foot

    def turn(self, direction: Array) -> float:
        """Sine of the angle by which it would be turned to this direction."""
        return sine(self.direction, direction)

    def shift(self, place: Array) -> float:
        """m: by which it would be shifted to a line or centre through this place, once it has its direction."""
        return norm(place - self.point)


@dataclass(frozen=True, eq=False)
class _Line:
    """Joints on one line, or in one direction, or with one centre: what they have in common."""

    members: tuple[_Axis, ...]
    direction: Array | None
    foot: Array | None
    """On the line, beside the best known member; None where there is nothing to agree on."""

    def locus(self, joints: Sequence[Joint]) -> Locus:
        lead = self.members[0]
        bodies = frozenset(str(body) for member in self.members for body in joints[member.joint].bodies)
        shifts = [member.shift(self.at(member)) for member in self.members]
        room = min(member.allowed - shift for member, shift in zip(self.members, shifts, strict=True))
        return Locus(self.place, self.direction, lead.angle, lead.position, bodies, room, max(shifts))

    @property
    def place(self) -> Array:
        """(3,) on the line, or the centre."""
        return self.members[0].point if self.foot is None else self.foot

    def at(self, member: _Axis) -> Array:
        """(3,) where the joint of a member is on the line."""
        along = 0.0 if self.direction is None else self.direction * float(self.direction @ (member.point - self.place))
        return np.asarray(self.place + along)

    def shift(self, shift: Array) -> _Line:
        return replace(self, foot=self.place + shift) if np.any(shift) else self


def snap_axes(joints: Sequence[Joint], bounds: MoveBounds) -> tuple[Joint, ...]:
    """The joints with snapped axes and points, none moved by more than its bounds."""
    axes = _axes(joints, bounds)
    lines = _lines([a for a in axes if a.axis is not None])
    lines += [_Line((a,), None, None) for a in axes if a.axis is None]
    placed = [k for k, line in enumerate(lines) if line.direction is None or line.members[0].line]
    shifts = meeting_shifts([lines[k].locus(joints) for k in placed], SIGMAS)
    for k, shift in zip(placed, shifts, strict=True):
        lines[k] = lines[k].shift(shift)
    out = list(joints)
    for line in lines:
        for member in line.members:
            out[member.joint] = _on_line(out[member.joint], member, line)
    return tuple(out)


def _lines(axes: Sequence[_Axis]) -> list[_Line]:
    """Axes in bundles of one direction, and those again on common lines."""
    bundles = _bundles(sorted(axes, key=lambda a: (a.angle, a.name)))
    means = [_mean_direction(bundle) for bundle in bundles]
    lines = []
    for bundle, direction in zip(bundles, _square(bundles, means), strict=True):
        for group in _coaxial(bundle, direction):
            foot = None
            if len(group) > 1:
                foot = _mean_foot(group, direction)
                foot = foot + direction * float(direction @ (group[0].point - foot))
            lines.append(_Line(tuple(group), direction, foot))
    return lines


def _axes(joints: Sequence[Joint], bounds: MoveBounds) -> list[_Axis]:
    """Of the joints that have one, or a centre."""
    of_joints = zip(joints, bounds.sigma.tolist(), bounds.most.tolist(), bounds.allowed.tolist(), strict=True)
    return [
        _Axis(
            joint=index,
            name=joint.name,
            axis=joint.axis,
            point=np.zeros(3) if joint.point is None else joint.point,
            line=joint.type in LINES,
            angle=0.0 if joint.axis is None else angle,
            position=position,
            most_angle=most_angle,
            most_distance=most_distance,
            allowed=allowed,
        )
        for index, (joint, (angle, position), (most_angle, most_distance), (_, allowed)) in enumerate(of_joints)
        if joint.type == "spherical" or (joint.axis is not None and joint.type not in ("general", "universal"))
    ]


def _bundles(axes: Sequence[_Axis]) -> list[list[_Axis]]:
    """Axes of one direction, none farther from their mean than it may be turned."""
    directions = np.array([a.direction for a in axes]).reshape(-1, 3)
    most = np.array([a.most_angle for a in axes])

    def parallel(leaders: Ints, k: int) -> Flags:
        off = np.linalg.norm(cross(directions[leaders], directions[k]), axis=1)
        return np.asarray(off <= most[leaders] + most[k])

    def excess(bundle: Sequence[_Axis]) -> list[float]:
        mean = _mean_direction(bundle)
        return [a.turn(mean) / a.most_angle for a in bundle]

    return _cluster(axes, parallel, excess)


def _coaxial(bundle: Sequence[_Axis], direction: Array) -> list[list[_Axis]]:
    """Of axes of one direction those on one line, none farther from their mean than it may be shifted."""
    feet = np.array([a.foot(direction) for a in bundle])
    most = np.array([a.most_distance for a in bundle])
    lines = np.array([a.line for a in bundle])

    def coaxial(leaders: Ints, k: int) -> Flags:
        apart = np.sqrt(np.square(feet[leaders] - feet[k]).sum(axis=1))
        return np.asarray(lines[leaders] & lines[k] & (apart <= most[leaders] + most[k]))

    def excess(group: Sequence[_Axis]) -> list[float]:
        mean = _mean_foot(group, direction)
        return [norm(a.foot(direction) - mean) / max(a.most_distance, TINY) for a in group]

    return _cluster(bundle, coaxial, excess, _within(feet, 2.0 * float(most.max())))


def _within(places: Array, reach: float) -> Callable[[int], Ints]:
    """Of each of the places (n, 3) by its number, those that are no farther than `reach` from it along the coordinate
    in which they differ most: all that are so near, and some more."""
    along = places[:, int(np.ptp(places, axis=0).argmax())]
    order = along.argsort(kind="stable")
    reach += SOLVED * float(np.abs(along).max())
    low, high = (np.searchsorted(along[order], along + side * reach) for side in (-1.0, 1.0))
    return lambda k: order[low[k] : high[k]]


def _cluster(
    members: Sequence[_Axis],
    agree: Callable[[Ints, int], Flags],
    excess: Callable[[Sequence[_Axis]], list[float]],
    near: Callable[[int], Ints] | None = None,
) -> list[list[_Axis]]:
    """Greedy clusters: each member joins the first cluster whose leader it agrees with; `near`, where it is given, has
    all members that one may agree with. `excess` says by what share of its bound each of a cluster would be moved: the
    worst beyond it leaves, and starts anew with what else has left."""
    clusters: list[list[_Axis]] = []
    indices = {id(member): k for k, member in enumerate(members)}
    rest = list(members)
    while rest:
        left: list[_Axis] = []
        for cluster in _greedy(rest, indices, agree, near):
            while len(cluster) > 1:
                shares = excess(cluster)
                worst = int(np.argmax(shares))
                if shares[worst] <= 1.0:
                    break
                left.append(cluster.pop(worst))
            clusters.append(cluster)
        rest = sorted(left, key=lambda member: indices[id(member)])
    return clusters


def _greedy(
    members: Sequence[_Axis],
    indices: Mapping[int, int],
    agree: Callable[[Ints, int], Flags],
    near: Callable[[int], Ints] | None,
) -> list[list[_Axis]]:
    clusters: list[list[_Axis]] = []
    leaders = np.zeros(len(members), dtype=np.int64)
    led = np.full(len(indices), -1)
    for member in members:
        k = indices[id(member)]
        asked = leaders[: len(clusters)] if near is None else near(k)
        asked = asked[led[asked] >= 0]
        good = led[asked[agree(asked, k)]]
        if len(good):
            clusters[int(good.min())].append(member)
        else:
            leaders[len(clusters)], led[k] = k, len(clusters)
            clusters.append([member])
    return clusters


def _mean_direction(bundle: Sequence[_Axis]) -> Array:
    if len(bundle) == 1:
        return bundle[0].direction
    lead = bundle[0].direction
    signed = [a.direction / a.angle**2 * (1.0 if float(a.direction @ lead) > 0.0 else -1.0) for a in bundle]
    # far below any uncertainty: the rounding of one axis is not carried to all others
    # Decimals of a direction that several axes have in common: the rounding of one is not carried to all others.
    return canonical(np.round(canonical(np.sum(signed, axis=0)), 12))


def _mean_foot(group: Sequence[_Axis], direction: Array) -> Array:
    weights = [1.0 / a.position**2 for a in group]
    return np.asarray(np.average([a.foot(direction) for a in group], axis=0, weights=weights))


def _square(bundles: Sequence[Sequence[_Axis]], directions: Sequence[Array]) -> list[Array]:
    """The directions of bundles with those exactly perpendicular that are so within their uncertainties.

    Pairs for which an axis would be turned by more than it may, the mean of its bundle included, are left out: all
    pairs of the worst bundle, and then the rest is tried again.
    """
    out = [np.asarray(d) for d in directions]
    if len(out) < 2:
        return out
    sigma = np.array([bundle[0].angle for bundle in bundles])
    most = np.array([bundle[0].most_angle for bundle in bundles])
    cosine = np.abs(np.array(out) @ np.array(out).T)
    first, second = np.nonzero(np.triu(cosine <= most[:, None] + most[None], 1))
    while len(first):
        squared = _squared(out, sigma, first, second)
        excess = {
            k: max(a.turn(squared[k]) / a.most_angle for a in bundles[k])
            for k in sorted({*first.tolist(), *second.tolist()})
        }
        worst = max(excess, key=lambda k: excess[k])
        if excess[worst] <= 1.0:
            return squared
        keep = (first != worst) & (second != worst)
        first, second = first[keep], second[keep]
    return out


def _squared(directions: Sequence[Array], sigma: Array, first: Ints, second: Ints) -> list[Array]:
    """The directions with these pairs of them made perpendicular.

    The least turns, each weighed by its uncertainty (rad), that satisfy all these conditions to first order;
    a second round removes what is of second order.
    """
    out = list(directions)
    for _ in range(2):
        turns = [np.array(perpendicular(d)) for d in out]
        matrix = np.zeros((len(first), 2 * len(out)))
        for row, (i, j) in enumerate(zip(first, second, strict=True)):
            matrix[row, 2 * i : 2 * i + 2] = sigma[i] / sigma.max() * (turns[i] @ out[j])
            matrix[row, 2 * j : 2 * j + 2] = sigma[j] / sigma.max() * (turns[j] @ out[i])
        missing = -np.array([out[i] @ out[j] for i, j in zip(first, second, strict=True)])
        missing[np.abs(missing) < MET] = 0.0
        if not np.any(missing):
            break
        solution = np.linalg.lstsq(matrix, missing, rcond=SOLVED)[0].reshape(-1, 2)
        for k in sorted({*first.tolist(), *second.tolist()}):
            turned = out[k] + sigma[k] / sigma.max() * (solution[k] @ turns[k])
            out[k] = canonical(turned) if np.any(turned != out[k]) else out[k]
    return out


def _on_line(joint: Joint, member: _Axis, line: _Line) -> Joint:
    """The joint on its snapped line."""
    point = joint.point if line.foot is None else line.at(member)
    twists = twists_of(joint.type, line.direction, point, joint.pitch, joint.axis2)
    return altered(joint, axis=line.direction, point=point, twists=twists)
