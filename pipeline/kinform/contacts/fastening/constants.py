"""Numbers that several modules of `contacts.fastening` share."""

from __future__ import annotations

import math

AXES_PARALLEL = math.radians(0.5)
"""rad: largest angle between two axes that line up. Chosen, not measured."""
