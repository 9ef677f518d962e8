"""Numbers that several modules of `reports.page` share."""

from __future__ import annotations

import math

SIDE_FRAMES = 16
"""Steps to each side of the pose of the meshes; more where a turn would take larger ones than FINEST_TURN. Chosen, not
measured: a second at 30 a second, there and back."""
SHOWN_TURN = math.radians(28.0)
"""rad, greatest turn of a driver whose range is not known. Chosen by eye: what moves is seen, and little collides."""
PORTION = 1 << 16
"""Pixels, or pieces of lines, that are worked on at once: with some dozen numbers each they take a few megabytes."""
ZLIB_EFFORT = 6
"""Of zlib: 9 takes two to three times as long for 3 % less."""
