"""Function: which joint of the derived behaviour a name in the designer's statements stands for."""

from __future__ import annotations

from kinform.function.acted_freedoms import FREEDOMS, ActedFreedom, acted_freedom
from kinform.function.acting_forces import acting_by_force, needing_forces
from kinform.function.as_intended import DesignersJoint, as_intended, designers_joints
from kinform.function.joint_names import Resolution, resolve_joint, stated_ranges

__all__ = [
    "CODE_VERSION",
    "FREEDOMS",
    "ActedFreedom",
    "DesignersJoint",
    "Resolution",
    "acted_freedom",
    "acting_by_force",
    "as_intended",
    "designers_joints",
    "needing_forces",
    "resolve_joint",
    "stated_ranges",
]

CODE_VERSION: int = 5
