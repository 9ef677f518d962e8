"""Axes and centres met one after the other, asked at once which of them another may be on."""

from __future__ import annotations

import numpy as np

from kinform.foundation.algebra.vectors import dot
from kinform.foundation.rounding import SOLVED
from kinform.kinematics.partition.constants import SAME_AXIS
from kinform.model.arrays import Array, Ints


class KnownAxes:
    """Axes, each through a point, and centres, which have none."""

    def __init__(self, most: int):
        """Room for so many."""
        self._count, self._points, self._axes = 0, np.empty((most, 3)), np.zeros((most, 3))

    def add(self, point: Array, axis: Array | None) -> None:
        """One more: a point (3,) m, and a unit axis (3,)."""
        self._points[self._count] = point
        if axis is not None:
            self._axes[self._count] = axis
        self._count += 1

    def near(self, point: Array, axis: Array | None, off: float) -> list[int]:
        """Places, ascending, of all that this may be on, and few others: lines that are parallel within `SAME_AXIS`
        and pass the point at no more than `off` (m), or centres no further than this from it."""
        axes, apart = self._axes[: self._count], point - self._points[: self._count]
        beside = apart - dot(apart, axes)[:, None] * axes
        limit = off + SOLVED * (off + np.sqrt(dot(apart, apart)))
        near: Ints = (dot(beside, beside) <= limit * limit).nonzero()[0]
        axes = axes.take(near, axis=0)
        parallel = ~axes.any(axis=1) if axis is None else np.abs(axes @ axis) >= np.cos(SAME_AXIS) - SOLVED
        return [int(k) for k in near[parallel]]
