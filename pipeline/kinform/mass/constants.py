"""Numbers by which the mass of parts and bodies is decided, by the module that uses them."""

from __future__ import annotations

FLAT = 1e-12
"""A solid with less than this share of its diagonal's cube is flat: what is left is rounding."""
