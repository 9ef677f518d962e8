"""Numbers that several modules of `contacts.higher` share."""

from __future__ import annotations

import math

ROUND_KINDS = ("cylinder", "cone", "sphere", "torus", "revolution", "helicoid")
"""Kinds of patches with an axis or a centre at a place."""
CAPTIVE = 0.42
"""Within this a pin in a slot, a ball in a groove or a tooth between two that has as much play on either side counts
as held by both."""
ZONE = 0.01
"""Bounds the zone of a point or a line whose area is stated."""
BALL_BORE_SAMPLES = 16
"""Samples around a ball in a bore."""
ROLLER_SAMPLES = 17
"""Samples along a roller on a plane or between two rollers."""
LINE_SAMPLES = 9
"""Samples along an edge, and along the line in which outlines meet."""
EDGE_RISE = math.sin(math.radians(3.0))
"""Faces beside an edge rise at least this steeply; flatter ones lie on the plane badly."""
RIM_TRIED = 96
"""Places round a rim at which it is looked how far the other surface is: it comes near at two places or four."""
SIGMAS = 3.0
"""Standard uncertainties within which lines of action are one."""
