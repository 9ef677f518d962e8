"""Numbers that several modules of `views` share."""

from __future__ import annotations

REST = 1e-9
"""Share of the greatest position, effort, energy or work below which a series or a sum is nothing but rounding."""
