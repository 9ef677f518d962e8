"""What every kind of joint says of itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from kinform.behaviour.primitives import Primitive
from kinform.model.arrays import Array
from kinform.model.quantities import Direction, Metres, Place

__all__ = ["JointGeometry", "JointKind"]


@dataclass(frozen=True, eq=False)
class JointGeometry:
    """Where a joint is, in the world at the pose of the meshes; None where its kind needs nothing."""

    axis: Direction | None = None
    """(3,) unit."""
    point: Place | None = None
    """(3,) m."""
    axis2: Direction | None = None
    """(3,) unit."""
    pitch: Metres | None = None
    """Metres a turn."""

    def needed(self, name: str) -> Array:
        """The vector `axis`, `axis2` or `point`; ValueError when it is not known."""
        value: Array | None = getattr(self, name)
        if value is None or not np.all(np.isfinite(value)):
            raise ValueError(f"its {name} is not known")
        return value


@dataclass(frozen=True)
class JointKind:
    """A kind of joint: its coordinates in their fixed order, and its motion as a chain of primitives.

    `coordinates` are (name, rotational) pairs, one a column of the results; the primitives of `chain`
    take them in the order of `uses`, listed from the first body to the second.
    """

    name: str
    coordinates: tuple[tuple[str, bool], ...]
    rates: int
    chain: Callable[[JointGeometry], tuple[Primitive, ...]]
    """Raises ValueError when the geometry lacks something."""
    uses: tuple[int, ...]
    """First coordinate of each primitive."""
