"""What each drive did in a dynamic run: effort, its root mean square, power. For motion drives this is
the inverse dynamics: what a motor must give."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from kinform.model.arrays import Array
from kinform.model.simulation import DriveUse
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.actuation import Acts
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.solver.record import Record

_KINDS = {
    layout.EFFORT: "effort", layout.SPRING: "spring", layout.DAMPER: "damper", layout.SERVO: "servo",
    layout.MOTOR: "dc_motor", layout.CONTROLLED: "dc_motor",
}  # fmt: skip


def drive_fields(dynamics: Dynamics, record: Record) -> dict[str, Any]:
    """What the drives did at the output times, prescribed motions first, as fields of the results."""
    if not len(record.time):
        return {}
    acted = list(_acted(dynamics, record))
    on = _rates(dynamics.mechanism)
    uses = tuple(_use(record.time, on[v], kind, effort, record.v[:, v]) for v, kind, effort in acted)
    efforts = np.array([effort for _, _, effort in acted]).reshape(len(acted), len(record.time)).T
    return {"drives": uses, "drive_effort": efforts, "drive_speed": record.v[:, [v for v, _, _ in acted]]}


def _acted(dynamics: Dynamics, record: Record) -> Iterator[tuple[int, str, Array]]:
    """The rate, kind and (T,) effort of each drive."""
    actuation = dynamics.actuation
    stops = {stop.v for stop in actuation.stops}
    for v in sorted({*actuation.led.tolist(), *stops}):
        kind = "stop" if v in stops and v not in actuation.led else "motion"
        yield v, kind, record.needed[:, v]
    states = 0
    for actor in actuation.actors:
        columns = [
            record.extra[:, states + sum(actor.states[:k])] if has else None for k, has in enumerate(actor.states)
        ]
        states += sum(actor.states)
        if actor.friction >= 0 and record.friction is not None:
            yield actor.v, "friction", record.friction.effort[:, actor.friction]
        else:
            yield actor.v, _KINDS[actor.does], _effort(actor, record, columns)


def _rates(mechanism: Mechanism) -> dict[int, tuple[str, int, bool]]:
    """By rate: the joint, which of its rates it is, and whether it slides."""
    return {
        slot.v.start + k: (slot.name, k, not slot.has_ball and not slot.kind.coordinates[k][1])
        for slot in mechanism.slots
        for k in range(slot.v.stop - slot.v.start)
    }


def _use(time: Array, on: tuple[str, int, bool], kind: str, effort: Array, rate: Array) -> DriveUse:
    power = effort * rate
    span = float(time[-1] - time[0])

    def rms(values: Array) -> float:
        with np.errstate(over="ignore"):  # of a run that overflows
            mean = float(np.trapezoid(values**2, time)) / span if span > 0.0 else float(values[0] ** 2)
        return float(np.sqrt(mean))

    return DriveUse(
        on[0], kind, float(np.abs(effort).max()), rms(effort), float(power.max()), float(np.trapezoid(power, time)),
        on[1], on[2], float(np.abs(rate).max()), rms(power),
    )  # fmt: skip


def _effort(actor: Acts, record: Record, states: list[Array | None]) -> Array:
    """(T,) effort of an actor on its shaft."""
    q, v, numbers = record.q[:, actor.q], record.v[:, actor.v], actor.numbers
    if actor.does == layout.SPRING:
        return np.asarray(numbers[0] * (numbers[1] - q))
    if actor.does == layout.DAMPER:
        return np.asarray(-numbers[0] * v)
    assert actor.signal is not None
    level = np.array([actor.signal.value(float(t)) for t in record.time])
    if actor.does == layout.EFFORT:
        return level
    rate = np.array([actor.signal.rate(float(t)) for t in record.time])

    def controlled(gains: tuple[float, ...], integral: Array | None) -> Array:
        kp, ki, kd, limit = gains
        wanted = kp * (level - q) + kd * (rate - v) + (0.0 if integral is None else ki * integral)
        return np.asarray(np.clip(wanted, -limit, limit))

    if actor.does == layout.SERVO:
        return controlled(numbers, states[0])
    resistance, _, constant, gear = numbers[:4]
    current = states[0]
    if current is None:
        voltage = level if actor.does == layout.MOTOR else controlled(numbers[4:], states[1])
        current = (voltage - constant * gear * v) / resistance
    return np.asarray(constant * gear * current)
