"""How far a motion certainly does not bring two parts together, by their distance as wholes: most pairs need no more.

Conservative advancement: at a distance d nothing happens until points have travelled d (Mirtich 1996). It goes on as
long as its steps are long; from there on the facets that count, and where they cross, have to be looked at. FCL's model
of a mesh is made once, however many parts and questions there are.
"""

from __future__ import annotations

import fcl
import numpy as np
from numpy.typing import NDArray

from kinform.collisions.course import Course
from kinform.collisions.pairs import Shapes

__all__ = ["clear_until"]

Array = NDArray[np.float64]

SHORT = 0.01
"""Steps below this share of the smaller part's size are short."""
MOST = 60
"""Steps."""
CERTAIN = 1.0 - 1e-6
"""Share of a distance of FCL that is trusted."""


def clear_until(shapes: Shapes, first: str, second: str, course: Course, start: float, end: float) -> float:
    """The parameter up to which the two parts are certainly apart: `start` where they touch, `end` where they stay so."""
    objects = tuple(fcl.CollisionObject(shapes.model(name)) for name in (first, second))
    X_WA, X_WB = (shapes.part(name).X_WP for name in (first, second))
    short = SHORT * min(shapes.mesh(name).diagonal for name in (first, second))
    to_first = np.linalg.inv(X_WA)
    s = start
    for _ in range(MOST):
        X = to_first @ course.displacement(s) @ X_WB
        objects[1].setTransform(fcl.Transform(X[:3, :3], X[:3, 3]))
        free = CERTAIN * fcl.distance(*objects, fcl.DistanceRequest(), fcl.DistanceResult())
        if free <= 1e-6 * short:
            return s
        following = course.when(course.travel(s) + free, s, end)
        if following >= end:
            return end
        s = following
        if free < short:
            return s
    return s
