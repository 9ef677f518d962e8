"""Numbers that several modules of `contacts.overlap` share."""

from __future__ import annotations

EXACT_OVERLAP = 0.02
"""Depth, in contact tolerances, below which an overlap is none: rounding of coordinates, 10 µm with 0.5 mm."""
