"""The numbers that decide about contacts, by the module that uses them first.

Lengths are shares of the contact tolerance, which scales with the parts, unless a unit is stated. Where neither a
reason nor a measurement is named the number is a choice.
"""

from __future__ import annotations

import math

SAMPLES = 400
"""Most facets or points of either side that a contact or an overlap is measured at: an evenly spread share of more.
Chosen, not measured."""

RIM_POINTS = 96
"""Places around a rim that stand for it: 3.75° apart, and another surface comes near at two or four of them."""

PARALLEL_SINE = 1e-3
"""Sine between directions up to which they are parallel: 0.06°, far above rounding and far below any intended angle."""

FLUSH_ANGLE = math.radians(3.0)
"""rad: faces and curves that meet or oppose each other within this are flush or straight but for tessellation; beyond,
they have an edge between them. Chosen, not measured."""

MATING_REACH = 1.02
"""Factor on limits of contact: designers draw clearances of exactly the tolerance, 0.5 mm, and rounding must not decide
whether those are contacts."""
FACING_LEAST = 0.5
"""Least cosine between a probe and the facet that it has to meet: 60°. Chosen, not measured."""
PROBE_SPARE = 0.05
"""Distance, in contact tolerances, by which a facet is looked for beyond where it is expected at most. Chosen, not
measured."""
TOUCHING = ("point", "line")
"""Kinds of higher pairs."""
EXACT_GAP = 1e-3
"""Lengths below this, in contact tolerances, are zero: gaps, and distances between ends of segments. With 0.5 mm it is
0.5 µm, above what single precision rounds parts of a metre by."""
PATCH_AREA = 4.0
"""Least area, in squared contact tolerances, of a patch that is measured by facets, and of an analytic surface or plane
that gives normals to others: less is a stray touch of two rounded edges."""
FACING_OPPOSED = -0.93
"""Largest cosine between the normal of a surface and that of a facet that rests on it: 21.6° from opposite. Chosen, not
measured."""
TOUCH = 0.12
"""Within this a point or a line touches: the band of full weight."""
CYLINDER_EXACT = 0.05
"""Share of the chordal deviation of a cylinder that its fit may miss the vertices by and still be exact. Chosen, not
measured."""
ROUND_SWEEP = 0.9 * 2 * math.pi
"""rad: least sweep of a hole, and of the edges of a rim: nine tenths of a turn, so that a keyway does not open it.
Chosen, not measured."""
