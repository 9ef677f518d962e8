"""How far a motion certainly does not bring two parts together, by their distance as wholes: most pairs need no more.

Conservative advancement: at a distance d nothing happens until points have travelled d (Mirtich 1996). It goes on as
long as its steps are long; from there on the facets that count, and where they cross, have to be looked at. Far parts
are told apart by spheres about their facets, near ones by FCL, whose model of a mesh is made once, however many parts
and questions there are.
"""

from __future__ import annotations

from functools import cached_property

import fcl
import numpy as np

from kinform.collisions.constants import CERTAIN, SHORT_STEP, SPHERES_FAR, STEPS_MOST, STEPS_TRIED, WHOLES_TOUCH
from kinform.collisions.pair.course import Course
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.at_work import at_work_on
from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_pose
from kinform.model.arrays import Array


class Wholes:
    """Two parts with all their facets."""

    def __init__(self, shapes: Shapes, first: str, second: str):
        self._shapes, self._names = shapes, (first, second)
        self._to_first = np.linalg.inv(shapes.part(first).X_WP)
        self._X_WB = shapes.part(second).X_WP
        self._size = min(shapes.mesh(first).diagonal, shapes.mesh(second).diagonal)
        self._spheres = shapes.spheres(first), shapes.spheres(second)
        self._steps = 0

    @cached_property
    def _objects(self) -> tuple[fcl.CollisionObject, fcl.CollisionObject]:
        with at_work_on(*self._names):
            first, second = (fcl.CollisionObject(self._shapes.model(name)) for name in self._names)
        return first, second

    def distance(self, D: Array) -> float:
        """m: no facets are nearer at a displacement (4, 4) of the second body relative to the first."""
        X = self._to_first @ D @ self._X_WB
        (near, r), (far, s) = self._spheres
        moved = far @ X[:3, :3].T + X[:3, 3]
        square = (near**2).sum(axis=1)[:, None] + (moved**2).sum(axis=1) - 2.0 * near @ moved.T
        bound = float((np.sqrt(np.maximum(square, 0.0)) - r[:, None] - s).min())
        if bound > SPHERES_FAR * self._size:
            return CERTAIN * bound
        self._objects[1].setTransform(fcl_pose(X))
        with at_work_on(*self._names):
            return CERTAIN * fcl_distance(*self._objects)

    def touch(self, D: Array) -> bool:
        """Whether they touch, or nearly."""
        return self.distance(D) <= WHOLES_TOUCH * SHORT_STEP * self._size

    def step(self, course: Course, s: float, end: float) -> tuple[float, bool]:
        """A parameter after s up to which they are certainly apart, and whether that was too short a step to go on
        so."""
        self._steps += 1
        free = self.distance(course.displacement(s))
        following = course.when(course.travel(s) + max(free, 0.0), s, end)
        return following, following < end and (free < SHORT_STEP * self._size or self._steps > STEPS_MOST)

    def clear_until(self, course: Course, start: float, end: float) -> float:
        """The parameter up to which they are certainly apart: `start` where they touch, `end` where they stay so; less
        where so many steps as are taken would not reach the end."""
        s, short = self.step(course, start, end)
        while s < end and not short:
            if self._steps >= STEPS_TRIED and (s - start) * STEPS_MOST < (end - start) * self._steps:
                break
            s, short = self.step(course, s, end)
        return s
