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

ALONG_AXIS = 0.9998
"""Cosine of the angle (1.1°) up to which a surface counts as along, or across, the axis of its joint for friction: what
contact takes for one axis agrees far better, and other faces stand at degrees."""
ALIKE_RADII = 0.02
"""Share by which radii of journals, or of thrust rings, may differ and count as one; coefficients are known worse."""
MATERIAL_PAIRS: dict[tuple[str, str], tuple[float, float]] = {
    ("aluminium", "steel"): (0.47, 0.61),
    ("brass", "steel"): (0.44, 0.51),
    ("copper", "steel"): (0.36, 0.53),
    ("glass", "glass"): (0.40, 0.94),
    ("ptfe", "ptfe"): (0.04, 0.04),
    ("ptfe", "steel"): (0.04, 0.04),
    ("steel", "steel"): (0.57, 0.74),
}
"""(in motion, at rest) of clean and dry pairs of materials, sorted, as tables of general physics have them (Serway and
Jewett, Physics for Scientists and Engineers, table 5.1; Marks' Standard Handbook for Mechanical Engineers, section 3.2,
for brass and for PTFE on steel). Lubrication, finish and wear change them several times over: runs name what they
took, and a [[friction]] of the manifest goes before."""
LEAST_GAS = 1e-6
"""Share of the column of a gas spring below which its force grows no further: nothing is pushed in so far."""
STRAIGHT = 1e-9
"""Share of a table's span by which rows may be off the line between its ends and count as on it: tables that programs
write have nine digits and more."""
TIED = 1e-9
"""Share of the greatest singular value of ratios between joints up to which one is nought: ratios are given to six
digits and more, and stand side by side as they are, each row over its greatest."""
