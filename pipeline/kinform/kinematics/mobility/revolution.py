"""Bodies that look the same however they are turned about an axis: bare solids of revolution, balls, fasteners.

Their surfaces say so: all of them are coaxial, centred on the axis, or flat across it. A lug, a keyway, a cross hole or
a crank pin is not. Besides, a fastener has the six flats of a hexagon, and a thread; a screw that only its name tells
has a drive of any shape. Regular rings of more flats are coarse cylinders.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from kinform.foundation.algebra.vectors import cross, dot, lengths, norm, perpendicular, sine
from kinform.foundation.meshes.mesh_index import MeshIndex
from kinform.foundation.meshes.surface_table import CONE, CYLINDER, PLANE, SPHERE, TORUS, SurfaceTable
from kinform.frozen import dataclass
from kinform.kinematics.partition.standard_names import kind_by_name
from kinform.kinematics.partition.standard_parts import HOLDERS
from kinform.mechanism.constants import SIGMAS
from kinform.model.arrays import Array, Flags, Ints
from kinform.model.assembly import Part
from kinform.model.surfaces import KINDS, MeshSurfaces

TILT = 1e-3
"""Sine up to which a surface goes round the axis of another, beside what their fits leave open. A milliradian, a third
of the default alignment tolerance. Chosen, not measured."""
OFF = 2e-3
"""Distance from the axis up to which a surface goes round it, as a share of the greatest radius, beside what the fits
leave open: a bearing's eccentricity is less, an eccentric's throw more. Chosen, not measured."""
VAGUE = 0.01
"""rad: standard uncertainty of an axis from which on it says nothing, as of a few facets of a chamfer. Where vertices
scatter by 3e-4 of random parts, planes and cones of such pieces have 0.02 and more, real flats up to 0.005."""
UNKNOWN = 0.02
"""Share of the area that facets of no known surface, and of surfaces with a vague axis, may have that face round the
axis. Where vertices scatter by 3e-4 of its radius, 1.6 % of a ball is left in such pieces."""
FACING = 0.25
"""Sine from which on a facet faces round the axis: sides of a lug have 1, the middles of the halves of a square's sides
0.3, those of strips of a circle of 12 have 0.09."""
LOBES = 6
"""Up to so many lobes round the axis are looked for in facets of no known surface, one being that they are off it."""
LOBED = 0.01
"""Mean of the sine to which facets face round the axis as lobes do, up to which they have none: half the throw of an
eccentric by its radius. Noise has no lobes. Chosen, not measured."""
REGULAR = 0.02
"""Relative difference of the distances, and rad of the angles, by which the flats of a regular ring may differ. Chosen,
not measured."""
HEXAGON = 6
"""Flats of the drive of a fastener."""
DRIVE = 0.1
"""Share of its area that the drive of a screw has at most which its name tells: slots, crosses, hexalobes, the ears of
a circlip. Chosen, not measured."""
COARSE = 7
"""Flats from which on a regular ring is a cylinder with a coarse tessellation, as it is for contact: nobody can tell
it from a prism."""


ROUND = np.array([CYLINDER, CONE, TORUS, KINDS.index("revolution")])
"""Kinds of surfaces that any turn about their axis maps onto themselves."""
FREEFORM, HELICOID = KINDS.index("freeform"), KINDS.index("helicoid")


@dataclass(frozen=True, eq=False)
class Revolution:
    """The turns that leave the shape of a body as it is."""

    axis: Array | None
    """(3,) unit; None: every axis through the point, as of a ball."""
    point: Array
    """(3,) m, on the axis."""
    tilt: float
    """Sine by which the axis may be off."""
    off: float
    """m by which the point may be off the axis."""

    def is_about(self, axis: Array, point: Array, tilt: float, off: float) -> bool:
        """Whether the turns about a line, which may be off by a sine `tilt` and `off` (m), are among these."""
        if self.axis is not None and sine(self.axis, axis) > self.tilt + tilt:
            return False
        return norm(cross(self.point - point, axis)) <= self.off + off


@dataclass(frozen=True, eq=False)
class _Surfaces:
    """Columns over the surfaces of a body, in the world's frame (m, rad)."""

    kinds: Ints
    """(s,) index into KINDS."""
    axes: Array
    """(s, 3)."""
    middles: Array
    """(s, 3): of the extent along the axis; the point of what has none."""
    radii: Array
    areas: Array
    axis_uncertainty: Array
    point_uncertainty: Array

    def where(self, flags: Flags) -> _Surfaces:
        """Some of them."""
        return _Surfaces(*(column[flags] for column in self._columns))

    @property
    def _columns(self) -> tuple[Any, ...]:
        return (
            self.kinds, self.axes, self.middles, self.radii, self.areas, self.axis_uncertainty, self.point_uncertainty,
        )  # fmt: skip

    @staticmethod
    def of(part: Part, found: MeshSurfaces) -> _Surfaces:
        """Those of a part, without the drive of a screw that its name tells."""
        table = SurfaceTable.of(found, np.zeros(len(found.surfaces)))
        R, middle = part.X_WP[:3, :3], table.extents.mean(axis=1)
        along = np.isin(table.kinds, ROUND)[:, None] * middle[:, None] * table.axes
        every = _Surfaces(
            kinds=table.kinds,
            axes=table.axes @ R.T,
            middles=(table.points + along) @ R.T + part.X_WP[:3, 3],
            radii=table.radii + table.minor_radii,
            areas=table.areas,
            axis_uncertainty=table.axis_uncertainty,
            point_uncertainty=table.point_uncertainty,
        )
        named = kind_by_name(part.name)
        return _without_drive(every) if named is not None and named[0] in HOLDERS else every

    @staticmethod
    def together(members: Sequence[_Surfaces]) -> _Surfaces:
        """Those of several parts."""
        return _Surfaces(*(np.concatenate(columns) for columns in zip(*(m._columns for m in members), strict=True)))


