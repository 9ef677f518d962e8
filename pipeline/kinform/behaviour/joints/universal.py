"""Universal: a turn about `axis`, which is fixed in the first body, then one about `axis2`, which is
fixed in the second. Coordinates: both angles (rad) in that order."""

import numpy as np

from kinform.behaviour.joints.kind import JointGeometry, JointKind
from kinform.behaviour.joints.revolute import turn
from kinform.behaviour.primitives import OneFreedom

__all__ = ["UNIVERSAL"]


def _chain(geometry: JointGeometry) -> tuple[OneFreedom, ...]:
    point = geometry.needed("point")
    axis, axis2 = geometry.needed("axis"), geometry.needed("axis2")
    if float(np.linalg.norm(np.cross(axis, axis2))) < 1e-6:
        raise ValueError("its two axes are parallel")
    return (turn(axis, point), turn(axis2, point))


UNIVERSAL = JointKind("universal", (("angle", True), ("angle2", True)), 2, _chain, (0, 1))
