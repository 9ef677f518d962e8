"""Numbers that decide what exports and the drawing of the kinematic graph look like."""

from __future__ import annotations

GRAIN = 1e-9
"""kg and kg·m², of links and bodies whose mass is not known: small enough to change no motion."""
