"""Mass: mass, centre of mass and inertia of parts and bodies, from geometry and density or as stated."""

from __future__ import annotations

from kinform.mass.compile import compile_mass

__all__ = ["CODE_VERSION", "compile_mass"]

CODE_VERSION: int = 3
