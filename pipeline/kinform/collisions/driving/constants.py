"""Numbers that several modules of `collisions.driving` share."""

from __future__ import annotations

MEETING_MARGIN = 1e-6
"""Facets whose swept profiles come no nearer than this never meet. Chosen, not measured."""
