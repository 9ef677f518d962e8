"""What acts on the mechanism: prescribed joints, efforts, springs, dampers, loads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinform.behaviour.components import (
    Damper,
    EffortDrive,
    MotionDrive,
    Spring,
    System,
)
from kinform.behaviour.signals import Signal, smooth
from kinform.simulation.mechanism import Mechanism

__all__ = ["Actuation"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class _Load:
    link: int
    force: Array
    torque: Array
    point: Array
    turning: bool


class Actuation:
    """Drives and loads with the rates and links that they act on."""

    def __init__(self, mechanism: Mechanism, system: System, *, with_mass: bool):
        """`with_mass`: prescribed tables are smoothed, so that finite efforts can follow."""
        self.notes: list[str] = []
        self.conflicts: list[tuple[str, str]] = []
        slots = {slot.name: slot for slot in mechanism.slots}
        led: list[tuple[int, int, Signal]] = []
        self._efforts: list[tuple[int, Signal]] = []
        self._springs: list[tuple[int, int, Spring]] = []
        self._dampers: list[tuple[int, Damper]] = []
        for joint in system.joints:
            slot = slots[joint.subject]
            for actor in system.actors(joint.name):
                if isinstance(actor, MotionDrive):
                    if led and led[-1][0] == slot.q.start:
                        self.conflicts.append((joint.subject, "two drives prescribe its motion"))
                        continue
                    signal = self._followed(actor) if with_mass else actor.signal
                    led.append((slot.q.start, slot.v.start, signal))
                elif isinstance(actor, EffortDrive):
                    self._efforts.append((slot.v.start, actor.signal))
                elif isinstance(actor, Spring):
                    self._springs.append((slot.q.start, slot.v.start, actor))
                else:
                    self._dampers.append((slot.v.start, actor))
        self.led_q: Index = np.array([q for q, _, _ in led], dtype=np.int64)
        self.led: Index = np.array([v for _, v, _ in led], dtype=np.int64)
        self.free: Index = np.setdiff1d(np.arange(mechanism.rates), self.led)
        self._signals = [signal for _, _, signal in led]
        link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
        self._loads = [
            _Load(
                int(link_of[system.body_at(load.name, "frame").subject]),
                load.force,
                load.torque,
                load.point - mechanism.centre,
                load.turning,
            )
            for load in system.loads
        ]
        self._counts = mechanism.rates, len(mechanism.parent)

    def _followed(self, actor: MotionDrive) -> Signal:
        """The signal as a body with mass can follow it."""
        signal = smooth(actor.signal)
        deviation = getattr(signal, "deviation", None)
        if deviation is not None:
            self.notes.append(
                f"the table that drives {actor.subject} is followed by a cubic spline at rest at its ends, "
                f"within {deviation:.3g} rad or m of the table's straight lines"
            )
        return signal

    @property
    def knots(self) -> tuple[float, ...]:
        """Times at which a signal is not smooth, ascending."""
        signals = [*self._signals, *(signal for _, signal in self._efforts)]
        return tuple(sorted({knot for signal in signals for knot in signal.knots}))

    def led_values(self, t: float) -> Array:
        """(k,) prescribed positions."""
        return np.array([signal.value(t) for signal in self._signals])

    def led_rates(self, t: float) -> Array:
        """(k,) prescribed rates."""
        return np.array([signal.rate(t) for signal in self._signals])

    def led_accelerations(self, t: float) -> Array:
        """(k,) prescribed accelerations."""
        return np.array([signal.acceleration(t) for signal in self._signals])

    def efforts(self, t: float, q: Array, v: Array) -> tuple[Array, Array]:
        """(n,) efforts by effort drives and dampers, and (n,) by springs."""
        given, stored = np.zeros(self._counts[0]), np.zeros(self._counts[0])
        for k, signal in self._efforts:
            given[k] += signal.value(t)
        for k, damper in self._dampers:
            given[k] -= damper.damping * v[k]
        for at, k, spring in self._springs:
            stored[k] += spring.stiffness * (spring.rest - q[at])
        return given, stored

    def stored(self, q: Array) -> float:
        """Energy in the springs (J)."""
        return float(sum(0.5 * s.stiffness * (q[at] - s.rest) ** 2 for at, _, s in self._springs))

    def loads(self, X: Array, V: Array) -> tuple[Array, float]:
        """(L, 6) wrench of the loads on each link about the centre, and their power (W)."""
        out = np.zeros((self._counts[1], 6))
        for load in self._loads:
            R, p = X[load.link, :3, :3], X[load.link, :3, 3]
            force, torque = (R @ load.force, R @ load.torque) if load.turning else (load.force, load.torque)
            out[load.link, :3] += torque + np.cross(R @ load.point + p, force)
            out[load.link, 3:] += force
        return out, float((out * V).sum())
