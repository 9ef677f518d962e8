"""Numbers that the mechanism and what is built on it share."""

from __future__ import annotations

from kinform.foundation.constants import COVERAGE

SIGMAS = COVERAGE
"""Standard uncertainties by which fitted axes, centres and normals may be off."""
FREE = 1e-7
"""Relative singular value below which a combination of joint rates closes its loops at the pose of the meshes: the
square root of rounding, 1e-16, at singular poses, above the 1e-8 that snapping leaves of axes that were made parallel
and coaxial. All along a motion loops are open by more (`rank.RANK_SHARE`)."""
