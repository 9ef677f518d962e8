"""The numbers that decide how surfaces are recovered, by the module that uses them.

Lengths are shares of the mesh's span, angles radians. What users may set is in `Tolerances`. Where no measurement
is named, a number is a choice: the meshes of the fixtures and of real robots give the same surfaces well around it.
"""

from __future__ import annotations

COVERAGE = 3.0
"""Stated uncertainties are this many standard deviations."""
ROWS = 2**15
"""Rows that are computed at a time where each is for itself: 2 MB of eight columns. It bounds memory and changes no
bit."""
NORMAL_SLACK = 5e-3
"""Angle by which a facet's normal may differ from the surface's, besides half of its width."""
