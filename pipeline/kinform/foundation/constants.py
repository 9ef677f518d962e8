"""Numbers that several modules of this package, and of those above it, share."""

from __future__ import annotations

LITTLE_FACETS = 10_000
"""Facets in all up to which one process does the work: less than half a second, and another process takes 0.05 to 0.1 s
to start, with what it imports."""

KEPT_FACETS = 200_000
"""Facets of a mesh up to which tables that can be computed again are kept: 5 to 10 MB each."""

MANY = 1000
"""Numbers in an array from which on the way with more steps and less work a number is quicker: lengths of vectors gain
from 300 on, cross products from 3000 on. It changes no result."""

ROWS = 4096
"""Rows of a table that are worked on in one pass, a few hundred bytes each: they stay in the cache of a processor. It
bounds memory and changes no result."""

COVERAGE = 3.0
"""Standard deviations within which a stated or compared quantity lies: 99.7 % of normally distributed ones."""

SCATTERED = 4.0
"""Standard deviations of scattered vertices that count as scatter: one of 16,000 normally distributed ones is
beyond."""

EPS32 = 2.0**-23
"""Relative rounding of single precision, in which STL files store coordinates."""

SLIVER_WIDTH = 1e-3
"""Width of a probe triangle relative to its length: FCL misses most facets with width zero, and a thousandth of a probe
is far below any gap."""
STANDOFF_EDGES = 8.0
"""Limit of the chordal deviation at an edge, in width times turning angle over 8: equilateral triangles on a ball have
16/3, uneven ones up to 7, halved strips 2."""
