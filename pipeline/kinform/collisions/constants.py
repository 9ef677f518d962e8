"""Numbers that several sub-packages of the collisions share.

Lengths are shares of the diagonal of the smaller part of a pair unless a unit is stated, here and in all modules of
this package, so that an assembly of any size answers the same.
"""

from __future__ import annotations

DEPTH_MEASURED = 16
"""So many are sooner measured than asked whether they are inside: 10 us each, or 1 ms for all. Either answer is the
same."""
