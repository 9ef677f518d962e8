"""Sizes: boxes of the assembly and of any set of its parts, and volumes of parts."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from kinform.foundation.algebra.vectors import norm
from kinform.foundation.tied_sizes import tied_sizes
from kinform.model.assembly import Assembly
from kinform.model.names import PartName


class Extents:
    """Boxes of the meshed parts of an assembly, in the world (m)."""

    def __init__(self, assembly: Assembly):
        self._boxes: dict[PartName, NDArray[np.float64]] = {}
        self._known: dict[tuple[PartName, ...], float] = {}
        for part in assembly.parts:
            if part.mesh is not None and len(part.mesh.vertices):
                self._boxes[part.name] = np.array(part.mesh.placed_box(part.X_WP))

    def diagonal(self, names: Iterable[PartName]) -> float:
        """Diagonal of the box of some parts (m); 0 without meshes."""
        key = tuple(names)
        if key not in self._known:
            boxes = [self._boxes[name] for name in key if name in self._boxes]
            size = np.ptp(np.concatenate(boxes), axis=0) if boxes else np.zeros(3)
            self._known[key] = norm(size)
        return self._known[key]

    @property
    def assembly(self) -> float:
        """Diagonal of the assembly's box (m); 1 without meshes."""
        return self.diagonal(self._boxes) or 1.0


def part_volumes(assembly: Assembly) -> dict[PartName, float]:
    """m³ of every part with a mesh; that of its box where the mesh is open. Volumes that differ only by the rounding of
    files are equal, and so are their sums in any order."""
    out = {}
    for part in assembly.parts:
        if part.mesh is not None:
            own = part.mesh.health.volume
            out[part.name] = abs(own) if own else float(np.prod(np.subtract(*part.mesh.placed_box(part.X_WP)[::-1])))
    return tied_sizes(out)
