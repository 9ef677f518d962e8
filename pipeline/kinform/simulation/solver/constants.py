"""Numbers that several modules of `simulation.solver` share."""

from __future__ import annotations

LOOK = 250
"""Steps after which a run is looked at for stiffness. The derivatives by fifty numbers of a state take a hundred
evaluations, beside 3,000 of so many steps."""
LAW_PARTS = 8.0
"""Parts of half a period of a law that a step may be as long as while a stop holds: in longer ones push turns to pull
and back unseen."""
MOST_EVENTS = 1000
"""Impacts in one run, and times that vibrations are damped in it, before it counts as endless: a choice."""
MOST_ROUNDS = 2000
"""Iterations and evaluations before one is given up. The fixed point of friction reaches rounding in so many at a
growth of 0.98 a round; ordinary joints take under ten, a way back from a singular pose a hundred evaluations."""
CONVERGED = 1e-15
"""Relative change of an iteration at which it ends: a few last bits, below which it only moves to and fro."""
