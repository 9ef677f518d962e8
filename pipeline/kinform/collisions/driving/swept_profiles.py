"""Which facets a turn or slide can bring together: those that sweep over the same profile.

A facet that turns about an axis keeps its distances from the axis and its heights along it, one that slides keeps its
shadow: facets whose boxes in these coordinates are apart never meet, over the whole motion.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from kinform.collisions.constants import LEVEL
from kinform.foundation.algebra.vectors import cross, perpendicular
from kinform.foundation.meshes.boxes import facet_boxes
from kinform.foundation.meshes.proximity import near_boxes
from kinform.model.arrays import Array, Ints


class Profile:
    """What vertices (n, 3) and facets (m, 3) of a part, in the world, keep along a unit twist (6,) (ω; v at the
    origin)."""

    def __init__(self, vertices: Array, faces: Ints, twist: Array):
        self._faces = faces
        self._turning = bool(twist[:3] @ twist[:3] > 0.25)
        axis = twist[:3] if self._turning else twist[3:]
        across = np.stack(perpendicular(axis), axis=1)
        self.frame = np.eye(4)
        """(4, 4) displacement of the world to where the axis is z."""
        self.frame[:3, :3] = np.column_stack([across, axis]).T
        if self._turning:
            self.frame[:3, 3] = -self.frame[:3, :3] @ cross(axis, twist[3:])
        away = vertices - cross(axis, twist[3:]) if self._turning else vertices
        self._flat = away @ across
        self._radius = np.linalg.norm(self._flat, axis=1)
        self._heights = away @ axis
        self.largest: float = float(self._radius.max(initial=0.0))
        """m: greatest distance from the axis of a turn."""
        rounding = LEVEL * max(self.largest, float(np.linalg.norm(twist[3:])))
        self._level = self._turning and abs(float(twist[:3] @ twist[3:])) < rounding

    @cached_property
    def sphere(self) -> Array:
        """(4,) a sphere about it: where its middle is, across the axis and along it, and its radius (m)."""
        low, high = self._flat.min(axis=0), self._flat.max(axis=0)
        bottom, top = self.span
        middle = 0.5 * (low + high), 0.5 * (bottom + top)
        away = ((self._flat - middle[0]) ** 2).sum(axis=1) + (self._heights - middle[1]) ** 2
        return np.array([*middle[0], middle[1], (1.0 + LEVEL) * math.sqrt(float(away.max()))])

    @property
    def span(self) -> tuple[float, float]:
        """Lowest and highest place (m) along the axis."""
        return float(self._heights.min()), float(self._heights.max())

    @property
    def bounds(self) -> tuple[Array, Array]:
        """(3,) box of all `boxes`; some larger."""
        low, high = np.zeros(3), np.zeros(3)
        if not self._turning:
            low[:2], high[:2] = self._flat.min(axis=0), self._flat.max(axis=0)
        else:
            high[0] = self.largest
        if self._level:
            low[1], high[1] = self.span
        return low, high

    def boxes(self, facets: Ints) -> tuple[Array, Array]:
        """Boxes (n, 3) of what facets keep: radius and height of a turn, radius of a screw, shadow of a slide."""
        corners = self._faces[facets]
        low, high = np.zeros((len(facets), 3)), np.zeros((len(facets), 3))
        if not self._turning:
            for k in range(2):
                low[:, k], high[:, k] = facet_boxes(self._flat[:, k], corners)
            return low, high
        high[:, 0] = facet_boxes(self._radius, corners)[1]
        low[:, 0] = nearest(self._flat[corners])
        if self._level:
            low[:, 1], high[:, 1] = facet_boxes(self._heights, corners)
        return low, high

    @property
    def turns(self) -> bool | None:
        """Whether it is a turn or a slide; None: a screw, of which heights are not kept."""
        return self._turning if self._level or not self._turning else None

    def corners(self, facets: Ints) -> Array:
        """(n, 3, 3) m of facets' corners: across the axis and along it."""
        return np.concatenate([self._flat, self._heights[:, None]], axis=1)[self._faces[facets]]

    def radius(self, facets: Ints) -> float:
        """m: greatest distance of some facets from the axis of a turn."""
        return float(self._radius[self._faces[facets]].max(initial=0.0))


def meeting(
    first: Profile, second: Profile, facets_first: Ints, facets_second: Ints, margin: float
) -> tuple[Ints, Ints]:
    """Which of the facets `own` of one part and `other` of another can meet when the second moves along the twist."""
    boxes = [first.boxes(facets_first), second.boxes(facets_second)]
    facets = [facets_first, facets_second]
    for k in (0, 1, 0):
        # near_boxes asks about all that it is given
        low, high = boxes[1 - k]
        if not len(low):
            return facets_first[:0], facets_second[:0]
        near = (boxes[k][0] <= high.max(axis=0) + margin) & (boxes[k][1] >= low.min(axis=0) - margin)
        kept = near.all(axis=1)
        boxes[k], facets[k] = (boxes[k][0][kept], boxes[k][1][kept]), facets[k][kept]
    near = near_boxes(*boxes[0], *boxes[1], margin)
    return facets[0][near[0]], facets[1][near[1]]


def nearest(flat: Array) -> Array:
    """(n,) distance of flat triangles (n, 3, 2) from the origin; 0 where it is inside."""
    x, y = flat[..., 0], flat[..., 1]
    u, v = np.roll(x, -1, axis=1) - x, np.roll(y, -1, axis=1) - y
    share = np.clip(-(u * x + v * y) / np.maximum(u * u + v * v, 1e-300), 0.0, 1.0)
    away = np.sqrt(((x + share * u) ** 2 + (y + share * v) ** 2).min(axis=1))
    turn = x * v - y * u
    inside = (turn > 0.0).all(axis=1) | (turn < 0.0).all(axis=1)
    return np.where(inside, 0.0, away)
