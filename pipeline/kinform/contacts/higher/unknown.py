"""Where two parts come as near each other as parts that touch do, and no contact that is known says how.

Contact is known by pairings of surfaces: an elliptical rim in a bore, a straight edge on a barrel, or two freeform
faces are none of them. The meshes still tell how near they come. What such a contact holds is not known, so its patch
is a point that leaves everything in doubt, and denies nothing.
"""

from __future__ import annotations

from dataclasses import replace

import fcl
import numpy as np

from kinform.contacts.constants import TOUCH
from kinform.contacts.higher.constants import ZONE
from kinform.contacts.higher.touch_patches import TouchSamples, touch_patch
from kinform.contacts.search.pair_view import PairView, PartView, boxes_of
from kinform.foundation.meshes.closest_facets import distances_from
from kinform.foundation.meshes.fcl_adapter import UNIT, partial_model
from kinform.foundation.meshes.near_facets import near_boxes
from kinform.foundation.rounding import SINGLE, TINY
from kinform.model.arrays import Array, Ints
from kinform.model.contacts import Patch


def unknown_touches(pair: PairView) -> list[Patch]:
    """The place where the parts, of which no contact is known, are nearest, in the frame of the pair: a patch where
    they touch there, within what their facets stand off their surfaces."""
    most = min(_touches_within(pair, pair.a.table.slack + pair.b.table.slack), pair.tolerance)
    near = [np.concatenate([np.zeros(0, np.int64), *side.facets]) for side in pair.near]
    if not len(near[0]) or not len(near[1]):
        return []
    keep = near_boxes(*boxes_of(pair.a, near[0]), *boxes_of(pair.b, near[1]), most)
    facets = near[0][keep[0]], near[1][keep[1]]
    if not len(facets[0]) or not len(facets[1]):
        return []
    gap, place = _nearest(pair, facets)
    if gap > most:
        return []
    sides = [_at(part, mine, place, gap) for part, mine in zip(pair.parts, facets, strict=True)]
    (i, out_of_a), (j, out_of_b) = sides
    chords = [float(part.table.chords[k]) for part, k in zip(pair.parts, (i, j), strict=True)]
    if gap > min(_touches_within(pair, sum(chords)), pair.tolerance):
        return []
    normal = out_of_a - out_of_b
    normal = normal / max(float(np.linalg.norm(normal)), TINY)
    touch = TouchSamples(
        points=place[None],
        normals=normal[None],
        gaps=np.array([gap]),
        area=(ZONE * pair.tolerance) ** 2,
        axis=None,
        radii=(0.0, 0.0),
        uncertainty=(np.pi / 2, pair.tolerance),
        chord=sum(chords),
    )
    return [replace(touch_patch(pair, (i, j), touch, 0.0), one_sided=True, unknown=True)]


def _touches_within(pair: PairView, chords: float) -> float:
    """m up to which surfaces may touch whose facets stand off them by `chords` together."""
    return TOUCH * pair.tolerance + chords


def _nearest(pair: PairView, facets: tuple[Ints, Ints]) -> tuple[float, Array]:
    """(m, (3,) m) distance of these facets of a from those of b, and the middle between them."""
    models = [
        fcl.CollisionObject(partial_model(part.vertices, part.faces[mine]))
        for part, mine in zip(pair.parts, facets, strict=True)
    ]
    result = fcl.DistanceResult()
    distance = fcl.distance(*models, fcl.DistanceRequest(enable_nearest_points=True), result)
    first, second = (np.asarray(point) / UNIT for point in result.nearest_points)
    return max(float(distance), 0.0) / UNIT, 0.5 * (first + second)


def _at(part: PartView, facets: Ints, place: Array, gap: float) -> tuple[int, Array]:
    """The surface of the first of the facets that are nearest to a place, and the mean of the normals of the surfaces
    that are as near there."""
    corners = part.vertices[part.faces[facets]]
    away = distances_from(place, corners)
    nearest = facets[away <= away.min() + SINGLE * (gap + float(np.ptp(corners, axis=(0, 1)).max()))]
    normals, labels = part.normals(nearest), part.surfaces.labels[nearest]
    mean = np.array([normals[labels == label].mean(axis=0) for label in np.unique(labels)]).mean(axis=0)
    return int(labels[0]), mean if np.linalg.norm(mean) > SINGLE else normals[0]
