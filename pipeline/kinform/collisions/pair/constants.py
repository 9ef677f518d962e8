"""Numbers that several modules of `collisions.pair` share."""

from __future__ import annotations

CERTAIN = 1.0 - 1e-6
"""Share of a distance that is trusted."""
