"""Where a simulation starts: stated positions and velocities, prescribed joints, closed loops."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.behaviour import JointComponent, one_freedom
from kinform.model.arrays import Array
from kinform.model.assembly import Assembly
from kinform.model.function import InitialValue
from kinform.model.kinematics import Kinematics
from kinform.simulation.mechanism.actuation import Actuation
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.solver.follow import Follower, Led
from kinform.simulation.solver.settings import SolverSettings

__all__ = ["Start", "Stated", "begin", "stated_values"]


OVERDRIVEN = (
    "drives and initial values state more than the loops leave free and contradict each other, "
    "or the mechanism starts in a singular pose (a dead point)"
)


LEAST = 1e-9
"""Relative: rates above this share of the greatest are motions."""


@dataclass(frozen=True)
class Stated:
    """A joint's stated start in kinform's sign (rad or m, per second): its indices and values."""

    name: str
    q: int
    v: int
    position: float
    velocity: float


@dataclass(frozen=True, eq=False)
class Start:
    """Positions and rates at time zero, and what was assumed; `problem` when they cannot be had."""

    q: Array
    v: Array
    notes: tuple[str, ...] = ()
    problem: tuple[str, str] | None = None


def stated_values(
    assembly: Assembly,
    kinematics: Kinematics,
    joints: Mapping[str, JointComponent],
    mechanism: Mechanism,
    values: tuple[InitialValue, ...],
) -> tuple[tuple[Stated, ...], tuple[tuple[str, str], ...]]:
    """The stated values of joints with one freedom, and (subject, why) of those that have no such joint."""
    slots = {slot.name: slot for slot in mechanism.slots}
    found: dict[str, Stated] = {}
    failures = []
    for value in values:
        joint, sign, why = one_freedom(assembly, kinematics, joints, value.joint)
        if joint is None:
            failures.append((value.joint, f"initial value: {why}"))
            continue
        if joint.subject in found:
            failures.append((value.joint, f'the joint "{joint.subject}" has two initial values'))
            continue
        unit = sign * (math.pi / 180.0 if joint.kind.coordinates[0][1] else value.metres_per_unit)
        if not (math.isfinite(value.position) and math.isfinite(value.velocity)):
            failures.append((value.joint, "its initial value is not a number"))
            continue
        slot = slots[joint.subject]
        found[joint.subject] = Stated(
            value.joint, slot.q.start, slot.v.start, unit * value.position, unit * value.velocity
        )
    return tuple(found.values()), tuple(failures)


def begin(
    mechanism: Mechanism,
    actuation: Actuation,
    stated: tuple[Stated, ...],
    settings: SolverSettings,
    *,
    coasting: bool,
) -> Start:
    """The start: prescribed joints where their laws put them, the others where stated, loops closed.

    From the pose of the meshes the joints are led there in a straight line, so that loops keep the
    assembly that they have in the meshes. `coasting`: joints that nothing drives may move, as in dynamics.
    """
    notes = _contradictions(actuation, stated)
    led = set(actuation.led.tolist())
    own = [value for value in stated if value.v not in led]
    places = [value for value in own if value.position != 0.0 or value.velocity == 0.0]
    target = np.concatenate([actuation.led_values(0.0), [value.position for value in places]])
    q_index = np.concatenate([actuation.led_q, np.array([p.q for p in places], dtype=np.int64)])
    v_index = np.concatenate([actuation.led, np.array([p.v for p in places], dtype=np.int64)])
    q = mechanism.start
    if np.any(target != 0.0):
        path = Led(q_index, v_index, lambda s: s * target, lambda s: target)
        follower = Follower(mechanism, path, q, settings)
        stop = follower.go(0.0, 1.0)
        if stop is not None:
            why = OVERDRIVEN if follower.overdriven else f"the loops cannot be brought there: {stop.reason}"
            return Start(q, np.zeros(mechanism.rates), notes, (_named(mechanism, v_index), f"initial positions: {why}"))
        q = follower.q
    moving = [value for value in own if value.velocity != 0.0]
    if moving and not coasting:
        names = ", ".join(sorted(value.name for value in moving))
        notes += (f"initial velocities of {names} play no part: without forces nothing keeps them going",)
        moving = []
    follower = Follower(mechanism, _pace(actuation, moving), q, settings)
    v = follower.rates(0.0)
    if _opens(follower, v):
        why = OVERDRIVEN if follower.overdriven else "the loops cannot move so"
        return Start(q, v, notes, (_named(mechanism, follower.led.v), f"initial velocities: {why}"))
    still = [value for value in own if value.velocity == 0.0 and value.v in follower.undetermined]
    if still:
        # joints whose velocity is stated or left at zero stay at rest where the loops allow it
        held = Follower(mechanism, _pace(actuation, [*moving, *still]), q, settings)
        rates = held.rates(0.0)
        if not held.overdriven and not _opens(held, rates):
            follower, v = held, rates
    if coasting:
        notes += _at_rest(mechanism, stated, led, q, v) + _least(mechanism, follower, v)
    return Start(q, v, notes)


def _at_rest(mechanism: Mechanism, stated: tuple[Stated, ...], led: set[int], q: Array, v: Array) -> tuple[str, ...]:
    """What begins at rest at the pose of the meshes because nobody said otherwise."""
    told = led | {value.v for value in stated}
    still = [
        slot.name
        for slot in mechanism.slots
        if slot.v.stop > slot.v.start
        and slot.v.start not in told
        and not v[slot.v].any()
        and np.array_equal(q[slot.q], mechanism.start[slot.q])
    ]
    return (f"no initial value is stated, so at rest at the pose of the meshes: {', '.join(still)}",) if still else ()


def _pace(actuation: Actuation, moving: Sequence[Stated]) -> Led:
    """The rates of the prescribed joints at time zero, and those that are stated."""
    speed = np.concatenate([actuation.led_rates(0.0), [value.velocity for value in moving]])
    return Led(
        np.concatenate([actuation.led_q, np.array([value.q for value in moving], dtype=np.int64)]),
        np.concatenate([actuation.led, np.array([value.v for value in moving], dtype=np.int64)]),
        lambda s: speed,
        lambda s: speed,
    )


def _opens(follower: Follower, v: Array) -> bool:
    """Whether loops open at the rates `v`, which are the follower's."""
    return follower.open_rates(0.0) > follower.settings.open * max(1.0, float(np.abs(v).max(initial=0.0)))


