"""Takes a run across a singular pose in which branches of its motion cross exactly, where steps did not get across.

Near such a pose accelerations are 0/0: evaluated too near they are noise, and steps that shrink come ever nearer. But
the motion is smooth there. So it is followed backwards to as far before the pose as one step of collocation reaches
beyond it (`collocation`). Too short a step has its stages in the noise, too long a one leaves more out: steps of
several lengths are made, each with two numbers of stages, and taken is the first in which both agree to rounding, or
that in which they agree best. Where none agrees well enough, the run is left as it is. So nothing larger than these
errors hangs on which steps came before, and on last bits.

Whether branches do cross is asked too: at the pose the polynomial would leave the loops open by ε where lengths are off
by ε. What is rounding is crossed; what is less than lengths are known is a doubt, and ends the run; what is more is a
corner that the motion turns indeed.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kinform.foundation.rounding import ARITHMETIC
from kinform.model.arrays import Array
from kinform.simulation.kernel import layout
from kinform.simulation.solver.collocation import Passage, pass_over, places_of
from kinform.simulation.solver.constants import MOST_ROUNDS
from kinform.simulation.solver.run_state import Run

CROSSING_MARGIN = 0.02
"""Margin, by singular values, below which a singular pose may be ahead; and below which rows of the loops are about to
depend on others: a choice."""
CROSSING_REACHES = (0.025, 0.05, 0.1, 0.2, 0.4)
"""How far a step reaches from the pose to either side, tried from the first on: rad, or lengths, that the fastest joint
moves. The error of the stages' slopes goes with the inverse square of it, what the polynomial leaves out with its
twelfth power; for chains of 2 to 40 four-bars the first that are tried agree to 1e-12."""
CROSSING_COARSE, CROSSING_FINE = 6, 8
"""Stages of the two steps that are compared: even, as none may lie in the middle."""
CROSSING_ERROR = 1e-8
"""Difference beyond which the run is left as it is: what a run of ten seconds gathers at the default tolerance."""
CROSSING_NEARER = 100.0
"""A step that errs so many times as much as one that is shorter is too long, and longer ones are not tried: twice as
long leaves out 2^12 times as much. A choice."""


def cross_singular_pose(run: Run) -> str | None:
    """Put the run beyond the singular pose ahead: None when it is there, "" where it is left as it is, else why it
    ends."""
    mechanism = run.dynamics.mechanism
    if not mechanism.closed or run.dynamics.tables.ints[layout.STOPS][:, layout.HELD].any():
        return ""
    pose = _pose_ahead(run)
    if pose is None:
        return ""
    best: tuple[float, Passage] | None = None
    for passage, error in _passages(run, pose):
        if best is None or error < best[0]:
            best = error, passage
        elif error > CROSSING_NEARER * best[0]:
            break
        if best[0] < ARITHMETIC:  # a hundredth of the tolerance of a step
            break
    run.choose()
    if best is None or best[0] > CROSSING_ERROR:
        return ""
    gap = _gap(run, best[1].state_at(0.5))
    if gap > ARITHMETIC:
        return f"at t = {pose:.6g} s {mechanism.doubt()}{run.loops()}" if gap <= mechanism.uncertain else ""
    _land(run, best[1])
    return None


def _pose_ahead(run: Run) -> float | None:
    """When (s) the margin, which falls like one side of a V, comes to nothing; None where it does not."""
    now, pace = float(run.clock[layout.NOW]), _pace(run, run.y)
    margin, at = _margin(run, run.y), run.y
    if not 0.0 < margin < CROSSING_MARGIN or pace == 0.0:
        return None
    # First a look at how fast it falls, and with that one from twice as far, where it is known better.
    pose, before = now, now - margin / pace
    for _ in range(2):
        if before <= run.times[0]:
            return None
        earlier = _back(run, now, at, before)
        rise = _margin(run, earlier) - margin if earlier is not None else 0.0
        if not rise > 0.0:
            return None
        pose = now + margin * (now - before) / rise
        before = now - (pose - now)
    return pose


def _passages(run: Run, pose: float) -> Iterator[tuple[Passage, float]]:
    """Steps across the pose, one longer than the other, with their errors."""
    t, y = float(run.clock[layout.NOW]), run.y
    unit = 1.0 / max(_pace(run, y), np.sqrt(_pull(run, t, y)))
    for reach in (share * unit for share in CROSSING_REACHES):
        begin, end = pose - reach, pose + reach
        if begin > t - 0.5 * (pose - t):
            # Too near: a step begins at least half as far again before the pose as the run has come to.
            continue
        if begin <= run.times[0] or end >= run.clock[layout.END]:
            return
        state = _back(run, t, y, begin)
        if state is None:
            return
        t, y = begin, state
        run.dynamics.place(*run.dynamics.tables.unpack(y))
        coarse = pass_over(run, y, begin, end - begin, np.repeat(_slope(run, t, y)[None], CROSSING_COARSE, axis=0))
        fine = None
        if coarse is not None:
            fine = pass_over(run, y, begin, end - begin, coarse.slopes_at(places_of(CROSSING_FINE)))
        if coarse is None or fine is None or not _goes_straight(run, fine) or _stopped(run, fine):
            continue
        yield fine, float(np.max(np.abs(fine.end - coarse.end) / np.maximum(1.0, np.abs(fine.end))))


def _back(run: Run, now: float, y: Array, time: float) -> Array | None:
    """The state at an earlier time, loops closed: the motion followed backwards from y at `now`."""
    from scipy.integrate import DOP853

    made = 0

    def rates(t: float, y: Array) -> Array:
        nonlocal made
        made += 1
        return _slope(run, t, y)

    with np.errstate(all="ignore"):
        way = DOP853(rates, now, y.copy(), time, rtol=ARITHMETIC, atol=ARITHMETIC)
        while way.status == "running" and made < MOST_ROUNDS:
            way.step()
    if way.status != "finished":
        return None
    state = np.ascontiguousarray(way.y)
    gap, _ = run.project(time, state)
    return state if 0.0 <= gap < run.settings.open else None


def _slope(run: Run, t: float, y: Array) -> Array:
    slope = np.zeros_like(y)
    run.derivative(t, y.copy(), slope)
    return slope


def _positions(run: Run, y: Array) -> Array:
    return run.dynamics.tables.unpack(y)[0]


def _scaled_rows(run: Run, y: Array) -> Array:
    mechanism = run.dynamics.mechanism
    return np.asarray(mechanism.closure_at(_positions(run, y)) * mechanism.scale)


def _margin(run: Run, y: Array) -> float:
    """How far the loops are from a singular pose for all rates: least singular value that counts over the largest."""
    rank = run.dynamics.rank
    values = np.linalg.svd(_scaled_rows(run, y), compute_uv=False)
    return float(values[rank - 1] / values[0]) if rank else 1.0


def _pace(run: Run, y: Array) -> float:
    """rad/s, and lengths a second, of the fastest joint in the state y; of a slope, what its rates change by."""
    return float(np.abs(run.dynamics.tables.unpack(y)[1] / run.dynamics.mechanism.scale).max(initial=0.0))


def _pull(run: Run, t: float, y: Array) -> float:
    """rad/s², and lengths a second²: how fast the rates change."""
    return _pace(run, _slope(run, t, y))


def _gap(run: Run, y: Array) -> float:
    """What is open in the rows that are about to depend on the others (rad, shares of the length)."""
    mechanism, q, rank = run.dynamics.mechanism, _positions(run, y), run.dynamics.rank
    left, values, _ = np.linalg.svd(_scaled_rows(run, y))
    loose = left[:, :rank][:, values[:rank] < CROSSING_MARGIN * values[0]]
    return float(np.abs(loose.T @ mechanism.gap(mechanism.poses(q), q)).max(initial=0.0))


def _goes_straight(run: Run, passage: Passage) -> bool:
    """Whether what was the least singular value has changed its sign: a motion that turns back leaves it."""
    left, values, right = np.linalg.svd(_scaled_rows(run, passage.start))
    k = run.dynamics.rank - 1
    after = float(left[:, k] @ _scaled_rows(run, passage.end) @ right[k])
    # Share of itself that the least singular value must have as its negative behind the pose: straight on it has all,
    # turned back none. A choice.
    return after < -0.1 * float(values[k])


def _stopped(run: Run, passage: Passage) -> bool:
    """Whether an end stop is in the way."""
    stops = run.dynamics.actuation.stops
    places = (*places_of(len(passage.slopes)), 1.0) if stops else ()
    values = [_positions(run, passage.state_at(place)) for place in places]
    return any(stop.sense * (q[stop.q] - stop.limit) > ARITHMETIC for q in values for stop in stops)


def _land(run: Run, passage: Passage) -> None:
    """Goes on from the end of the passage, outputs on the way filled."""
    later = passage.begin + passage.span
    while run.tally[layout.NEXT] < len(run.times) and run.times[run.tally[layout.NEXT]] <= later:
        k = int(run.tally[layout.NEXT])
        place = (float(run.times[k]) - passage.begin) / passage.span
        run.sample(float(run.times[k]), passage.state_at(place), run.out[k])
        run.tally[layout.NEXT] += 1
    run.y[:] = passage.end
    run.clock[layout.NOW], run.clock[layout.STEP] = later, 0.5 * passage.span
    run.clock[layout.MARGIN], run.clock[layout.TIGHTEST] = 0.0, passage.begin + 0.5 * passage.span
    run.tally[layout.FRESH], run.tally[layout.STIFF] = 1, 0
    run.choose()
