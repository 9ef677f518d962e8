"""Four levels of rounding, from the guard of a division to the resolution of a mesh file.

Where a number decides only whether something is zero but for rounding, it is one of these, as a share of the size of
what is compared. A number that decides anything else has its own name, in the module that uses it, with its reason;
also one that is stricter than these because it asks for the last bits of a single operation.
"""

from __future__ import annotations

TINY = 1e-300
"""Added to or compared with divisors, so that nothing is divided by zero. The least normal double is 2.2e-308."""
ARITHMETIC = 1e-12
"""Rounding of a few operations in double precision: some thousand times the spacing of doubles, 2.2e-16."""
SOLVED = 1e-9
"""Rounding of what is solved for: `ARITHMETIC` grown by a condition of some hundreds to thousands, as systems, roots of
small differences and iterations that have converged have it. A thousandth of it is `ARITHMETIC`, a thousand times it
`SINGLE`: the middle between the two."""
SINGLE = 1e-6
"""Rounding of numbers that went through a file in single precision, as those of STL: some ten times the spacing of
single floats, 1.2e-7, which sums and differences of a few coordinates reach."""