def revolution_of(parts: Sequence[Part], surfaces: Mapping[str, MeshSurfaces]) -> Revolution | None:
    """The turns that leave the shape of these parts together as it is, in the world's frame; None where there are none,
    or a part has no mesh. `surfaces` by the digest of their mesh."""
    meshed = [(part, part.mesh.digest) for part in parts if part.mesh is not None]
    known = [(part, surfaces[digest]) for part, digest in meshed if digest in surfaces]
    if not known or len(known) < len(parts):
        return None
    members = [_Surfaces.of(part, found) for part, found in known]
    loose = np.concatenate([_corners(part, found) for part, found in known])
    every = _Surfaces.together(members)
    area = float(every.areas.sum())
    every = every.where(~_unknown(every.kinds, every.axis_uncertainty))
    found = _main(every)
    if found is None and np.count_nonzero(every.kinds == PLANE) > COARSE:
        found = _coarse(known)
    return found if found is not None and _goes_round(every, found) and _face_out(loose, found, area) else None


def _unknown(kinds: Ints, axis_uncertainty: Array) -> Flags:
    """(s,) which surfaces say nothing of their own."""
    return np.asarray((kinds == FREEFORM) | ((kinds != SPHERE) & (axis_uncertainty > VAGUE)))


def _corners(part: Part, found: MeshSurfaces) -> Array:
    """(n, 3, 3) m: corners of the facets of surfaces that say nothing, in the world's frame."""
    assert part.mesh is not None
    kinds = np.array([KINDS.index(surface.kind) for surface in found.surfaces])
    loose = _unknown(kinds, np.array([surface.axis_uncertainty for surface in found.surfaces]))
    facets = [found.surfaces[k].faces for k in np.flatnonzero(loose)]
    corners = part.mesh.vertices[part.mesh.faces[np.concatenate(facets)]] if facets else np.zeros((0, 3, 3))
    return np.asarray(corners @ part.X_WP[:3, :3].T + part.X_WP[:3, 3])


def _face_out(corners: Array, about: Revolution, area: float) -> bool:
    """Whether facets of no known surface (n, 3, 3) lie as those of a surface of revolution do, but for a small share of
    the `area` (m²) of the body: they face outwards, inwards or along the axis, and those that scatter do so at random.
    Beside a ball only such a share is let be."""
    spans = 0.5 * cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = lengths(spans)
    if about.axis is None or not len(corners):
        return float(areas.sum()) <= UNKNOWN * area
    u, v = perpendicular(about.axis)
    arms = corners.mean(axis=1) - about.point
    azimuth = np.arctan2(arms @ v, arms @ u)
    round_ = -np.sin(azimuth) * (spans @ u) + np.cos(azimuth) * (spans @ v)
    if float(areas[np.abs(round_) > FACING * areas].sum()) > UNKNOWN * area:
        return False
    waves = np.exp(1j * np.outer(np.arange(1, LOBES + 1), azimuth)) @ round_
    return float(np.abs(waves).max()) <= max(LOBED * float(areas.sum()), 0.5 * UNKNOWN * area)


