"""Numbers as bytes that compress well and that a browser unpacks with a few loops.

Columns of 16-bit numbers are stored as differences between rows, triangles as distances from the highest
vertex seen so far (as in the high-watermark coding of G. Seemann); each as planes of equal significance, so
that deflate finds the runs. Places are quantised to 65 535 steps of the box that holds them.
"""

from __future__ import annotations

import base64
import zlib
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from kinform.model.arrays import Array, Ints
from kinform.reports.page.constants import ZLIB_EFFORT

STEPS = 65535
"""Steps across a box: 16 bits."""


def quantised(values: Array, low: Array, size: Array) -> Ints:
    """Values (n, k) as whole numbers of 0 … STEPS between `low` and `low + size` (k,)."""
    scale = np.divide(STEPS, size, out=np.zeros(np.shape(size)), where=np.asarray(size) > 0.0)
    return np.clip(np.rint((values - low) * scale), 0, STEPS).astype(np.int64)


def restored(numbers: Ints, low: Array, size: Array) -> Array:
    """What `quantised` numbers (n, k) stand for: off by up to half a step."""
    return np.asarray(low + numbers / STEPS * size)


@dataclass
class Blob:
    """Sections of bytes, one after the other; each call gives the offset of what it added."""

    sections: list[bytes] = field(default_factory=list)
    length: int = 0

    def columns(self, numbers: Ints) -> int:
        """Add (n, k) numbers of 0 … 65535, k columns of n differences each."""
        steps = np.diff(numbers, axis=0, prepend=0).astype(np.uint16)
        return self._planes(steps.T.ravel(), 2)

    def triangles(self, faces: Ints) -> int:
        """Add (n, 3) triangles whose vertices are numbered in the order of their first use."""
        flat = faces.ravel()
        highest = np.maximum.accumulate(np.concatenate([[-1], flat[:-1]])) + 1
        return self._planes((highest - flat).astype(np.uint32), 3)

    def _planes(self, numbers: NDArray[np.uint16] | NDArray[np.uint32], planes: int) -> int:
        start = self.length
        data = b"".join(((numbers >> (8 * k)) & 255).astype(np.uint8).tobytes() for k in range(planes))
        self.sections.append(data)
        self.length += len(data)
        return start

    def text(self) -> str:
        """All of it, deflated, as base64."""
        return base64.b64encode(zlib.compress(b"".join(self.sections), ZLIB_EFFORT)).decode("ascii")
