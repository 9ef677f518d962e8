"""Impacts of joints on end stops in runs with friction.

Friction of an effort that does not depend on loads has no impulse: at an impact the rates change as without it
(`stops`), and joints that stick begin to slip where the impact moves them. A joint that stays at its stop sticks there:
friction holds it up to its limit against what pulls it away, the stop carries what presses. What friction by load, and
gears that lose, do in an impact is not known: such runs end there, and say so.
"""

from __future__ import annotations

import numpy as np

from kinform.foundation.rounding import SOLVED
from kinform.model.arrays import Array
from kinform.simulation.mechanism.actuation import Stop
from kinform.simulation.solver.constants import MOST_EVENTS
from kinform.simulation.solver.sticking import Sticking, ways
from kinform.simulation.solver.stops import SLOW_REBOUND, impact_on, motions


def strike(state: Sticking, number: int, t: float) -> str:
    """The joint has reached the end stop `number`: it goes back, or rests there; "" or why that ends the run. Raises
    NotDeterminedError."""
    run, base, stop = state.run, state.base, state.base.stops[number]
    tables = run.dynamics.tables
    state.impacts += 1
    if state.impacts > MOST_EVENTS:
        return f"at t = {t:.6g} s {stop.joint} has struck its end stops {MOST_EVENTS} times"
    wrong = _shared(state, stop)
    if wrong:
        return f"at t = {t:.6g} s {stop.joint} reaches its end stop, and {wrong}"
    numbers = [*state.resting, *([number] if number not in state.resting else [])]
    stops = [base.stops[k] for k in numbers]
    state.let_all_go()
    q, v = tables.unpack(run.y)
    matrix = run.dynamics.mass_matrix(q)
    found = impact_on(motions(run.dynamics, q, base.free, run.rank(base.free)), matrix, v, stops)
    if found is None:
        return (
            f"at t = {t:.6g} s {stop.joint} reaches its end stop at {stop.limit:.6g} (rad or m), and what is "
            "prescribed goes on beyond it: change the law of motion or the stop"
        )
    change, after = found
    scale = run.dynamics.mechanism.scale
    size = float(np.abs(change / scale).max(initial=0.0))
    loaded = [one.joint for one in state.rubbings if one.lost is not None or one.loaded]
    if loaded and size > SLOW_REBOUND:
        return (
            f"at t = {t:.6g} s {stop.joint} strikes its end stop, and what the friction in {loaded[0]} does in an "
            "impact is not known, as it follows from the load: give it as an effort (effort = ...) to go on"
        )
    if stop.joint not in state.struck:
        state.struck.append(stop.joint)
        kept = f"leave {stop.restitution:g} of the speed" if stop.restitution else "are without rebound"
        run.notes.append(f"{stop.joint} reaches its end stop at t = {t:.6g} s; impacts {kept}, and friction has none")
    work = float(change @ matrix @ (v + 0.5 * change))
    run.y[-1] += work
    run.y[base.meter_of(stop.v) + 1] += work
    q[stop.q], v = stop.limit, v + change
    rounding = SOLVED * max(1.0, float(np.abs(after).max()))
    slow = bool(np.all(after > -SLOW_REBOUND))
    state.resting = [k for k, pace in zip(numbers, after, strict=True) if slow or pace >= -rounding]
    v[[base.stops[k].v for k in state.resting]] = 0.0
    v[np.abs(v / scale) <= SOLVED * size] = 0.0
    packed = tables.pack(q, v)
    run.y[: len(q) + len(v)] = packed[: len(q) + len(v)]
    state.begin(t)
    return ""


def _shared(state: Sticking, stop: Stop) -> str:
    """Why it is not known what rests at the stop: frictions in other joints stick with it; "" where it is."""
    run = state.run
    if any(one.v == stop.v for one in state.rubbings):
        return ""
    q = run.dynamics.tables.unpack(run.y)[0]
    rows = ways(run.dynamics, state.base, q, run.settings.free)
    (row,) = ways(run.dynamics, state.base, q, run.settings.free, [stop.v])
    size = float(np.linalg.norm(row)) or 1.0
    touched = [one.joint for one, other in zip(state.rubbings, rows, strict=True) if _along(row / size, other)]
    if not touched:
        return ""
    return (
        f"friction in {touched[0]}, which moves with it, would stick there: what both carry then is not simulated, "
        "unless the joint that strikes has friction of its own"
    )


def _along(unit: Array, row: Array) -> bool:
    return abs(float(unit @ row)) > SOLVED * float(np.linalg.norm(row))
