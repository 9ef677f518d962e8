"""What motions run into: the range of joints, collisions along a run, clearances. By FCL on the meshes."""

from __future__ import annotations

from kinform.collisions.ranges import ranges

__all__ = ["CODE_VERSION", "ranges"]

CODE_VERSION: int = 1
