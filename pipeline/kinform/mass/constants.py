"""Numbers by which the mass of parts and bodies is decided, by the module that uses them."""

from __future__ import annotations

# --- compile ----------------------------------------------------------------------------------------------------------

FLAT = 1e-12
"""A solid with less than this share of its diagonal's cube is flat: what is left is rounding."""

# --- principal --------------------------------------------------------------------------------------------------------

EQUAL_MOMENTS = 1e-9
"""Moments that differ by less than this share of the largest are one: rounding makes their axes."""
ROUNDED_MOMENTS = 1e-6
"""Share of the largest moment by which stated moments may break a law: six printed digits."""
NEAREST = 1e-3
"""How much shorter the projection of a world's axis may be than the longest, where x goes before y before z, as in the
sign of an axis."""
