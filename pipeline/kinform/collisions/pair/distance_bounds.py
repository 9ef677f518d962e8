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

from kinform.collisions.constants import (
    CERTAIN,
    FEW_FACETS,
    SHORT_STEP,
    SPHERES_FAR,
    STEPS_MOST,
    STEPS_TRIED,
    WHOLES_TOUCH,
)
from kinform.collisions.pair.course import Course
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.at_work import at_work_on
from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_pose
from kinform.model.arrays import Array, Ints

AT_REST = np.eye(4)
_ANY = fcl.CollisionRequest(num_max_contacts=1, enable_contact=False)


class Wholes:
    """Two parts with all their facets."""

    def __init__(self, shapes: Shapes, first: str, second: str):
        self._shapes, self._names = shapes, (first, second)
        self._facets: tuple[Ints | None, Ints | None] = None, None
        self._to_first = np.linalg.inv(shapes.part(first).X_WP)
        self._X_WB = shapes.part(second).X_WP
        self._size = min(shapes.mesh(first).diagonal, shapes.mesh(second).diagonal)
        self._spheres = shapes.spheres(first), shapes.spheres(second)
        self._steps = 0

    @property
    def tried(self) -> bool:
        """Whether so many steps were taken that it is worth to leave out facets that never meet."""
        return self._steps == STEPS_TRIED

    def few(self, facets: tuple[Ints, Ints]) -> None:
        """Go on with some facets of both, the only ones that can meet, where these are few."""
        first, second = (
            some if len(some) < FEW_FACETS * len(self._shapes.mesh(name).faces) else None
            for name, some in zip(self._names, facets, strict=True)
        )
        self._facets = first, second
        self.__dict__.pop("_objects", None)

    @cached_property
    def _objects(self) -> tuple[fcl.CollisionObject, fcl.CollisionObject]:
        with at_work_on(*self._names):
            first, second = (
                fcl.CollisionObject(self._shapes.model(name, facets))
                for name, facets in zip(self._names, self._facets, strict=True)
            )
        return first, second

    def distance(self, D: Array) -> float:
        """m: no facets are nearer at a displacement (4, 4) of the second body relative to the first."""
        if not np.array_equal(D, AT_REST):
            return self._distance(D)
        # every joint is driven from there
        known, pair = self._shapes.at_rest, frozenset(self._names)
        if pair not in known:
            known[pair] = self._distance(D, touching=True)
        return known[pair]

    def _distance(self, D: Array, *, touching: bool = False) -> float:
        """`touching`: whether they are likely to touch, which is told sooner than how near they are."""
        X = self._to_first @ D @ self._X_WB
        (near, r), (far, s) = self._spheres
        moved = far @ X[:3, :3].T + X[:3, 3]
        square = (near**2).sum(axis=1)[:, None] + (moved**2).sum(axis=1) - 2.0 * near @ moved.T
        bound = float((np.sqrt(np.maximum(square, 0.0)) - r[:, None] - s).min())
        if bound > SPHERES_FAR * self._size:
            return CERTAIN * bound
        self._objects[1].setTransform(fcl_pose(X))
        with at_work_on(*self._names):
            if touching and fcl.collide(*self._objects, _ANY, fcl.CollisionResult()):
                return 0.0
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
