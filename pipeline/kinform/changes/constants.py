"""Numbers that decide what a lock says and accepts."""

from __future__ import annotations

GRAIN_SHARE = 0.1
"""Values are rounded to this share of their tolerance: rounding cannot make a difference by itself."""
DIRECTION_PLACES = 6
"""Decimals of directions: 1e-6 rad is far below any tolerance of angles that a lock has."""
LENGTH_ERROR = 1e-3
"""By so much a direction in a lock may miss the length 1; more is a mistake of who wrote it."""
