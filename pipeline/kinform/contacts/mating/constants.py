"""Numbers that several modules of `contacts.mating` share."""

from __future__ import annotations

import math

FREEFORM_ANGLE = math.radians(1.0)
"""rad: uncertainty of the direction of a freeform patch, at least. Chosen, not measured."""
