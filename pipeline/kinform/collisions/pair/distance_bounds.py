"""How far a motion certainly does not bring two parts together, by their distance as wholes: most pairs need no more.

Conservative advancement: at a distance d nothing happens until points have travelled d (Mirtich 1996). It goes on as
long as its steps are long; from there on the facets that count, and where they cross, have to be looked at. Parts are
taken by few facets that are off them by no more than is known (`coarse_meshes`): where these are apart by d, the parts
are by d less what both are off.
"""

from __future__ import annotations

from functools import cached_property

import fcl
import numpy as np

from kinform.collisions.pair.constants import CERTAIN
from kinform.collisions.pair.course import Course
from kinform.collisions.pair.prepared_pair import PairTest
from kinform.collisions.parts.shapes import Shapes
from kinform.foundation.current_work import working_on
from kinform.foundation.meshes.fcl_adapter import fcl_distance, fcl_pose
from kinform.foundation.rounding import SINGLE
from kinform.model.arrays import Array

SHORT_STEP = 0.01
"""Steps below this share of the size of the pair are short: a choice."""
STEPS_MOST = 60
"""Steps that are taken with whole parts before the facets that count are followed alone: a choice."""


class Apart:
    """Two parts on their way, by how far they are certainly apart; `size` (m): diagonal of the smaller."""

    def __init__(self, size: float):
        self._size, self.steps = size, 0

    def distance(self, D: Array) -> float:
        """m: nothing that counts is nearer at a displacement (4, 4) of the second body relative to the first; 0 where
        that is not known."""
        raise NotImplementedError

    def touch(self, D: Array) -> bool:
        """Whether they touch, or nearly."""
        return self.distance(D) <= SINGLE * SHORT_STEP * self._size

    def step(self, course: Course, s: float, end: float) -> tuple[float, bool]:
        """A parameter after s up to which they are certainly apart, and whether that was too short a step to go on
        so."""
        self.steps += 1
        free = self.distance(course.displacement(s))
        following = course.when(course.travel(s) + max(free, 0.0), s, end)
        return following, following < end and (free < SHORT_STEP * self._size or self.steps > STEPS_MOST)

    def clear_until(self, course: Course, start: float, end: float) -> float:
        """The parameter up to which they are certainly apart: `start` where they touch, `end` where they stay so; less
        where so many steps as are taken would not reach the end."""
        s, short = self.step(course, start, end)
        while s < end and not short:
            # Steps after which it is seen whether so many reach the end: a pair that stays near is followed with the
            # facets that count, which are fewer. A choice.
            if self.steps >= 8 and (s - start) * STEPS_MOST < (end - start) * self.steps:
                break
            s, short = self.step(course, s, end)
        return s


class Wholes(Apart):
    """Two parts with all their facets."""

    def __init__(self, shapes: Shapes, first: str, second: str):
        super().__init__(min(shapes.mesh(first).diagonal, shapes.mesh(second).diagonal))
        self._shapes, self._names = shapes, (first, second)
        self._to_first = np.linalg.inv(shapes.part(first).X_WP)
        self._X_WB = shapes.part(second).X_WP

    @cached_property
    def _objects(self) -> tuple[tuple[fcl.CollisionObject, fcl.CollisionObject], float]:
        """Both by few facets, and how far (m) these are off the parts, together."""
        with working_on(*self._names):
            (first, off), (second, away) = (self._shapes.coarse(name) for name in self._names)
        return (fcl.CollisionObject(first), fcl.CollisionObject(second)), off + away

    def distance(self, D: Array) -> float:
        """By few facets of both, less what these are off."""
        objects, off = self._objects
        objects[1].setTransform(fcl_pose(self._to_first @ D @ self._X_WB))
        with working_on(*self._names):
            return max(CERTAIN * fcl_distance(*objects) - off, 0.0)


class Counted(Apart):
    """Two parts with those of their facets that count."""

    def __init__(self, test: PairTest):
        super().__init__(test.size)
        self._test = test

    def distance(self, D: Array) -> float:
        """Of these facets."""
        return CERTAIN * self._test.distance(D)[0]
