"""Numbers that several modules of `surfaces.regions` share."""

from __future__ import annotations

WIDEST = 1.2
"""rad: largest angle that a facet may subtend: strips of prisms with six sides and more, with room for rounding."""
