"""Energy appears or disappears in a dynamic simulation.

Kinetic plus potential energy minus the work of drives and loads must stay constant. A finding when it
drifts by more than a thousandth of the energy that is exchanged.

Why it matters: the motion and the torques are then inaccurate.

What to do: report it; it is a fault of the solver, or of mass properties that are nearly singular.

Example: a pendulum that swings 2 % higher after ten periods.
"""

from __future__ import annotations

import numpy as np

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided, inconclusive, skipped
from kinform.consistency.rule import Rule
from kinform.foundation.words import number

ENERGY_DRIFT = 1e-3
"""Drift relative to the energy exchanged. Chosen, not measured: a simulation is to be right to three digits."""
ENERGY_SOLVED = 1e-6
"""Share of the greatest kinetic energy that solving leaves: output times may catch the motion where nothing is
exchanged."""
NO_ENERGY = 1e-15
"""Energy exchanged (J) below which there is nothing to compare. Chosen, not measured: a milligram at
0.04 mm/s has as much."""


def check(context: Context) -> Outcome:
    """Drift of the energy balance."""
    simulation = context.simulation
    if simulation.level != "dynamic" or not len(simulation.energy):
        return skipped("no dynamic simulation was run")
    if not np.isfinite(simulation.energy).all():
        return inconclusive("the energy was not recorded at every time")
    balance = simulation.energy @ np.array([1.0, 1.0, -1.0])
    drift = np.abs(balance - balance[0])
    exchanged = float(np.ptp(simulation.energy, axis=0).max())
    worst = int(np.argmax(drift))
    rounding = ENERGY_SOLVED * float(simulation.energy[:, 0].max())
    if float(drift[worst]) <= max(ENERGY_DRIFT * exchanged, rounding, NO_ENERGY):
        return decided(reason=f"drift {number(float(drift[worst]), 2)} J of {number(exchanged, 3)} J exchanged")
    finding = RULE.finding(
        (context.assembly.name,),
        f"the energy balance is off by {number(float(drift[worst]), 3)} J "
        f"at t = {number(float(simulation.time[worst]))} s, of {number(exchanged, 3)} J exchanged",
        found=f"{number(float(drift[worst]), 3)} J",
        intended=f"at most {number(ENERGY_DRIFT * exchanged, 3)} J",
        declared=context.assembly.source,
        remedy="Check the mass properties, and report the case.",
    )
    return decided([finding])


RULE = Rule("KF504", "energy-not-balanced", "warning", __doc__, check, needs=("simulation",))
