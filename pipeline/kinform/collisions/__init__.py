"""What motions run into: the range of joints, collisions along a run. By FCL on the meshes."""

from __future__ import annotations

from kinform.collisions.along import along
from kinform.collisions.ranges import ranges

__all__ = ["CODE_VERSION", "along", "ranges"]

CODE_VERSION: int = 7
