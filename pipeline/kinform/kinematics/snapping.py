"""Makes joint axes across the assembly exactly parallel and coaxial where their uncertainty says so.

Without this a four-bar whose axes differ by the rounding of a mesh file is a rigid structure to the
rank of its closure, and a wrong trajectory to a simulation. What was moved is the misfit. Axes that
differ by more than the uncertainty of their fits are the designer's error and stay as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from kinform.kinematics.joints import twists_of
from kinform.kinematics.screws import canonical
from kinform.model.contacts import Patch
from kinform.model.kinematics import Joint, Misfit

__all__ = ["snap"]

Array = NDArray[np.float64]

SIGMAS = 3.0
"""Two axes agree when they differ by less than this many times the sum of their uncertainties."""
ROUNDING = 1e-9
"""Uncertainty (rad, and relative to the reach) of exact geometry in double precision."""
LINES = ("revolute", "cylindrical", "screw")
"""Joints whose axis is a line, not only a direction."""


@dataclass(frozen=True, eq=False)
class _Axis:
    """Axis of one joint with the uncertainty of its direction (rad) and of its line (m)."""

    joint: int
    name: str
    axis: Array
    point: Array
    line: bool
    angle: float
    position: float

    def foot(self, axis: Array) -> Array:
        """Where the line, made parallel to `axis`, crosses the plane through the origin."""
        foot: Array = self.point - axis * float(axis @ self.point)
        return foot


def snap(joints: Sequence[Joint], patches: Sequence[Patch], reach: float) -> tuple[tuple[Joint, ...], Misfit]:
    """The joints with snapped axes and points, and the misfit. `reach`: size of the assembly (m)."""
    axes = [a for a in (_axis(k, joint, patches, reach) for k, joint in enumerate(joints)) if a is not None]
    axes.sort(key=lambda a: (a.angle, a.name))
    out, misfit = list(joints), Misfit()
    for bundle in _cluster(axes, _parallel):
        direction = _mean_direction(bundle)
        for group in _cluster(bundle, partial(_coaxial, direction)):
            common = _mean_foot(group, direction) if len(group) > 1 else None
            for member in group:
                out[member.joint], misfit = _moved(out[member.joint], member, direction, common, misfit)
    return tuple(out), misfit


def _axis(index: int, joint: Joint, patches: Sequence[Patch], reach: float) -> _Axis | None:
    if joint.axis is None or joint.type in ("general", "universal"):
        return None
    directed = [patches[k] for k in joint.patches if np.any(patches[k].axis)]
    carriers = [p for p in directed if p.kind in ("cylinder", "cone")] or directed
    angle = min((p.uncertainty[0] for p in carriers), default=0.0)
    position = min((p.uncertainty[1] for p in carriers), default=0.0)
    return _Axis(
        joint=index,
        name=joint.name,
        axis=joint.axis,
        point=np.zeros(3) if joint.point is None else joint.point,
        line=joint.type in LINES,
        angle=max(angle, ROUNDING),
        position=max(position, ROUNDING * reach),
    )


def _cluster(members: Sequence[_Axis], agree: Callable[[_Axis, _Axis], bool]) -> list[list[_Axis]]:
    """Greedy clusters: each member joins the first cluster whose leader it agrees with."""
    clusters: list[list[_Axis]] = []
    for member in members:
        for cluster in clusters:
            if agree(cluster[0], member):
                cluster.append(member)
                break
        else:
            clusters.append([member])
    return clusters


def _parallel(a: _Axis, b: _Axis) -> bool:
    return float(np.linalg.norm(np.cross(a.axis, b.axis))) <= SIGMAS * (a.angle + b.angle)


def _coaxial(direction: Array, a: _Axis, b: _Axis) -> bool:
    apart = float(np.linalg.norm(a.foot(direction) - b.foot(direction)))
    return a.line and b.line and apart <= SIGMAS * (a.position + b.position)


def _mean_direction(bundle: Sequence[_Axis]) -> Array:
    if len(bundle) == 1:
        return bundle[0].axis
    lead = bundle[0].axis
    signed = [a.axis / a.angle**2 * (1.0 if float(a.axis @ lead) > 0.0 else -1.0) for a in bundle]
    return canonical(np.sum(signed, axis=0))


def _mean_foot(group: Sequence[_Axis], direction: Array) -> Array:
    weights = [1.0 / a.position**2 for a in group]
    return np.asarray(np.average([a.foot(direction) for a in group], axis=0, weights=weights))


def _moved(joint: Joint, old: _Axis, direction: Array, foot: Array | None, misfit: Misfit) -> tuple[Joint, Misfit]:
    """The joint on its snapped line, and the misfit with what that moved."""
    angle = float(np.linalg.norm(np.cross(old.axis, direction)))
    if angle > misfit.angle:
        misfit = replace(misfit, angle=angle, angle_at=old.name)
    point = joint.point
    if foot is not None:
        point = foot + direction * float(direction @ old.point)
        distance = float(np.linalg.norm(point - old.point))
        if distance > misfit.distance:
            misfit = replace(misfit, distance=distance, distance_at=old.name)
    twists = twists_of(joint.type, direction, point, joint.pitch, joint.axis2)
    return replace(joint, axis=direction, point=point, twists=twists), misfit
