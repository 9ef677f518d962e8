"""FCL: models of triangles, their poses, and distances between them, in metres."""

from __future__ import annotations

from functools import cache

import fcl
import numpy as np

from kinform.foundation.memory import give_back
from kinform.foundation.sorting import numbered
from kinform.model.arrays import Array, Ints

UNIT = 2.0**20
"""FCL's units in a metre. It reports 0 for the distance of triangles whose edges are shorter than about 2e-4 of its
unit: it gets micrometres, by a power of two, which rounds nothing."""


MANY_FACETS = 300_000
"""Facets from which on a model takes so much memory, a kilobyte each, that what is free is given back first."""

_DISTANCE = fcl.DistanceRequest()


def fcl_model(vertices: Array, faces: Ints) -> fcl.BVHModel:
    """FCL's model of triangles: vertices (V, 3) m and faces (F, 3). To be placed and measured by the two below."""
    if len(faces) > MANY_FACETS:
        give_back()
    model = fcl.BVHModel()
    model.beginModel(len(vertices), len(faces))
    model.addSubModel(np.ascontiguousarray(UNIT * vertices), np.ascontiguousarray(faces))
    model.endModel()
    return model


def fcl_pose(X: Array) -> fcl.Transform:
    """FCL's form of a pose (4, 4) of such a model."""
    return fcl.Transform(X[:3, :3], UNIT * X[:3, 3])


def fcl_distance(
    first: fcl.CollisionObject, second: fcl.CollisionObject, result: fcl.DistanceResult | None = None
) -> float:
    """m between two such models, 0 where they touch or cross."""
    distance = fcl.distance(first, second, _DISTANCE, fcl.DistanceResult() if result is None else result)
    return max(float(distance), 0.0) / UNIT


@cache
def point_model() -> fcl.BVHModel:
    """A triangle without size: FCL takes one that reaches through a facet for as far off as the facet's edges."""
    return fcl_model(np.zeros((3, 3)), np.array([[0, 1, 2]]))


def partial_model(vertices: Array, faces: Ints) -> fcl.BVHModel:
    """FCL's model of some facets, with the vertices that they use."""
    used, corners = numbered(faces.ravel(), len(vertices))
    return fcl_model(vertices.take(used, axis=0), corners.reshape(-1, 3))
