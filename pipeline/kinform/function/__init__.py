"""Function: which joint of the derived behaviour a name in the designer's statements stands for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinform.foundation.lazy_imports import lazy_attributes

if TYPE_CHECKING:
    from kinform.function.acted_freedoms import FREEDOMS, ActedFreedom, acted_freedom
    from kinform.function.acting_forces import acting_by_force, needing_forces
    from kinform.function.designers_view import (
        DesignersJoint,
        as_intended,
        designers_joints,
        joint_as_stated,
        range_as_stated,
    )
    from kinform.function.joint_names import Resolution, no_stop_within, resolve_joint, stated_ranges

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
    "joint_as_stated",
    "needing_forces",
    "no_stop_within",
    "range_as_stated",
    "resolve_joint",
    "stated_ranges",
]

CODE_VERSION: int = 7
"""Bumped when results of this package change for the same input."""

__getattr__ = lazy_attributes(
    __name__,
    {
        "FREEDOMS": "acted_freedoms",
        "ActedFreedom": "acted_freedoms",
        "acted_freedom": "acted_freedoms",
        "acting_by_force": "acting_forces",
        "needing_forces": "acting_forces",
        "DesignersJoint": "designers_view",
        "as_intended": "designers_view",
        "designers_joints": "designers_view",
        "joint_as_stated": "designers_view",
        "range_as_stated": "designers_view",
        "Resolution": "joint_names",
        "no_stop_within": "joint_names",
        "resolve_joint": "joint_names",
        "stated_ranges": "joint_names",
    },
)
