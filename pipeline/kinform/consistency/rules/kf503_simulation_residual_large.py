"""The loops of the mechanism do not stay closed during the simulation.

A finding when the largest residual exceeds a millionth of the assembly's size (or 1e-6 rad).

Why it matters: the trajectory is then not a motion of this mechanism.

What to do: report it; it is a fault of the solver or of nearly singular geometry, not of the manifest.

Example: a four-bar near its dead point whose coupler drifts off its pin by 0.1 mm.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.comparisons.plausibility import extent
from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import number
from kinform.model.findings import computed

LOOP_RESIDUAL = 1e-6
"""Residual relative to the size of the assembly (m), and absolute (rad): a micrometre in a
metre. Chosen, not measured."""


def check(context: Context) -> Outcome:
    """The greatest constraint residual of the run."""
    simulation = context.simulation
    residual = simulation.residual
    if not len(residual):
        return skipped("nothing was simulated")
    if not np.isfinite(residual).all():
        return inconclusive("the residual of the constraints was not recorded at every time")
    worst = int(np.argmax(residual))
    limit = LOOP_RESIDUAL * min(1.0, extent(context.assembly) or 1.0)
    if float(residual[worst]) <= limit:
        return decided(reason=f"largest residual {number(float(residual[worst]), 2)}")
    finding = RULE.finding(
        (context.assembly.name,),
        f"the constraints are violated by {number(float(residual[worst]), 3)} (m or rad) "
        f"at t = {number(float(simulation.time[worst]))} s",
        found=number(float(residual[worst]), 3),
        intended=f"at most {number(limit, 3)}",
        declared=context.assembly.source,
        remedy="Shorten the output step, and report the case: the trajectory cannot be trusted.",
        witness=computed("closing of loops", float(residual[worst]), limit, output=worst),
    )
    return decided([finding])


RULE = Rule("KF503", "simulation-residual-large", "error", __doc__, check, needs=("simulation",))
