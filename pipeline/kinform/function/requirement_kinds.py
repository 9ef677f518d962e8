"""Kinds of requirements: what each asks for, typed, SI and radians, world frame at the pose of the meshes.

The manifest's tables are in `form/manifest/requirements.py`, which also says what every key means. A stored requirement
has their values by key (`kinform.model.function.Requirement`); `Kind.read` makes them what a judge reads. Keys that a
newer table has besides are left aside.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, fields
from typing import Any, ClassVar, Self

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array


def _values_of(record: type, values: Mapping[str, Any]) -> dict[str, Any]:
    """Of the stored values those that the record has, lists of numbers as arrays."""
    stored = {f: values[f.name] for f in fields(record) if values.get(f.name) is not None}
    return {
        f.name: np.array(value, dtype=np.float64) if str(f.type).startswith("Array") else value
        for f, value in stored.items()
    }


@dataclass(frozen=True, eq=False)
class Cone:
    """Directions within `half_angle` (rad) of the unit `axis` (3,)."""

    axis: Array
    half_angle: float


@dataclass(frozen=True, eq=False)
class Box:
    """A box between two corners (3,) m along the axes of a frame with the pose `X_WF` (4, 4)."""

    lower: Array
    upper: Array
    X_WF: Array


@dataclass(frozen=True, eq=False)
class Poses:
    """Single places (n, 3) m, or single directions (n, 3)."""

    points: Array = field(default_factory=lambda: np.zeros((0, 3)))
    directions: Array = field(default_factory=lambda: np.zeros((0, 3)))


Region = Cone | Box | Poses
REGIONS: Mapping[str, type[Region]] = {"cone": Cone, "box": Box, "poses": Poses}


class Kind:
    """One kind of requirement; a subclass is the record of what it asks for."""

    kind: ClassVar[str]

    @classmethod
    def read(cls, values: Mapping[str, Any]) -> Self:
        """The record of the values that a requirement is stored with."""
        return cls(**_values_of(cls, values))


@dataclass(frozen=True, eq=False)
class Reach(Kind):
    """A point (3,) m, or a direction (3,), that a part carries covers a region."""

    kind = "reach"
    part: str
    region: Region
    point: Array | None = None
    direction: Array | None = None
    tolerance: float | None = None
    angle_tolerance: float | None = None

    @classmethod
    def read(cls, values: Mapping[str, Any]) -> Self:
        """The record, with its region."""
        region = values["region"]
        shape = REGIONS[region["type"]]
        return super().read({**values, "region": shape(**_values_of(shape, region))})


@dataclass(frozen=True, eq=False)
class Follow(Kind):
    """A point (3,) m that a part carries follows `rows` (n, 4) of t, x, y, z or (n, 8) with qw, qx, qy, qz."""

    kind = "follow"
    part: str
    point: Array
    tolerance: float
    angle_tolerance: float | None = None
    rows: Array = field(default_factory=lambda: np.zeros((0, 4)))


@dataclass(frozen=True, eq=False)
class Clear(Kind):
    """Two parts or groups, or all bodies, keep a distance (m) over the "motion" or the "ranges"."""

    kind = "clear"
    between: Sequence[str] | None = None
    over: str = "motion"
    distance: float = 0.0


@dataclass(frozen=True, eq=False)
class Hold(Kind):
    """A joint takes at most `limit` (N·m or N) to hold poses: joint values by name, none for the pose of the meshes."""

    kind = "hold"
    joint: str
    limit: float
    poses: Sequence[Mapping[str, float]] = ()


@dataclass(frozen=True, eq=False)
class Efficiency(Kind):
    """Of the work that a joint's drive puts in as it moves slowly against the load at least the share `minimum` comes
    out, in these poses."""

    kind = "efficiency"
    joint: str
    minimum: float
    poses: Sequence[Mapping[str, float]] = ()


@dataclass(frozen=True, eq=False)
class SelfLocking(Kind):
    """A joint stays in these poses under the load when nothing drives it."""

    kind = "self_locking"
    joint: str
    poses: Sequence[Mapping[str, float]] = ()


@dataclass(frozen=True, eq=False)
class JointLimit(Kind):
    """Something of a joint stays below `limit` in the simulation."""

    joint: str
    limit: float


class Torque(JointLimit):
    """The effort that its drive gives: N·m or N."""

    kind = "torque"


class Speed(JointLimit):
    """Its speed: rad/s or m/s."""

    kind = "speed"


@dataclass(frozen=True, eq=False)
class TorqueSpeed(Kind):
    """Effort and speed of a joint's drive stay below a curve: (n,) speeds (rad/s or m/s), ascending from 0, and what it
    can give at each (N·m or N), never more than at the one before."""

    kind = "torque_speed"
    joint: str
    speeds: Array
    efforts: Array

    def used(self, speed: Array, effort: Array) -> Array:
        """(T,) by how much the points (|speed|, |effort|) would have to shrink towards the origin to lie on the curve:
        1 there, less below it. Beyond the greatest speed the curve falls to no effort at all."""
        unit = np.array([self.speeds[-1], self.efforts[0]])
        curve = np.column_stack([self.speeds, self.efforts]) / unit
        if curve[-1, 1] > 0.0:
            curve = np.vstack([curve, [1.0, 0.0]])
        points = np.abs(np.column_stack([speed, effort])) / unit
        # seen from the origin the curve turns from the axis of efforts to that of speeds
        angles = np.arctan2(curve[:, 0], curve[:, 1])
        edge = np.searchsorted(angles, np.arctan2(points[:, 0], points[:, 1]), side="left").clip(1, len(curve) - 1)
        start, along = curve[edge - 1], curve[edge] - curve[edge - 1]
        normal = np.column_stack([-along[:, 1], along[:, 0]])
        return np.asarray((normal * points).sum(axis=1) / (normal * start).sum(axis=1))


@dataclass(frozen=True, eq=False)
class Reaction(Kind):
    """A joint carries at most a force (N), at most a torque (N·m), in the simulation."""

    kind = "reaction"
    joint: str
    force: float | None = None
    torque: float | None = None


@dataclass(frozen=True, eq=False)
class Mass(Kind):
    """A part, a group or the whole (None) has a mass between bounds (kg)."""

    kind = "mass"
    of: str | None = None
    minimum: float | None = None
    maximum: float | None = None


@dataclass(frozen=True, eq=False)
class CentreOfMass(Kind):
    """A centre of mass is within `tolerance` (m) of a point (3,) m."""

    kind = "centre_of_mass"
    point: Array
    tolerance: float
    of: str | None = None


@dataclass(frozen=True, eq=False)
class Inertia(Kind):
    """A moment of inertia about a unit axis (3,), through a point (3,) m or the centre of mass, is between bounds
    (kg·m²)."""

    kind = "inertia"
    axis: Array
    of: str | None = None
    point: Array | None = None
    minimum: float | None = None
    maximum: float | None = None


@dataclass(frozen=True, eq=False)
class Balance(Kind):
    """An imbalance of at most `limit` (kg·m) about a joint's axis, or about an axis (3,) through a point (3,) m."""

    kind = "balance"
    of: str
    limit: float
    joint: str | None = None
    axis: Array | None = None
    point: Array | None = None


@dataclass(frozen=True, eq=False)
class Retained(Kind):
    """A part can leave in the listed directions (n, 3) only."""

    kind = "retained"
    part: str
    directions: Array = field(default_factory=lambda: np.zeros((0, 3)))


@dataclass(frozen=True, eq=False)
class Fit(Kind):
    """A clearance between two parts or groups, between bounds (m); negative is press."""

    kind = "fit"
    between: Sequence[str]
    minimum: float | None = None
    maximum: float | None = None
