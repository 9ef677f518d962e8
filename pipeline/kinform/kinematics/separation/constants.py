"""Numbers that several modules of `kinematics.separation` share."""

from __future__ import annotations

CONE_FREE = 1e-4
"""Speed of a row, relative to a unit twist, below which it does not move: as the singular values of free directions
(`Tolerances.free`), for rounding of meshes."""
CONE_HELD = 2e-3
"""Speed above which it moves, as `Tolerances.held`; between the two it is undetermined."""
HIGHS_FEASIBLE = 1e-7
"""By how much HiGHS lets rows miss their bounds (its default feasibility tolerance): smaller entries of unit rows are
rounding to it. With such entries it may not end: a hand of 146 parts did not in ten minutes."""
