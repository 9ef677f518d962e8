"""The numbers that decide about ranges and collisions, by the module that uses them first.

Lengths are shares of the diagonal of the smaller part of a pair unless a unit is stated, so that an assembly of any
size answers the same. Where neither a reason nor a measurement is named the number is a choice.
"""

from __future__ import annotations

DEPTH_MEASURED = 16
"""So many are sooner measured than asked whether they are inside: 10 us each, or 1 ms for all. Either answer is the
same."""
