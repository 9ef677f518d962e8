"""Numbers that the mechanism and what is built on it share."""

from __future__ import annotations

SIGMAS = 3.0
"""Standard uncertainties by which fitted axes, centres and normals may be off: beyond it chance is below 1 %."""
CLOSED = 1e-7
"""Relative singular value below which a combination of joint rates closes its loops; the axes have been made exactly
parallel and coaxial before, so true zeros are rounding."""
FAR_AXIS = 1e-9
"""A twist whose axis is farther away than the size of the assembly over this is a slide."""
