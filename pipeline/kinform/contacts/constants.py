"""The numbers that decide about contacts, by the module that uses them first.

Lengths are shares of the contact tolerance, which scales with the parts, unless a unit is stated. Where neither a
reason nor a measurement is named the number is a choice.
"""

from __future__ import annotations

import math

MATING_REACH = 1.02
"""Limits reach this much beyond the contact tolerance: designers put clearances of exactly 0.5 mm, and
rounding must not decide whether those are contacts."""
FACING_LEAST = 0.5
"""Least cosine between a probe and the facet that it has to meet."""
PROBE_SPARE = 0.05
"""By so much further than a facet is expected at most it is looked for."""
TOUCHING = ("point", "line")
"""Kinds of higher pairs."""
EXACT_GAP = 1e-3
"""A gap below this is none."""
GIVER_AREA = 4.0
"""An analytic surface gives normals to others, and a plane to edges, from this area on, in squared tolerances."""
FACING_OPPOSED = -0.93
"""Greatest cosine between the surface's normal and a facet that rests on it."""
CLEARLY = 1e-9
"""Of the coordinates: more than rounding, of facets that are left out as they lie clearly off a surface."""
TOUCH = 0.12
"""Within this a point or a line touches: the band of full weight."""
CYLINDER_EXACT = 0.05
"""A cylinder is exact when its fit misses the vertices by less than this share of its chord error."""
ROUND_SWEEP = 0.9 * 2 * math.pi
"""rad: least sweep of a hole, and of the edges of a rim."""
