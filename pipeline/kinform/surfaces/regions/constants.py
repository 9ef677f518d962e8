"""Numbers that several modules of `surfaces.regions` share."""

from __future__ import annotations

WIDEST = 1.2
"""Greatest angle that a facet may subtend (rad)."""
