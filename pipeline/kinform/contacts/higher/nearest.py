"""Circles, and where on them they come nearest to a surface: rims, and the middles of the tubes of rings."""

from __future__ import annotations

import math

import numpy as np

from kinform.contacts.higher.beside import Beside, beside
from kinform.contacts.search.pair_view import NearSurfaces
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Flags
from kinform.model.surfaces import SurfaceKind


@dataclass(frozen=True, eq=False)
class Circle:
    """A circle in the frame of the pair (m)."""

    axis: Array
    centre: Array
    radius: float
    basis: Array
    """(2, 3) directions from which angles are measured, and to which they run."""

    def outward(self, angles: Array) -> Array:
        """(n, 3) unit, away from the axis."""
        return np.stack([np.cos(angles), np.sin(angles)], axis=1) @ self.basis

    def forward(self, angles: Array) -> Array:
        """(n, 3) unit, along the circle."""
        return np.stack([-np.sin(angles), np.cos(angles)], axis=1) @ self.basis

    def points(self, angles: Array) -> Array:
        """(n, 3) on the circle."""
        return np.asarray(self.centre + self.radius * self.outward(angles))


@dataclass(frozen=True, eq=False)
class Dips:
    """Arcs (n,) of a circle, from `low` to `high` (rad), on which it comes nearest to a surface, and how fast the
    distance changes at both ends (m/rad): not upwards at first, and then upwards."""

    low: Array
    high: Array
    down: Array
    up: Array

    def where(self, rows: Flags) -> Dips:
        """Some of them."""
        return Dips(self.low[rows], self.high[rows], self.down[rows], self.up[rows])


def dips_of(circle: Circle, angles: Array, there: Beside, least: float, most: float) -> Dips:
    """Those in which the distance may be from `least` to `most` (m), by what the surface is at equal `angles` (m,)."""
    speed = circle.radius * (there.normals * circle.forward(angles)).sum(axis=1)
    ahead = np.roll(speed, -1)
    step = 2.0 * math.pi / len(angles)
    # between two places it is not below the tangents, but for its bends
    lower = np.minimum(there.gaps, np.roll(there.gaps, -1))
    lowest = lower - step * np.maximum(-speed, ahead) - circle.radius * step**2
    at = np.flatnonzero((speed <= 0.0) & (ahead > 0.0) & (lowest <= most) & (lower >= least))
    return Dips(angles[at], angles[at] + step, speed[at], ahead[at])


def nearest(circle: Circle, near: NearSurfaces, row: int, dips: Dips) -> Array:
    """(n,) angles at which the circle is nearest to the surface at position `row`."""
    low, high, down, up = dips.low, dips.high, dips.down, dips.up
    middle = low
    # after twenty steps the angle is exact
    for _ in range(20 if len(low) else 0):
        middle = (low * up - high * down) / (up - down)
        normals = beside(near, row, circle.points(middle)).normals
        rate = circle.radius * (normals * circle.forward(middle)).sum(axis=1)
        rising = rate > 0.0
        # Illinois: the end that stays counts half, so that both come nearer
        low, high = np.where(rising, low, middle), np.where(rising, middle, high)
        down, up = np.where(rising, 0.5 * down, rate), np.where(rising, rate, 0.5 * up)
    return middle


def evened(circle: Circle, angles: Array, normals: Array, kind: SurfaceKind) -> Array:
    """(n, 3) normals all round a circle, alike about its axis: a surface that is not quite about the same axis turns
    with it as much as one that is. Those of a sphere pass its middle as they are."""
    if kind == "sphere":
        return normals
    outward = circle.outward(angles)
    across, along = float((normals * outward).sum(axis=1).mean()), float((normals @ circle.axis).mean())
    size = math.hypot(across, along)
    return np.asarray((across * outward + along * circle.axis) / size)
