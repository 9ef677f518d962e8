"""Numbers that several modules of `kinematics.joints.axes` share."""

from __future__ import annotations

MET = 1e-15
"""Relative to the coordinates: what agrees within this agrees as well as numbers can say."""
FITTING_ROUNDS = 8
"""Rounds of Gauss and Newton: axes converge in three."""
