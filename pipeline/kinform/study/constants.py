"""Every number that decides what a study draws and concludes."""

from __future__ import annotations

SAMPLES_MOST = 1_000_000
"""Samples of a study; its table is held in memory. A choice."""

SIGMAS = 3.0
"""Standard deviations from the middle of a tolerance to its limits, where it is met by a normal distribution: a process
whose capability is 1, so that 0.27 % lie outside. What drawings are commonly read as."""

CONFIDENCE = 0.95
"""Of intervals; a choice."""

WORST = 5
"""Samples that are listed as the worst of a measure; a choice."""

RESAMPLES = 999
"""Of the bootstrap of Sobol' indices; scipy's own choice is as many."""

NOTHING_VARIES = 1e-12
"""Share of its greatest value by which a measure differs at most where it does not vary: rounding."""

BINS_MOST = 60
"""Bars of a histogram at most: thinner than 4 px they are no more to be told apart. A choice."""

UNITS = {
    "mass": "kg",
    "volume": "m³",
    "area": "m²",
    "centre_of_mass": "m",
    "point": "m",
    "inertia": "kg·m²",
    "principal_moments": "kg·m²",
    "duration": "s",
}
"""What values of these names are in, where nothing beside them says it."""
