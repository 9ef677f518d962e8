"""Takes a run across a singular pose in which branches of its motion cross exactly, where steps did not get across.

Near such a pose accelerations are 0/0: evaluated too near they are noise, and steps that shrink come ever nearer. But
the motion is smooth there. So it is followed backwards to where it is well known, three states and their slopes make a
polynomial, and that is followed to as far beyond the pose as the nearest state lies before it, and closed there.

Whether branches do cross is asked first: at the pose the polynomial would leave the loops open by ε where lengths are
off by ε. What is rounding is crossed; what is less than lengths are known is a doubt, and ends the run; what is more is
a corner that the motion turns indeed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from kinform.model.arrays import Array
from kinform.simulation.constants import (
    CROSSED_GAP,
    LEAP_ASTRAY,
    LEAP_MARGIN,
    LEAP_NODES,
    LEAP_TOLERANCE,
)
from kinform.simulation.kernel import layout
from kinform.simulation.solver.run_state import Run


def leap(run: Run) -> str | None:
    """Put the run beyond the singular pose ahead: None when it is there, "" where it is left as it is, else why it
    ends."""
    mechanism, now = run.dynamics.mechanism, float(run.clock[layout.NOW])
    if run.dynamics.actuation.stops or not mechanism.closed:
        return ""
    margin, pace = _margin(run, run.y), _pace(run)
    if not 0.0 < margin < LEAP_MARGIN or pace == 0.0:
        return ""
    before = now - margin / pace
    if before <= run.times[0]:
        return ""
    earlier = _states_before(run, [before])
    rise = (_margin(run, earlier[0]) - margin) / (now - before) if earlier else 0.0
    if not rise > 0.0:
        return ""
    pose, reach = now + margin / rise, LEAP_MARGIN / rise
    nodes = [pose - k * reach for k in range(1, LEAP_NODES + 1)]
    if nodes[-1] <= run.times[0] or pose + reach >= run.clock[layout.END]:
        return ""
    states = _states_before(run, nodes)
    if not states:
        return ""
    ahead = _polynomial(run, nodes, states, pose)
    gap = _gap(run, ahead(pose))
    if gap > CROSSED_GAP:
        return f"at t = {pose:.6g} s {mechanism.doubt()}{run.loops()}" if gap <= mechanism.uncertain else ""
    return None if _land(run, ahead, pose, reach) else ""


def _states_before(run: Run, times: Sequence[float]) -> list[Array]:
    """States at earlier times, descending: the motion followed backwards from the present, loops closed; none where it
    cannot be."""
    from scipy.integrate import solve_ivp

    def rates(t: float, y: Array) -> Array:
        dy = np.zeros_like(y)
        run.derivative(t, y.copy(), dy)
        return dy

    now = float(run.clock[layout.NOW])
    way = solve_ivp(
        rates, (now, times[-1]), run.y.copy(), "DOP853", t_eval=list(times), rtol=LEAP_TOLERANCE, atol=LEAP_TOLERANCE
    )
    if not way.success:
        return []
    states = [np.ascontiguousarray(y) for y in way.y.T]
    for t, y in zip(times, states, strict=True):
        run.project(t, y)
    return states


def _polynomial(run: Run, nodes: Sequence[float], states: Sequence[Array], pose: float) -> Callable[[float], Array]:
    """States by time, through those at the nodes with their slopes."""
    from scipy.interpolate import KroghInterpolator

    rows = []
    for t, y in zip(nodes, states, strict=True):
        dy = np.zeros_like(y)
        run.derivative(t, y.copy(), dy)
        rows += [y, dy]
    through = KroghInterpolator(np.repeat(nodes, 2) - pose, np.array(rows))
    return lambda t: np.ascontiguousarray(through(t - pose))


def _positions(run: Run, y: Array) -> Array:
    return run.dynamics.tables.unpack(y)[0]


def _margin(run: Run, y: Array) -> float:
    """How far the loops are from a singular pose for all rates: least singular value that counts over the largest."""
    mechanism, rank = run.dynamics.mechanism, run.dynamics.rank
    values = np.linalg.svd(mechanism.closure_at(_positions(run, y)) * mechanism.scale, compute_uv=False)
    return float(values[rank - 1] / values[0]) if rank else 1.0


def _pace(run: Run) -> float:
    """rad/s, and lengths a second: how fast the joints move."""
    rates = run.dynamics.tables.unpack(run.y)[1] / run.dynamics.mechanism.scale
    return float(np.linalg.norm(rates))


def _gap(run: Run, y: Array) -> float:
    """What is open in the row that is about to depend on the others (rad, shares of the length)."""
    mechanism, q = run.dynamics.mechanism, _positions(run, y)
    left, _, _ = np.linalg.svd(mechanism.closure_at(q) * mechanism.scale)
    return abs(float(left[:, run.dynamics.rank - 1] @ mechanism.gap(mechanism.poses(q), q)))


def _land(run: Run, ahead: Callable[[float], Array], pose: float, reach: float) -> bool:
    """Goes on beyond the pose, outputs on the way filled; False where the other side is not as it should be."""
    later = pose + reach
    landing = ahead(later)
    y = landing.copy()
    gap, _ = run.project(later, y)
    if not gap < run.settings.open or np.abs(y - landing).max() > LEAP_ASTRAY * max(1.0, float(np.abs(y).max())):
        return False
    if _margin(run, y) < 0.5 * LEAP_MARGIN:
        return False
    while run.tally[layout.NEXT] < len(run.times) and run.times[run.tally[layout.NEXT]] <= later:
        k = int(run.tally[layout.NEXT])
        run.sample(float(run.times[k]), ahead(float(run.times[k])), run.out[k])
        run.tally[layout.NEXT] += 1
    run.y[:] = y
    run.clock[layout.NOW], run.clock[layout.STEP] = later, reach
    run.clock[layout.MARGIN], run.clock[layout.TIGHTEST] = 0.0, pose
    run.tally[layout.FRESH], run.tally[layout.STIFF] = 1, 0
    run.choose()
    return True