def _least(mechanism: Mechanism, follower: Follower, v: Array) -> tuple[str, ...]:
    """What loops share out between joints, and nothing that is stated decides how: a loose pin turns with either side."""
    rates = np.abs(v[follower.undetermined])
    moving = follower.undetermined[rates > LEAST * float(rates.max(initial=0.0))]
    if not len(moving):
        return ()
    return (
        "what is stated does not decide the initial velocities of these joints of loops, so the least are taken: "
        f"{_named(mechanism, moving)}",
    )


def _named(mechanism: Mechanism, rates: NDArray[np.int64]) -> str:
    """The joints whose values are given, as a list."""
    wanted = set(rates.tolist())
    return ", ".join(slot.name for slot in mechanism.slots if slot.v.start in wanted and slot.v.stop > slot.v.start)


def _contradictions(actuation: Actuation, stated: tuple[Stated, ...]) -> tuple[str, ...]:
    """Stated values of prescribed joints that their laws overrule."""
    notes = []
    values, rates = actuation.led_values(0.0), actuation.led_rates(0.0)
    for value in stated:
        for k in np.flatnonzero(actuation.led == value.v):
            wanted, law = (value.position, value.velocity), (values[k], rates[k])
            if not np.allclose(wanted, law, rtol=1e-9, atol=1e-12):
                notes.append(f"{value.name} starts where its motion law puts it, not at its initial value")
    return tuple(notes)
