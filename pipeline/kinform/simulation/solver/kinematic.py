"""Motion without forces: prescribed joints lead, loops stay closed, everything else rests."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array
from kinform.simulation.mechanism.actuation import Actuation
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.record import Record
from kinform.simulation.settings import Conduct, SolverSettings
from kinform.simulation.solver.continuation import Follower, Led
from kinform.simulation.solver.start import Start


def _follower(mechanism: Mechanism, actuation: Actuation, start: Start, settings: SolverSettings) -> Follower:
    led = Led(actuation.led_q, actuation.led, actuation.led_values, actuation.led_rates)
    return Follower(mechanism, led, start.q, settings)


def run_kinematic(mechanism: Mechanism, actuation: Actuation, start: Start, times: Array, conduct: Conduct) -> Record:
    """Positions, rates and accelerations at `times` (s), until the end or until a loop stops."""
    follower = _follower(mechanism, actuation, start, conduct.settings)
    q = np.zeros((len(times), len(start.q)))
    v, a = (np.zeros((len(times), mechanism.rates)) for _ in range(2))

    def record(done: int, stopped: str) -> Record:
        unknown = np.full((done, mechanism.rates), np.nan)
        return Record(
            time=times[:done], q=q[:done], v=v[:done], acceleration=a[:done], effort=unknown, needed=unknown,
            extra=np.zeros((done, 0)), work=np.full(done, np.nan), stopped=stopped,
        )  # fmt: skip

    for k, t in enumerate(times):
        if k:
            stop = follower.go(float(times[k - 1]), float(t))
            if stop is not None:
                return record(k, f"at t = {stop.place:.6g} s {stop.reason}")
        q[k], v[k] = follower.q, follower.rates(float(t))
        a[k] = follower.accelerations(v[k], actuation.led_accelerations(float(t)))
        if conduct.progress is not None:
            conduct.progress(k + 1, len(times))
    return record(len(times), "")


def notes_of_rest(mechanism: Mechanism, actuation: Actuation, start: Start, settings: SolverSettings) -> Iterator[str]:
    """What is assumed of joints that no motion drive determines, in sentences."""
    follower = _follower(mechanism, actuation, start, settings)
    scale = mechanism.scale[follower.unknown]
    size = np.abs(follower.loose / scale[:, None]).max(axis=1, initial=0.0)
    loose = set(follower.unknown[size > SOLVED].tolist())
    closing = np.abs(mechanism.closure_at(start.q)).max(axis=0, initial=0.0) > 0.0
    still: list[str] = []
    yielding: list[str] = []
    for slot in mechanism.slots:
        rates = [k for k in range(slot.v.start, slot.v.stop) if k in loose]
        if rates:
            (yielding if closing[rates].any() else still).append(slot.name)
    if still:
        yield f"what no drive prescribes stays at its initial position: {', '.join(still)}"
    if yielding:
        yield (
            f"the drives do not determine the loops with {', '.join(yielding)}: "
            "they move as little as keeps the loops closed"
        )
