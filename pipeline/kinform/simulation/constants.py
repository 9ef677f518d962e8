"""Numbers that several parts of the simulation share; what a user may set is in `SolverSettings`.

Gaps of loops are in rad and in shares of the mechanism's length. A margin is the smallest pivot of the loops over the
largest: 0 in a singular pose. The kernel's functions are compiled with the values of these numbers in them:
`kernel.compiled` compiles afresh where one has changed.
"""

from __future__ import annotations

HALVINGS = 52
"""Bisections of a step to find an event in it: 2^-52 of it is the last bit of its share."""
STEP_PARTS = 4
"""Parts of a step at whose ends events are looked for. Steps at the default tolerances are far shorter than a period of
what moves (0.09 s of 2 s, of a pendulum), so that a quantity changes its sign at most once in a part; laws that swing
faster shorten them (`solver.stops.Contact.longest`)."""
CHUNK = 128
"""Output times whose matrices are held at once: 80 kB each for a hundred rates, so about 10 MB."""
