"""Every number that decides what is found in a catalog."""

from __future__ import annotations

MOST_ALIKE = 20
"""Designs that are named as like another one; a choice."""

LOOKED_AT = 120
"""Designs of the same graph and mobility, those of the nearest size, whose axes are compared: 0.05 s. A choice."""

PARALLEL = 1e-6
"""Sine of the angle below which two axes are parallel."""
