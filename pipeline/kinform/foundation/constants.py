"""The numbers that decide on the ground floor, by the module that uses them. Where neither a reason nor a measurement
is named the number is a choice."""

from __future__ import annotations

SLIVER_WIDTH = 1e-3
"""Width of a sliver relative to its length: zero width misses most facets."""
STANDOFF_EDGES = 8.0
"""Times width and turn across an edge, over 8, that facets stand off at most: 16/3 where triangles with equal sides are
on a ball, up to 7 where they are less even, and 2 where they halve strips."""
