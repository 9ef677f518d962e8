"""Numbers that several modules of `contacts.overlap` share."""

from __future__ import annotations

EXACT_OVERLAP = 0.02
"""An overlap below this is none: rounding of coordinates."""
