"""Facets → analytic surfaces: planes, cylinders, cones, spheres with the uncertainty of each fit."""

from kinform.surfaces.congruent import congruent, moved
from kinform.surfaces.recovery import recover

__all__ = ["CODE_VERSION", "congruent", "moved", "recover"]

CODE_VERSION: int = 6
"""Bumped when results change."""
