"""Numbers that several modules of `surfaces.kinds` share."""

from __future__ import annotations

CONVERGED = 1e-13
"""Change of the parameters (rad, spans) at which a fit stands still: some hundred roundings of doubles. A larger one
changes surfaces in their last digits, and with them which samples of contact are kept."""

LARGEST_DOUBLE = 5.0
"""Radius, in spans, beyond which a sphere or torus is none that a joint could use: half of that of cylinders, as they
bend both ways. Chosen, not measured."""

SAGITTA = 4
"""Fits by which the middle of a curved face stands off the chord of its ends, at least: less is as well a plane."""
LEAST_POINTS = 6
"""Vertices that suggest a circle, sphere or cone, at least: twice what determines a circle."""
LARGEST = 10.0
"""Radius, in spans, beyond which a cylinder or cone is none that a joint could use: its arc bulges by 1/80 of the span.
Chosen, not measured."""
TILT_LIMIT = 0.3
"""rad: largest change of an angle in one step of a fit, so that it does not leap to another surface. Chosen, not
measured."""
RING_APART = 0.2
"""Share of the angle of a typical facet by which different generators, and different rings of a torus, differ at least.
Chosen, not measured."""
