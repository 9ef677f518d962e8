"""Mass: mass, centre of mass and inertia of parts and bodies, from geometry and density or as stated."""

from __future__ import annotations

from kinform.mass.compile import compile_mass, weighed_together

__all__ = ["CODE_VERSION", "compile_mass", "weighed_together"]

CODE_VERSION: int = 4
"""Bumped when results of this package change for the same input."""
