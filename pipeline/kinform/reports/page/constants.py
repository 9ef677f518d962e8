"""Numbers that several modules of `reports.page` share."""

from __future__ import annotations

import math

SIDE_FRAMES = 16
"""Steps to each side of the pose of the meshes; more where a turn would take larger ones than FINEST_TURN."""
SHOWN_TURN = math.radians(28.0)
"""rad, greatest turn of a driver whose range is not known; a choice."""
MOST_POINTS = 600
"""Points of an effort over its speed: twice the columns of a curve over time, as it may pass each twice."""
