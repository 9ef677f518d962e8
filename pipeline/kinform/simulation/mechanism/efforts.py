"""The effort of an actor in states that are known: what `kernel.forces.drive` gives, for many times at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from kinform.model.arrays import Array
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.actuation import Acts


def effort_of(actor: Acts, time: Array, q: Array, v: Array, states: Sequence[Array | None]) -> Array:
    """(T,) effort of an actor on its shaft at times (T,), values and rates (T,) of its joint, and with its own states
    (T,), None for those that it does not have."""
    numbers = actor.numbers
    if actor.does == layout.SPRING:
        return np.asarray(numbers[0] * (numbers[1] - q))
    if actor.does == layout.DAMPER:
        return np.asarray(-numbers[0] * v)
    assert actor.signal is not None
    level = np.array([actor.signal.value(float(t)) for t in time])
    if actor.does == layout.EFFORT:
        return level
    rate = np.array([actor.signal.rate(float(t)) for t in time])

    def controlled(gains: tuple[float, ...], integral: Array | None) -> Array:
        kp, ki, kd, limit, most = gains
        if most >= 0.0:
            wanted = kd * (np.clip(kp * (level - q) + rate, -most, most) - v)
        else:
            wanted = kp * (level - q) + kd * (rate - v)
        wanted = wanted + (0.0 if integral is None else ki * integral)
        return np.asarray(np.clip(wanted, -limit, limit))

    if actor.does == layout.SERVO:
        return controlled(numbers, states[0])
    resistance, _, constant, gear, *_, most = numbers
    current = states[0]
    if current is None:
        voltage = level if actor.does == layout.MOTOR else controlled(numbers[4:9], states[1])
        current = (voltage - constant * gear * v) / resistance
    return np.asarray(constant * gear * np.clip(current, -most, most))
