"""Numbers that several modules of `form.meshes` share."""

from __future__ import annotations

WELD_SHARE = 1e-6
"""Welding distance in diagonals of the mesh, where none is stated: ten roundings of single precision."""
FAULTS_SHOWN = 10
"""Faults of one mesh file that are listed, at most."""
