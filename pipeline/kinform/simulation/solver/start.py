"""Where a simulation starts: stated positions and velocities, prescribed joints, closed loops, and what stands in the
way of a motion from there."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from kinform.foundation.name_hints import first_names
from kinform.foundation.rounding import ARITHMETIC, SINGLE, SOLVED
from kinform.frozen import dataclass
from kinform.mechanism.rank import Factor, factor, rank_of
from kinform.model.arrays import Array, Flags, Ints
from kinform.simulation.mechanism.actuation import Actuation
from kinform.simulation.mechanism.closure import closed
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.mechanism.states import gaps_at, poses_at
from kinform.simulation.settings import SolverSettings
from kinform.simulation.solver.continuation import Follower, Led

START_SHARE = 0.03
"""Of a motion (rad, or lengths) from the start that shows whether the loops bear it: a choice, so long that what opens
them stands out from rounding, so short that Newton closes what does not."""


OVERDRIVEN = (
    "drives and initial values state more than the loops leave free and contradict each other, "
    "or the mechanism starts in a singular pose (a dead point)"
)

RIGID = "the loops leave no freedom here, as `kinform show F.h5 mobility` has it, and a motion is asked for"


@dataclass(frozen=True)
class Stated:
    """A joint's stated start in kinform's sign (rad or m, per second): its indices and values."""

    name: str
    q: int
    v: int
    position: float
    velocity: float
    solved: bool = False
    """The position is not stated: loops give it."""


@dataclass(frozen=True, eq=False)
class Start:
    """Positions and rates at time zero, and what was assumed; `problem` when they cannot be had."""

    q: Array
    v: Array
    notes: tuple[str, ...] = ()
    problem: tuple[str, str] | None = None


def begin(
    mechanism: Mechanism, actuation: Actuation, stated: tuple[Stated, ...], settings: SolverSettings, *, coasting: bool
) -> Start:
    """The start: prescribed joints where their laws put them, the others where stated, loops closed.

    From the pose of the meshes the joints are led there in a straight line, so that loops keep the
    assembly that they have in the meshes. `coasting`: joints that nothing drives may move, as in dynamics.
    """
    notes = _contradictions(actuation, stated)
    led = set(actuation.led.tolist())
    loose = [value for value in stated if value.v not in led]
    places = [value for value in loose if not value.solved and (value.position != 0.0 or value.velocity == 0.0)]
    target = np.concatenate([actuation.led_values(0.0), [value.position for value in places]])
    q = mechanism.start
    if np.any(target != 0.0):
        path = _led(actuation, places, lambda s: s * target, lambda s: target)
        follower = Follower(mechanism, path, q, settings)
        stop = follower.go(0.0, 1.0)
        if stop is not None:
            why = OVERDRIVEN if follower.overdriven else f"the loops cannot be brought there: {stop.reason}"
            why = RIGID if _rigid(mechanism, q, settings) else why
            names = ", ".join(mechanism.joints_of(path.v))
            return Start(q, np.zeros(mechanism.rates), notes, (names, f"initial positions: {why}"))
        q = follower.q
    notes += tuple(
        f"{value.name} starts at {q[value.q]:.6g} (rad or m, as kinform counts it), as the loops have it closest to "
        "the pose of the meshes"
        for value in loose
        if value.solved
    )
    moving = [value for value in loose if value.velocity != 0.0]
    if moving and not coasting:
        names = ", ".join(sorted(value.name for value in moving))
        notes += (f"initial velocities of {names} play no part: without forces nothing keeps them going",)
        moving = []
    follower = Follower(mechanism, _led_rates(actuation, moving), q, settings)
    v = follower.rates(0.0)
    if _opens(follower, v):
        why = OVERDRIVEN if follower.overdriven else "the loops cannot move so"
        why = RIGID if _rigid(mechanism, q, settings) else why
        return Start(q, v, notes, (", ".join(mechanism.joints_of(follower.led.v)), f"initial velocities: {why}"))
    still = [value for value in loose if value.velocity == 0.0 and value.v in follower.undetermined]
    if still:
        # joints whose velocity is stated or left at zero stay at rest where the loops allow it
        held = Follower(mechanism, _led_rates(actuation, [*moving, *still]), q, settings)
        rates = held.rates(0.0)
        if not held.overdriven and not _opens(held, rates):
            follower, v = held, rates
    if coasting:
        notes += _notes_of_rest(mechanism, stated, led, q, v) + _notes_of_least(mechanism, follower, v)
    return Start(q, v, notes)


def _rigid(mechanism: Mechanism, q: Array, settings: SolverSettings) -> bool:
    """Whether nothing can move there: of all joints that loops tie together, and there are no others."""
    rows = mechanism.closure_at(q)
    return bool(rank_of(rows, mechanism.scale, settings.free) == mechanism.rates)


def _notes_of_rest(
    mechanism: Mechanism, stated: tuple[Stated, ...], led: set[int], q: Array, v: Array
) -> tuple[str, ...]:
    """What begins at rest at the pose of the meshes because nobody said otherwise."""
    stated_rates, start = led | {value.v for value in stated}, mechanism.start
    still = [
        slot.name
        for slot in mechanism.slots
        if slot.v.stop > slot.v.start
        and stated_rates.isdisjoint(range(slot.v.start, slot.v.stop))
        and not v[slot.v].any()
        and np.array_equal(q[slot.q], start[slot.q])
    ]
    return (f"no initial value is stated, so at rest at the pose of the meshes: {', '.join(still)}",) if still else ()


def _led_rates(actuation: Actuation, moving: Sequence[Stated]) -> Led:
    """The rates of the prescribed joints at time zero, and those that are stated."""
    speed = np.concatenate([actuation.led_rates(0.0), [value.velocity for value in moving]])
    return _led(actuation, moving, lambda s: speed, lambda s: speed)


def _led(
    actuation: Actuation, stated: Sequence[Stated], value: Callable[[float], Array], rate: Callable[[float], Array]
) -> Led:
    """The prescribed joints and these, led by such values and rates."""
    q, v = (np.array([getattr(joint, key) for joint in stated], dtype=np.int64) for key in ("q", "v"))
    return Led(np.concatenate([actuation.led_q, q]), np.concatenate([actuation.led, v]), value, rate)


def _opens(follower: Follower, v: Array) -> bool:
    """Whether loops open at the rates `v`, which are the follower's."""
    return follower.open_rates(0.0) > follower.settings.open * max(1.0, float(np.abs(v).max(initial=0.0)))


