"""Cylinders and cones in one batch: what both do alike is done for all at once, because most of the time of a few
regions goes into beginning steps.

Every region has to the last bit the surface that it has among regions of its kind alone: a cylinder is a cone whose
half-angle is 0 and stays so, and each kind has its own least squares to solve and its own ends of iterations.
"""

from __future__ import annotations

import numpy as np

from kinform.model.arrays import Array, Flags, Ints
from kinform.surfaces.groups import solve_normal
from kinform.surfaces.kinds.batch import Batch, Params
from kinform.surfaces.kinds.cone import Cone
from kinform.surfaces.kinds.cylinder import Cylinder
from kinform.surfaces.kinds.kind import DAMPING, Kind, Moving
from kinform.surfaces.kinds.ruled import Ruled
from kinform.surfaces.polygons.noise import Scales


class Mixed(Ruled):
    """Regions of cylinders, and after them those of cones."""

    name = "cylinder or cone"  # type: ignore[assignment]  # of no surface: each is described by its own kind
    least = Cylinder.least
    bends = Cone.bends
    saddle = False
    handicap = Cylinder.handicap
    tapers = True

    def __init__(self, cylinder: Cylinder, cone: Cone, first: int):
        """`first` is the number of the first cone."""
        self._cylinder, self._cone, self._first = cylinder, cone, first

    def of(self, numbers: Ints) -> Mixed:
        """Of regions in ascending order."""
        return Mixed(self._cylinder, self._cone, int(numbers.searchsorted(self._first)))

    def each(self, count: int) -> list[tuple[Kind, slice]]:
        """Cylinders, then cones, where there are any."""
        cylinders: tuple[Kind, slice] = self._cylinder, slice(0, self._first)
        cones: tuple[Kind, slice] = self._cone, slice(self._first, count)
        return [cylinders] if self._first == count else [cones] if not self._first else [cylinders, cones]

    def enough(self, size: Ints) -> Flags:
        """As each kind has it."""
        return np.concatenate([kind.enough(size[run]) for kind, run in self.each(len(size))])

    def propose(self, batch: Batch) -> tuple[Params, Flags]:
        """Each kind for its own regions."""
        batch.find_shared()
        params, usable = zip(*(kind.propose(batch.run(run)) for kind, run in self.each(batch.count)), strict=True)
        return np.concatenate(params), np.concatenate(usable)

    def moving(self, batch: Batch) -> Moving:
        """By mesh and kind."""
        meshes = len(batch.patchwork.total)
        of_region = batch.mesh.copy()
        of_region[self._first :] += meshes
        return Moving(of_region, 2 * meshes)

    def apices(self, params: Params) -> Array:
        """Of cones; cylinders have none."""
        out = super().apices(params)
        out[: self._first] = 0.0
        return out

    def change(self, matrix: Array, right: Array) -> Array:
        """Of cylinders without the half-angle."""
        out = np.zeros(right.shape)
        for kind, run in self.each(len(right)):
            free = slice(None) if kind is self._cone else slice(0, 5)
            out[run, free] = -solve_normal(matrix[run, free, free], right[run, free], DAMPING)
        return out

    def credible(self, batch: Batch, params: Params, scale: Scales) -> Flags:
        """As each kind has it."""
        return np.concatenate(
            [kind.credible(batch.run(run), params[run], scale.at(run)) for kind, run in self.each(batch.count)]
        )
