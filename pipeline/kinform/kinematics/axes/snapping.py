"""Makes joint axes across the assembly exactly parallel, perpendicular, coaxial and concurrent where their
uncertainty says so.

Without this a four-bar whose axes differ by the rounding of a mesh file is a rigid structure to the
rank of its closure, and a wrong trajectory to a simulation. What was moved is the misfit. Axes that
differ by more than the uncertainty of their fits are the designer's error and stay as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kinform.foundation.algebra.vectors import canonical, cross, perpendicular
from kinform.kinematics.axes.concurrence import Locus, meeting_shifts
from kinform.kinematics.constants import DIRECTION_DECIMALS, EXACT_AXIS, MET, RCOND, SIGMAS, UNMOVED
from kinform.kinematics.pair.joint import twists_of
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint, Misfit

LINES = ("revolute", "cylindrical", "screw")
"""Joints whose axis is a line, not only a direction."""
CARRIERS = ("cylinder", "cone", "sphere")
"""Kinds of patches whose fits say best where a joint is."""


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

    @property
    def direction(self) -> Array:
        """(3,) unit, of a joint that has one."""
        assert self.axis is not None
        return self.axis

    def foot(self, axis: Array) -> Array:
        """Where the line, made parallel to `axis`, crosses the plane through the origin."""
        foot: Array = self.point - axis * float(axis @ self.point)
        return foot


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
        foot = lead.point if self.foot is None else self.foot
        return Locus(foot, self.direction, lead.angle, lead.position, bodies)

    def shift(self, shift: Array, joints: Sequence[Joint]) -> _Line:
        return replace(self, foot=self.locus(joints).point + shift) if np.any(shift) else self


def snap_axes(joints: Sequence[Joint], patches: Sequence[Patch], reach: float) -> tuple[tuple[Joint, ...], Misfit]:
    """The joints with snapped axes and points, and the misfit. `reach`: size of the assembly (m)."""
    axes = [a for a in (_axis(k, joint, patches, reach) for k, joint in enumerate(joints)) if a is not None]
    lines = _lines([a for a in axes if a.axis is not None])
    lines += [_Line((a,), None, None) for a in axes if a.axis is None]
    placed = [k for k, line in enumerate(lines) if line.direction is None or line.members[0].line]
    shifts = meeting_shifts([lines[k].locus(joints) for k in placed], SIGMAS)
    for k, shift in zip(placed, shifts, strict=True):
        lines[k] = lines[k].shift(shift, joints)
    out, misfit = list(joints), Misfit()
    for line in lines:
        for member in line.members:
            out[member.joint], misfit = _on_line(out[member.joint], member, line, misfit)
    return tuple(out), misfit


def uncertainties(joints: Sequence[Joint], patches: Sequence[Patch]) -> Array:
    """(joints, 2): of the direction (rad) and of the place (m) of each joint, by its best patch; 0 where it has none.
    Patches on facets of no known surface have no say."""
    out = np.zeros((len(joints), 2))
    for k, joint in enumerate(joints):
        mating = [patches[p] for p in joint.patches if not patches[p].one_sided]
        carriers = [p for p in mating if p.kind in CARRIERS] or mating
        out[k] = [min((p.uncertainty[n] for p in carriers), default=0.0) for n in (0, 1)]
    return out


def _lines(axes: Sequence[_Axis]) -> list[_Line]:
    """Axes in bundles of one direction, and those again on common lines."""
    bundles = _bundles(sorted(axes, key=lambda a: (a.angle, a.name)))
    means = [_mean_direction(bundle) for bundle in bundles]
    lines = []
    for bundle, direction in zip(bundles, _square(means, [b[0].angle for b in bundles]), strict=True):
        for group in _coaxial(bundle, direction):
            foot = None
            if len(group) > 1:
                foot = _mean_foot(group, direction)
                foot = foot + direction * float(direction @ (group[0].point - foot))
            lines.append(_Line(tuple(group), direction, foot))
    return lines


def _axis(index: int, joint: Joint, patches: Sequence[Patch], reach: float) -> _Axis | None:
    if joint.type in ("general", "universal") or (joint.axis is None and joint.type != "spherical"):
        return None
    touching = [patches[k] for k in joint.patches]
    directed = [p for p in touching if np.any(p.axis)] if joint.axis is not None else []
    carriers = [p for p in touching if p.kind in CARRIERS] or directed
    angle = min((p.uncertainty[0] for p in carriers if np.any(p.axis)), default=0.0)
    position = min((p.uncertainty[1] for p in carriers), default=0.0)
    return _Axis(
        joint=index,
        name=joint.name,
        axis=joint.axis,
        point=np.zeros(3) if joint.point is None else joint.point,
        line=joint.type in LINES,
        angle=max(angle, EXACT_AXIS) if joint.axis is not None else 0.0,
        position=max(position, EXACT_AXIS * reach),
    )


def _bundles(axes: Sequence[_Axis]) -> list[list[_Axis]]:
    """Axes of one direction."""
    directions = np.array([a.direction for a in axes]).reshape(-1, 3)
    angles = np.array([a.angle for a in axes])

    def parallel(leaders: Ints, k: int) -> Flags:
        sine = np.linalg.norm(cross(directions[leaders], directions[k]), axis=1)
        return np.asarray(sine <= SIGMAS * (angles[leaders] + angles[k]))

    return _cluster(axes, parallel)


def _coaxial(bundle: Sequence[_Axis], direction: Array) -> list[list[_Axis]]:
    """Of axes of one direction those on one line."""
    feet = np.array([a.foot(direction) for a in bundle])
    positions = np.array([a.position for a in bundle])
    lines = np.array([a.line for a in bundle])

    def coaxial(leaders: Ints, k: int) -> Flags:
        apart = np.linalg.norm(feet[leaders] - feet[k], axis=1)
        return np.asarray(lines[leaders] & lines[k] & (apart <= SIGMAS * (positions[leaders] + positions[k])))

    return _cluster(bundle, coaxial)


def _cluster(members: Sequence[_Axis], agree: Callable[[Ints, int], Flags]) -> list[list[_Axis]]:
    """Greedy clusters: each member joins the first cluster whose leader it agrees with."""
    clusters: list[list[_Axis]] = []
    leaders = np.zeros(len(members), dtype=np.int64)
    for k, member in enumerate(members):
        good = agree(leaders[: len(clusters)], k)
        if good.any():
            clusters[int(np.argmax(good))].append(member)
        else:
            leaders[len(clusters)] = k
            clusters.append([member])
    return clusters


def _mean_direction(bundle: Sequence[_Axis]) -> Array:
    if len(bundle) == 1:
        return bundle[0].direction
    lead = bundle[0].direction
    signed = [a.direction / a.angle**2 * (1.0 if float(a.direction @ lead) > 0.0 else -1.0) for a in bundle]
    # far below any uncertainty: the rounding of one axis is not carried to all others
    return canonical(np.round(canonical(np.sum(signed, axis=0)), DIRECTION_DECIMALS))


def _mean_foot(group: Sequence[_Axis], direction: Array) -> Array:
    weights = [1.0 / a.position**2 for a in group]
    return np.asarray(np.average([a.foot(direction) for a in group], axis=0, weights=weights))


def _square(directions: Sequence[Array], angles: Sequence[float]) -> list[Array]:
    """The directions with those exactly perpendicular that are so within their uncertainties (rad).

    The least turns, each weighed by its uncertainty, that satisfy all these conditions to first order;
    a second round removes what is of second order.
    """
    out = [np.asarray(d) for d in directions]
    if len(out) < 2:
        return out
    cosine = np.abs(np.array(out) @ np.array(out).T)
    sigma = np.asarray(angles)
    first, second = np.nonzero(np.triu(cosine <= SIGMAS * (sigma[:, None] + sigma[None]), 1))
    for _ in range(2):
        if not len(first):
            break
        turns = [np.array(perpendicular(d)) for d in out]
        matrix = np.zeros((len(first), 2 * len(out)))
        for row, (i, j) in enumerate(zip(first, second, strict=True)):
            matrix[row, 2 * i : 2 * i + 2] = sigma[i] / sigma.max() * (turns[i] @ out[j])
            matrix[row, 2 * j : 2 * j + 2] = sigma[j] / sigma.max() * (turns[j] @ out[i])
        missing = -np.array([out[i] @ out[j] for i, j in zip(first, second, strict=True)])
        missing[np.abs(missing) < MET] = 0.0
        if not np.any(missing):
            break
        solution = np.linalg.lstsq(matrix, missing, rcond=RCOND)[0].reshape(-1, 2)
        for k in sorted({*first.tolist(), *second.tolist()}):
            turned = out[k] + sigma[k] / sigma.max() * (solution[k] @ turns[k])
            out[k] = canonical(turned) if np.any(turned != out[k]) else out[k]
    return out


def _on_line(joint: Joint, old: _Axis, line: _Line, misfit: Misfit) -> tuple[Joint, Misfit]:
    """The joint on its snapped line, and the misfit with what that moved."""
    direction, point = line.direction, joint.point
    if direction is not None:
        angle = float(np.linalg.norm(cross(old.direction, direction)))
        if angle > max(misfit.angle, UNMOVED):
            misfit = replace(misfit, angle=angle, angle_at=old.name)
    if line.foot is not None:
        along = 0.0 if direction is None else direction * float(direction @ (old.point - line.foot))
        point = line.foot + along
        distance = float(np.linalg.norm(point - old.point))
        if distance > max(misfit.distance, UNMOVED * float(np.abs(old.point).max())):
            misfit = replace(misfit, distance=distance, distance_at=old.name)
    twists = twists_of(joint.type, direction, point, joint.pitch, joint.axis2)
    return replace(joint, axis=direction, point=point, twists=twists), misfit
