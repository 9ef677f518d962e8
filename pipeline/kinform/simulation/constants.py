"""Constants of the simulation: every number that decides something and that no user sets (`SolverSettings` has those).

Gaps of loops are in rad and in shares of the mechanism's length; a margin is the smallest pivot of the loops over the
largest, 0 in a singular pose. The kernel's functions are compiled with the values of these numbers in them:
`kernel.compiled` compiles afresh where one has changed.
"""

from __future__ import annotations

STOP_PASSED = 1e-12
"""rad or m beyond a limit that is passed: less is rounding."""
STOP_HALVINGS = 60
"""Halvings of a step to find where a stop is passed: to the last bit of its share."""
LEAST_DRIFT = 1e-12
"""J: drift of the energy that is rounding."""
UNDETERMINED_SHARE = 1e-6
"""A component of a wrench that the choice of λ changes by more than this share of itself is not determined."""
DEPENDENT_GEARS = 1e-12
"""Share of the greatest singular value of the gears' rows below which one depends on the others."""
