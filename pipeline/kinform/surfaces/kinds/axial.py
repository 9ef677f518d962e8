"""Points in the cylindrical coordinates of many axes at once.

An axis is a row of `Params`: direction in columns 0 to 2, a point of it in columns 3 to 5.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot
from kinform.foundation.rounding import TINY
from kinform.model.arrays import Array
from kinform.surfaces.groups import repeated
from kinform.surfaces.kinds.batch import Batch, Params

OF_AXIS = 6
"""The first so many columns of `Params` are those of the axis."""


def frames(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors across each axis (N, 3), without branches (Duff and others, Building an orthonormal basis,
    revisited, 2017)."""
    ax, ay, az = axis[:, 0], axis[:, 1], axis[:, 2]
    sign = np.where(az < 0, -1.0, 1.0)
    a = -1.0 / (sign + az)
    b = ax * ay * a
    x, y = np.empty((2, 3, len(axis)))
    x, y = x.T, y.T
    x[:, 0], x[:, 1], x[:, 2] = 1.0 + sign * ax * ax * a, sign * b, -sign * ax
    y[:, 0], y[:, 1], y[:, 2] = b, sign + ay * ay * a, -ay
    return x, y


class Cylindrical(NamedTuple):
    """N points as their axes see them."""

    t: Array
    """(N,) along the axis."""
    rho: Array
    """(N,) across it."""
    radial: Array
    """(N, 3) unit direction away from it."""


def cylindrical(params: Params, points: Array) -> Cylindrical:
    """The coordinates of each point (N, 3) about its axis (N, 6 or more).

    Rows of three are columns here: the hottest lines of the package, and broadcasting over rows costs twice that. Of
    few points, steps of numpy cost more than numbers do, so there are as few as can be.
    """
    columns = params.T
    axis = columns[:3]
    away, each = np.empty((2, *columns[:3].shape))
    np.subtract(points.T, columns[3:6], out=away)
    np.multiply(away, axis, out=each)
    t = each[0] + each[1]
    t += each[2]
    np.multiply(axis, t, out=each)
    away -= each
    np.multiply(away, away, out=each)
    rho = each[0] + each[1]
    rho += each[2]
    np.sqrt(rho, out=rho)
    away *= 1.0 / np.maximum(rho, TINY)
    return Cylindrical(t, rho, away.T)


def azimuths(params: Params, radial: Array) -> Array:
    """(N,) angle of each radial direction about its axis, from the first direction of `frames`."""
    x, y = frames(params[:, :3])
    return np.asarray(np.arctan2(dot(radial, y), dot(radial, x)))


def angular_widths(batch: Batch, params: Params) -> Array:
    """(pairs,) angle about the axis that each polygon subtends."""
    owner, _ = batch.corners
    group, (_, rho, radial) = batch.seen(params, cylindrical, OF_AXIS)
    count = len(batch.polygon)
    middle, radial = radial[:count], radial[count:]
    many = batch.many
    cos = dot(radial, repeated(middle, many))
    sin = dot(radial, repeated(cross(repeated(params[:, :3], batch.size), middle), many))
    # a corner this close to the axis has no azimuth
    least = (1e-3 * np.abs(params[:, 6])).take(group[count:])
    angle = np.where(rho[count:] > least, np.arctan2(sin, cos), 0.0)
    high, low = np.zeros(len(batch.polygon)), np.zeros(len(batch.polygon))
    np.maximum.at(high, owner, angle)
    np.minimum.at(low, owner, angle)
    return high - low
