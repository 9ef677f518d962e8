"""Numbers that several modules of `contacts.higher` share."""

from __future__ import annotations

STRAIGHT_COSINE = 0.999
"""Least cosine between normals that count as one direction, 2.6°: those of a straight line, and with the opposite sign
those of two sides of a slot that hold a pin. Chosen, not measured."""

ROUND_KINDS = ("cylinder", "cone", "sphere", "torus", "revolution", "helicoid")
"""Kinds of patches with an axis or a centre at a place."""
CAPTIVE = 0.42
"""Within this a pin in a slot, a ball in a groove or a tooth between two that has as much play on either side counts
as held by both."""
ZONE = 0.01
"""Largest height, in contact tolerances, of the zone about a point or a line whose area is stated. Chosen, not
measured."""
BALL_BORE_SAMPLES = 16
"""Samples around a ball in a bore: 22.5° apart. Chosen, not measured."""
ROLLER_SAMPLES = 17
"""Samples along a roller on a plane or between two rollers; odd, so that one is in the middle. Chosen, not measured."""
LINE_SAMPLES = 9
"""Samples along an edge, and along the line in which outlines meet; odd, so that one is in the middle. Chosen, not
measured."""
