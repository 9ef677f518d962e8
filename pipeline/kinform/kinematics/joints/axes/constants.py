"""Numbers that several modules of `kinematics.joints.axes` share."""

from __future__ import annotations

MET = 1e-15
"""Relative to the coordinates: what agrees within this agrees as well as numbers can say."""
EXACTLY_PARALLEL = 1e-14
"""Sine below which axes are exactly parallel: snapping makes them so."""
FITTING_ROUNDS = 8
"""Rounds of Gauss and Newton: axes converge in three."""
