"""Regions to be covered, as places or directions spread over them, with the size of the gaps between."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field

import numpy as np

from kinform.foundation.algebra.vectors import perpendicular
from kinform.frozen import dataclass
from kinform.model.arrays import Array

INSIDE = 240
"""Directions inside of a cone: of one with a half angle of 40° none is farther than 4.5° from one of them. Chosen, with
`ALONG`, so that a region has 300 targets or so: each is approached, and the report says how large holes can be."""
RIM = 48
"""Directions on its rim, 7.5° of the turn apart."""
ALONG = 7
"""Places along each edge of a box: 343 in all."""


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


@dataclass(frozen=True, eq=False)
class Targets:
    """`values` (k, 3): places (m, world) or unit directions. `gap`: every place or direction of the region is
    within so much (m or rad) of one of them; 0 where they are the region."""

    values: Array
    directions: bool
    gap: float


def targets_of(region: Region, *, direction: bool) -> Targets | str:
    """The targets of a region for a point, or for a direction; a sentence where the region has none such."""
    if isinstance(region, Cone):
        return _cone(region) if direction else "a cone is a region of directions: state a direction, not a point"
    if isinstance(region, Box):
        return "a box is a region of places: state a point, not a direction" if direction else _box(region)
    values = region.directions if direction else region.points
    if not len(values):
        return f"the poses list no {'directions' if direction else 'points'}"
    return Targets(values, direction, 0.0)


def _cone(region: Cone) -> Targets:
    """A spiral of equal areas over the cap, and its rim."""
    axis, half = region.axis, region.half_angle
    u, v = perpendicular(axis)
    k = np.arange(INSIDE) + 0.5
    height = 1.0 - (1.0 - math.cos(half)) * k / INSIDE
    turn = k * math.pi * (3.0 - math.sqrt(5.0))
    around = np.concatenate([turn, np.arange(RIM) * 2.0 * math.pi / RIM])
    polar = np.concatenate([np.arccos(np.clip(height, -1.0, 1.0)), np.full(RIM, half)])
    side = np.sin(polar)[:, None]
    values = np.cos(polar)[:, None] * axis + side * (np.cos(around)[:, None] * u + np.sin(around)[:, None] * v)
    # the spiral leaves no gap wider than this many spacings; the rim half of its own
    spacing = math.sqrt(2.0 * math.pi * (1.0 - math.cos(half)) / INSIDE)
    return Targets(values, True, max(spacing, math.pi * math.sin(half) / RIM))


def _box(region: Box) -> Targets:
    """A grid with the corners."""
    X = region.X_WF
    low, high = np.minimum(region.lower, region.upper), np.maximum(region.lower, region.upper)
    axes = [np.linspace(a, b, ALONG) if b > a else np.array([a]) for a, b in zip(low, high, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    half = 0.5 * np.array([(b - a) / (ALONG - 1) for a, b in zip(low, high, strict=True)])
    # lower and upper are in metres; only the pose is left to apply
    return Targets(grid @ X[:3, :3].T + X[:3, 3], False, float(np.linalg.norm(half)))
