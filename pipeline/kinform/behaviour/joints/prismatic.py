"""Prismatic: a slide along an axis. Coordinate: the distance (m)."""

import numpy as np

from kinform.behaviour.joints.kind import JointGeometry, JointKind
from kinform.behaviour.primitives import OneFreedom
from kinform.model.arrays import Array

__all__ = ["PRISMATIC", "slide"]


def slide(direction: Array) -> OneFreedom:
    """Slide along the unit direction."""
    return OneFreedom(np.zeros(3), np.zeros(3), direction)


def _chain(geometry: JointGeometry) -> tuple[OneFreedom, ...]:
    return (slide(geometry.needed("axis")),)


PRISMATIC = JointKind("prismatic", (("distance", False),), 1, _chain, (0,))
