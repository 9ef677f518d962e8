"""Facets → analytic surfaces: planes, cylinders, cones, spheres with the uncertainty of each fit."""

from kinform.surfaces.copies import rigid_copies, surfaces_of_copy
from kinform.surfaces.recovery import recover

__all__ = ["CODE_VERSION", "recover", "rigid_copies", "surfaces_of_copy"]

CODE_VERSION: int = 6
"""Bumped when results change."""
