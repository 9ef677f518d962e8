"""Function: which joint of the derived behaviour a name in the designer's statements stands for."""

from __future__ import annotations

from kinform.function.as_intended import DesignersJoint, as_intended, designers_joints
from kinform.function.joint_names import Resolution, resolve_joint, stated_ranges

__all__ = [
    "CODE_VERSION",
    "DesignersJoint",
    "Resolution",
    "as_intended",
    "designers_joints",
    "resolve_joint",
    "stated_ranges",
]

CODE_VERSION: int = 3
