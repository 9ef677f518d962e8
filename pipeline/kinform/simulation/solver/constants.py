"""Numbers that several modules of `simulation.solver` share."""

from __future__ import annotations

LOOK = 250
"""Steps after which the run is looked at for stiffness."""
LAW_PARTS = 8.0
"""Parts of half a period of a law that a step may be as long as while a stop holds: in longer ones push turns to pull
and back unseen."""
RELEASE_HALVINGS = 40
"""Halvings of a step to find where a stop begins to pull: to 1e-12 of it."""
