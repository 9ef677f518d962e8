"""Numbers that several modules of `surfaces.kinds` share."""

from __future__ import annotations

SAGITTA = 4
"""Fits by which the middle of a round face stands off the chord of its ends, at least: less is as well a flat."""
LEAST_POINTS = 6
"""Vertices that suggest a circle, sphere or cone, at least: twice what determines a circle."""
LARGEST = 10.0
"""Radius, in spans, beyond which a cylinder or cone is none that a joint could use."""
CONVERGED = 1e-13
"""Change of the parameters (rad, spans) at which a fit stands still."""
TILT_LIMIT = 0.3
"""Greatest change of an angle in one step of a fit, so that it does not leap over to another surface."""
LEAST_RADIUS = 1e-9
"""Least radius that a fit may reach."""
RING_APART = 0.2
"""Share of the angle of a typical facet by which generators, and rings of a torus, differ that are not the same."""
