"""Numbers that several modules of `kinematics.joints.pair` share."""

from __future__ import annotations

import math

SAME_PITCH = 5e-3
"""Relative difference of pitches that are one."""
VAGUE_AXIS = math.radians(0.5)
"""rad: standard uncertainty of its direction above which an axis is too badly known for a joint."""
