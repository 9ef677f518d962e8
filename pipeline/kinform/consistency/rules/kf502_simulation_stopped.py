"""The simulation ended before its time.

Why it matters: the mechanism cannot follow the motion that is asked of it: it reaches a singular pose, a
loop that cannot close, or a motion without end.

What to do: look at the time and the joints given; shorten the stroke, or change the lengths.

Example: a slider-crank whose rod is shorter than its crank jams at t = 0.31 s.
"""

from __future__ import annotations

from kinform.consistency.context import Context
from kinform.consistency.outcome import Outcome, decided
from kinform.consistency.rule import Rule
from kinform.foundation.words import number
from kinform.model.findings import computed


def check(context: Context) -> Outcome:
    """A run that stopped early."""
    simulation = context.simulation
    if simulation.status != "stopped":
        return decided()
    request = context.assembly.simulation
    reached = float(simulation.time[-1]) if len(simulation.time) else 0.0
    duration = f"{number(request.duration)} s" if request is not None else None
    finding = RULE.finding(
        (context.assembly.name,),
        f"the simulation stopped at t = {number(reached)} s"
        + (f" of {duration}" if duration else "")
        + f": {simulation.reason}",
        found=f"{number(reached)} s",
        intended=duration,
        declared=request if request is not None and request.file is not None else context.assembly.source,
        remedy="Shorten the motion, or correct the joints that are named.",
        witness=None
        if request is None
        else computed("time of a run", request.duration - reached, 0.0, duration=request.duration),
    )
    return decided([finding])


RULE = Rule("KF502", "simulation-stopped", "error", __doc__, check, needs=("simulation",))
