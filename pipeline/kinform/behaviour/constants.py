"""Constants of the port model: every number that decides something and that no user sets."""

from __future__ import annotations

# joints

PARALLEL_AXES = 1e-6
"""rad: the axes of a universal joint make no cross at less, far above the rounding of unit vectors."""

# faults

UNIT_LENGTH = 1e-9
"""Length of an axis beyond 1 that no rounding explains."""

# signals

OVERSHOOT = 0.02
"""Share of a table's span that a spline may leave its rows: a sine of sixteen rows a turn does."""
SPLINE_SAMPLES = 17
"""Places in each stretch of a table at which a spline is compared with its straight line: ends and sixteenths."""
