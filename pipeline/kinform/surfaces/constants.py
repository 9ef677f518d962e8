"""The numbers that decide how surfaces are recovered, by the module that uses them.

Lengths are shares of the mesh's span, angles radians. What users may set is in `Tolerances`. Where no measurement
is named, a number is a choice: the meshes of the fixtures and of real robots give the same surfaces well around it.
"""

from __future__ import annotations

FLAT_NOISES = 2
"""Heights, in noises of the vertices, up to which they mean nothing: normals of thinner facets, and the rise of a
polygon over its neighbour. Both vertices of a height may be off by one."""

ROWS = 1 << 14
"""Rows that are computed at a time where each is independent of the others: 1 MB of eight columns, which stays in the
cache. It bounds memory and changes no result."""
NORMAL_SLACK = 5e-3
"""rad by which the normal of a facet may differ from that of the surface, besides half of the angle that the facet
subtends. Chosen, not measured."""
