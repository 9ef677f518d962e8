"""Numbers by which rules decide, by the module that uses them. What users may set is in `Tolerances`."""

from __future__ import annotations

import math

DRAWN_TURN = math.radians(2.0)
"""An end that a joint which nothing holds finds within this of the drawn pose is no stop. Of 38 public robots those
within 0.9° are teeth and bars of loops that touch as they are drawn; the next is at 5.9°."""
DRAWN_SLIDE = 0.02
"""The same for slides, as a share of the stated range: a chosen number, the robots have slides at exactly 0 only."""
