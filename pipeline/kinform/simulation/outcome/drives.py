"""What each drive did in a dynamic run: effort, its root mean square, power. For motion drives this is
the inverse dynamics: what a motor must give.

Root mean squares and work are integrals that the solver carries in its state, so they do not depend on the output times
(`layout.METER`); of frictions, whose state may change within an output step, they are those over the outputs. Peaks are
those at output times, or the root mean square where that is more.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from kinform.model.arrays import Array
from kinform.model.simulation import DriveKind, DriveUse
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.mechanism.efforts import effort_of
from kinform.simulation.mechanism.mechanism import Mechanism
from kinform.simulation.record import Record

_KINDS: dict[int, DriveKind] = {
    layout.EFFORT: "effort", layout.SPRING: "spring", layout.DAMPER: "damper", layout.SERVO: "servo",
    layout.MOTOR: "dc_motor", layout.CONTROLLED: "dc_motor",
}  # fmt: skip


def drive_fields(dynamics: Dynamics, record: Record) -> dict[str, Any]:
    """What the drives did at the output times, prescribed motions first, as fields of the results."""
    if not len(record.time):
        return {}
    acted = list(_acted(dynamics, record))
    on, meters = _rates(dynamics.mechanism), sum(dynamics.actuation.meters, ())
    uses = tuple(
        _use(record, on[v], kind, effort, v, at - dynamics.actuation.first_state)
        for (v, kind, effort), at in zip(acted, meters, strict=True)
    )
    efforts = np.array([effort for _, _, effort in acted]).reshape(len(acted), len(record.time)).T
    return {"drives": uses, "drive_effort": efforts, "drive_speed": record.v[:, [v for v, _, _ in acted]]}


def _acted(dynamics: Dynamics, record: Record) -> Iterator[tuple[int, DriveKind, Array]]:
    """The rate, kind and (T,) effort of each drive."""
    actuation = dynamics.actuation
    stops = {stop.v for stop in actuation.stops}
    for v in actuation.metered:
        kind: DriveKind = "stop" if v in stops and v not in actuation.led else "motion"
        yield v, kind, record.needed[:, v] - (_held(dynamics, record, v) if kind == "stop" else 0.0)
    states = 0
    for actor in actuation.actors:
        columns = [
            record.extra[:, states + sum(actor.states[:k])] if has else None for k, has in enumerate(actor.states)
        ]
        states += sum(actor.states)
        if actor.friction >= 0 and record.friction is not None:
            lost = actuation.frictions[actor.friction]
            yield actor.v, lost.called, record.friction.effort[:, actor.friction]
        else:
            effort = effort_of(actor, record.time, record.q[:, actor.q], record.v[:, actor.v], columns)
            yield actor.v, _KINDS[actor.does], effort


def _held(dynamics: Dynamics, record: Record, v: int) -> Array:
    """(T,) of the effort that holds a rate what frictions give that stick."""
    out = np.zeros(len(record.time))
    if record.friction is not None:
        for k, one in enumerate(dynamics.actuation.frictions):
            if one.v == v:
                out += np.where(record.friction.sticking[:, k], record.friction.effort[:, k], 0.0)
    return out


def _rates(mechanism: Mechanism) -> dict[int, tuple[str, int, bool]]:
    """By rate: the joint, which of its rates it is, and whether it slides."""
    return {
        slot.v.start + k: (slot.name, k, not slot.has_ball and not slot.kind.coordinates[k][1])
        for slot in mechanism.slots
        for k in range(slot.v.stop - slot.v.start)
    }


def _use(record: Record, on: tuple[str, int, bool], kind: DriveKind, effort: Array, v: int, meter: int) -> DriveUse:
    """`meter`: the first of its integrals among the states of `record.extra`; negative without."""
    time, rate = record.time, record.v[:, v]
    power = effort * rate
    span = float(time[-1] - time[0])
    if meter >= 0:
        squared, work, squared_power = (record.extra[-1] - record.extra[0])[meter : meter + 3].tolist()
        if kind == "stop" and record.friction is not None:
            # The meter counts what friction held there too, without power.
            squared = float(np.trapezoid(effort**2, time))
    else:
        with np.errstate(over="ignore"):  # of a run that overflows
            squared, work, squared_power = (float(np.trapezoid(x, time)) for x in (effort**2, power, power**2))

    def rms(integral: float, start: float) -> float:
        # Below zero by rounding, where nothing acts.
        return float(np.sqrt(max(integral, 0.0) / span)) if span > 0.0 else abs(start)

    # Between outputs an effort was greater than at all of them, where its mean is.
    mean = rms(squared, float(effort[0]))
    return DriveUse(
        on[0], kind, max(float(np.abs(effort).max()), mean), mean, float(power.max()), work,
        on[1], on[2], float(np.abs(rate).max()), rms(squared_power, float(power[0])),
    )  # fmt: skip