def _notes_of_least(mechanism: Mechanism, follower: Follower, v: Array) -> tuple[str, ...]:
    """What loops share out between joints, and nothing that is stated decides how: a loose pin turns with either."""
    rates = np.abs(v[follower.undetermined])
    moving = follower.undetermined[rates > SOLVED * float(rates.max(initial=0.0))]
    if not len(moving):
        return ()
    return (
        "what is stated does not decide the initial velocities of these joints of loops, so the least are taken: "
        f"{', '.join(mechanism.joints_of(moving))}",
    )


def _contradictions(actuation: Actuation, stated: tuple[Stated, ...]) -> tuple[str, ...]:
    """Stated values of prescribed joints that their laws overrule."""
    notes = []
    values, rates = actuation.led_values(0.0), actuation.led_rates(0.0)
    for value in stated:
        for k in np.flatnonzero(actuation.led == value.v):
            wanted, law = (value.position, value.velocity), (values[k], rates[k])
            wanted = (law[0], wanted[1]) if value.solved else wanted
            if not np.allclose(wanted, law, rtol=SOLVED, atol=ARITHMETIC):
                notes.append(f"{value.name} starts where its motion law puts it, not at its initial value")
    return tuple(notes)


def loop_rank(mechanism: Mechanism, actuation: Actuation, start: Start, settings: SolverSettings) -> tuple[str, int]:
    """Why the drives cannot be followed ("" when they can), and the rank of the loops without them."""
    rows = mechanism.closure_at(start.q)
    free, scale = actuation.free, mechanism.scale
    rank = rank_of(rows[:, free], scale[free], settings.free)
    if rank == rank_of(rows, scale, settings.free):
        return "", rank
    ties = "the loops and couplings" if len(mechanism.gear_v) else "the loops"
    return (
        f"{ties} leave these drives no freedom at the start: there are too many of them, "
        "or the mechanism starts in a singular pose",
        rank,
    )


def torn_at_start(mechanism: Mechanism, actuation: Actuation, start: Start, rank: int, settings: SolverSettings) -> str:
    """Joints that seem free to move at the start, but tear the loops when they do; "" when none does."""
    free = actuation.free
    held = factor(mechanism.closure_at(start.q)[:, free], mechanism.scale[free], rank)
    if not mechanism.closed or not held.null.shape[1]:
        return ""
    # Each motion alone, and all at once: where branches meet, their sum lies on none.
    motions = np.vstack([held.null.T, held.null.sum(axis=1)])
    steps = np.zeros((len(motions), mechanism.rates))
    steps[:, free] = START_SHARE * motions / np.abs(motions / mechanism.scale[free]).max(axis=1)[:, None]
    moved = np.array([mechanism.advance(start.q, step) for step in steps])
    # Share of the square of that motion: loops that stay open by more do not bear it. The curvature of a motion that
    # they bear opens them by about its square, and Newton closes that.
    most = 0.01 * START_SHARE**2
    for k in np.flatnonzero(~_bear(mechanism, moved, free, held, most, settings.newton)):
        motion = motions[k]
        if closed(mechanism, moved[k], free, rank).residual[0] > most:
            moving = free[np.abs(motion) > SINGLE * np.abs(motion).max()]
            return first_names(mechanism.joints_of(moving))
    return ""


def _bear(mechanism: Mechanism, moved: Array, free: Ints, held: Factor, most: float, steps: int) -> Flags:
    """(K,) whether the loops at positions (K, nq) close to within `most` by steps of the `held` derivative, that of the
    start: all at once, so that what bears its motions need not be looked at one by one. Such steps undo no motion."""
    q, before = moved.copy(), np.full(len(moved), np.inf)
    going = np.arange(len(moved))
    for _ in range(steps):
        gaps = gaps_at(mechanism, poses_at(mechanism, q[going]), q[going])
        size = np.abs(gaps).max(axis=1)
        better = size < before[going]
        before[going] = np.minimum(size, before[going])
        on = better & (size > most)
        going, gaps = going[on], gaps[on]
        if not len(going):
            break
        for k, gap in zip(going, gaps, strict=True):
            step = np.zeros(mechanism.rates)
            step[free] = -held.solve(gap)
            q[k] = mechanism.advance(q[k], step)
    return np.asarray(before <= most)