def _main(every: _Surfaces) -> Revolution | None:
    """The axis of the round surface that is known best; else that of spheres, with each other or with a plane."""
    round_ = np.flatnonzero(np.isin(every.kinds, ROUND))
    reach = float(every.radii.max(initial=0.0))
    if len(round_):
        best = round_[np.argmin(every.axis_uncertainty[round_])]
        tilt, off = every.axis_uncertainty[best], every.point_uncertainty[best]
        return Revolution(every.axes[best], every.middles[best], TILT + SIGMAS * tilt, OFF * reach + SIGMAS * off)
    spheres = np.flatnonzero(every.kinds == SPHERE)
    if not len(spheres):
        return None
    first = spheres[np.argmax(every.areas[spheres])]
    centre, off = every.middles[first], OFF * reach + SIGMAS * float(every.point_uncertainty[spheres].max())
    far = spheres[np.argmax(lengths(every.middles[spheres] - centre))]
    apart = norm(every.middles[far] - centre)
    if apart > 2.0 * off:
        return Revolution((every.middles[far] - centre) / apart, centre, TILT + off / apart, off)
    planes = np.flatnonzero(every.kinds == PLANE)
    if not len(planes):
        return Revolution(None, centre, 0.0, off)
    flat = planes[np.argmax(every.areas[planes])]
    return Revolution(every.axes[flat], centre, TILT + SIGMAS * float(every.axis_uncertainty[flat]), off)


def _coarse(known: Sequence[tuple[Part, MeshSurfaces]]) -> Revolution | None:
    """The axis of the longest ring of flats that is a coarse cylinder."""
    rings = [
        (ring, part)
        for part, found in known
        if part.mesh is not None
        for ring in MeshIndex(part.mesh).rings(found)
        if ring.sides >= COARSE
    ]
    if not rings:
        return None
    ring, part = max(rings, key=lambda pair: pair[0].extent[1] - pair[0].extent[0])
    R, p = part.X_WP[:3, :3], part.X_WP[:3, 3]
    tilt, off = TILT + SIGMAS * ring.turn, OFF * ring.corner + SIGMAS * ring.shift
    return Revolution(R @ ring.axis, R @ ring.point + p, tilt, off)


def _without_drive(every: _Surfaces) -> _Surfaces:
    """The surfaces of a screw that are round about its axis, where they and its thread are nearly all."""
    about = _main(every)
    if about is None or about.axis is None:
        return every
    turned = _turned(every, about.axis, about)
    if float(every.areas[~turned].sum()) > DRIVE * float(every.areas.sum()):
        return every
    return every.where(turned & (every.kinds != HELICOID))


def _goes_round(every: _Surfaces, about: Revolution) -> bool:
    """Whether all surfaces turn onto themselves."""
    if about.axis is None:
        return bool((every.kinds == SPHERE).all() and (lengths(every.middles - about.point) <= 2.0 * about.off).all())
    tilt, thread = about.tilt + SIGMAS * every.axis_uncertainty, every.kinds == HELICOID
    beside = (every.kinds == PLANE) & (np.abs(every.axes @ about.axis) <= tilt)
    if not (_turned(every, about.axis, about) | beside).all():
        return False
    sides = _sides(every.where(beside), about.axis, about.point)
    return sides is not None and (HEXAGON in sides or not thread.any())


def _turned(every: _Surfaces, axis: Array, about: Revolution) -> Flags:
    """(s,) which surfaces are coaxial, threads among them, centred on the axis, or flat across it."""
    across = lengths(cross(every.axes, axis)) <= about.tilt + SIGMAS * every.axis_uncertainty
    arms = every.middles - about.point
    # an axis that is a little off is so the more the farther away
    off = about.off + SIGMAS * every.point_uncertainty + about.tilt * np.abs(arms @ axis)
    centred = lengths(cross(arms, axis)) <= off
    coaxial = (np.isin(every.kinds, ROUND) | (every.kinds == HELICOID)) & across & centred
    return np.asarray(coaxial | ((every.kinds == PLANE) & across) | ((every.kinds == SPHERE) & centred))


def _sides(flats: _Surfaces, axis: Array, point: Array) -> set[int] | None:
    """Numbers of flats of the regular rings that flats along an axis make; None where some are in no such ring of a
    hexagon or of more."""
    u, v = perpendicular(axis)
    reach = dot(flats.middles - point, flats.axes)
    azimuth = np.arctan2(flats.axes @ v, flats.axes @ u)
    left, out = np.argsort(-np.abs(reach), kind="stable"), set()
    while len(left):
        ring = np.abs(reach[left] - reach[left[0]]) <= REGULAR * abs(float(reach[left[0]]))
        turns = np.sort(azimuth[left[ring]])
        gaps = np.diff(np.append(turns, turns[0] + math.tau))
        # one flat in several pieces
        gaps = gaps[gaps > REGULAR]
        if len(gaps) < HEXAGON or float(np.ptp(gaps)) > REGULAR:
            return None
        out.add(len(gaps))
        left = left[~ring]
    return out
