"""Numbers and colours that decide what reports, the page and its pictures show."""

from __future__ import annotations

WIDTH = 80
"""Columns of text at a terminal: what every terminal shows."""
QUIET_NOTES = ("KF303",)
"""Rules whose notes short reports leave out, and `-v` and JSON have: every planar loop has redundant constraints."""
OVERLAP_COLOUR = "#f0283a"
"""Of solids that occupy the same space."""
EYE_TURN, EYE_RISE = -0.95, 0.42
"""rad, the direction from which everything is seen: angle about z, and above the ground; that of the viewer's start."""
FINDING_MARGIN = 1.35
"""Size of the picture of a finding over that of what it holds. Chosen by eye."""
FINDING_ZOOM, FINDING_SHIFT = 1.12, 0.4
"""How much closer the picture of a finding with a place is, and how far it moves towards the place. Chosen by eye."""
