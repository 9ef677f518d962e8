"""Numbers that several modules of `collisions.pair` share."""

from __future__ import annotations

from kinform.foundation.rounding import SINGLE

CERTAIN = 1.0 - SINGLE
"""Share of a distance that is trusted: FCL computes with corners in doubles that came from files in single
precision."""
