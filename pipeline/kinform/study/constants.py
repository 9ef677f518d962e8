"""Every number that decides what a study draws and concludes."""

from __future__ import annotations

NOTHING_VARIES = 1e-12
"""Share of its greatest value by which a measure differs at most where it does not vary: rounding."""
