"""Numbers that several modules of `contacts.mating` share."""

from __future__ import annotations

import math

SURELY_FACING = 1e-6
"""More than rounding, of cosines of facets that are left out as they are clearly turned away."""
FREEFORM_ANGLE = math.radians(1.0)
"""rad: the direction of a freeform patch is known no better than this."""
