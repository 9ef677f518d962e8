"""Numbers that several modules of `kinematics.separation` share."""

from __future__ import annotations

CONE_HELD = 2e-3
"""Speeds above which they do; in between nobody knows."""
