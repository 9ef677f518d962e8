"""How large the assembly, a body, or any set of its parts is."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from kinform.model.assembly import Assembly
from kinform.model.names import PartName

__all__ = ["Extents"]


class Extents:
    """Boxes of the meshed parts of an assembly, in the world (m)."""

    def __init__(self, assembly: Assembly):
        self._boxes: dict[PartName, NDArray[np.float64]] = {}
        for part in assembly.parts:
            if part.mesh is not None and len(part.mesh.vertices):
                placed = part.mesh.vertices @ part.X_WP[:3, :3].T + part.X_WP[:3, 3]
                self._boxes[part.name] = np.array([placed.min(axis=0), placed.max(axis=0)])

    def diagonal(self, names: Iterable[PartName]) -> float:
        """Diagonal of the box of some parts (m); 0 without meshes."""
        boxes = [self._boxes[name] for name in names if name in self._boxes]
        if not boxes:
            return 0.0
        low, high = np.min([b[0] for b in boxes], axis=0), np.max([b[1] for b in boxes], axis=0)
        return float(np.linalg.norm(high - low))

    @property
    def assembly(self) -> float:
        """Diagonal of the assembly's box (m); 1 without meshes."""
        return self.diagonal(self._boxes) or 1.0
