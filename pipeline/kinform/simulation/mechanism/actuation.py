"""What acts on the mechanism: prescribed joints, drives and springs on shafts, loads, stops."""

from __future__ import annotations

import copy
import math
from dataclasses import replace

import numpy as np

from kinform.behaviour import shafts
from kinform.behaviour.components import System
from kinform.behaviour.signals import STEADY, Constant, Signal, Spline, smooth
from kinform.frozen import dataclass
from kinform.model.arrays import Array, Ints
from kinform.simulation.kernel import layout
from kinform.simulation.mechanism.elastic import Between
from kinform.simulation.mechanism.losses import brush, gear_loss, motor_loss
from kinform.simulation.mechanism.mechanism import Mechanism, Slot
from kinform.simulation.mechanism.rubbing import Lost, Rubbing, rubbing_of


@dataclass(frozen=True, eq=False)
class Acts:
    """A drive, spring or motor on the shaft of a joint, as the kernel takes it."""

    name: str
    joint: str
    q: int
    v: int
    does: int
    signal: Signal | None
    numbers: tuple[float, ...]
    """In the order of the kernel; see `kernel.forces.drive`."""
    states: tuple[bool, bool] = (False, False)
    """Whether it has a first and a second state: current, integral."""
    friction: int = -1
    """Which of the frictions it stands for, whose effort the solver finds; −1: none."""


@dataclass(frozen=True, eq=False)
class Push:
    """A load: force and torque at a point of a link, about the mechanism's centre."""

    link: int
    force: Array
    torque: Array
    point: Array
    turning: bool
    signal: Signal = STEADY
    """What force and torque are multiplied by."""


@dataclass(frozen=True)
class Stop:
    """A joint's value may not pass `limit` in the direction of `sense` (1 or −1)."""

    joint: str
    q: int
    v: int
    sense: int
    limit: float
    restitution: float = 0.0
    """Share of the rate that an impact leaves, turned round."""


class Actuation:
    """Drives and loads with the rates and links that they act on."""

    def __init__(self, mechanism: Mechanism, system: System, *, with_mass: bool, until: float = math.inf):
        """`with_mass`: prescribed tables are smoothed, so that finite efforts can follow, but for those that are
        straight up to the time `until` (s)."""
        self.notes: list[str] = []
        self.conflicts: list[tuple[str, str]] = []
        self.actors: list[Acts] = []
        self.stops: list[Stop] = []
        self.frictions: list[Rubbing] = []
        self._led: list[tuple[int, int, Signal, str]] = []
        self.springs: list[Between] = []
        self.armature = np.zeros(mechanism.rates)
        """(n,) kg·m² or kg of the rotors on each rate."""
        self._with_mass, self._until = with_mass, until
        slots = {slot.name: slot for slot in mechanism.slots}
        for joint in system.joints:
            for actor in system.actors(joint.name):
                if isinstance(actor, shafts.Friction):
                    self._rub(rubbing_of(mechanism, system, joint, actor), slots[joint.subject])
                else:
                    self._take(system, slots[joint.subject], actor)
        self._lose(system, slots)
        self._lead(self._led, mechanism.rates)
        self.metered = tuple(sorted({*self.led.tolist(), *(stop.v for stop in self.stops)}))
        """Rates whose leading is metered: what stops lead at times too."""
        link_of = dict(zip(mechanism.bodies, mechanism.link_of, strict=True))
        self.loads = [
            Push(
                int(link_of[system.body_at(load.name, "frame").subject]),
                load.force, load.torque, load.point - mechanism.centre, load.turning, load.signal,
            )
            for load in system.loads
        ]  # fmt: skip
        for spring in system.springs:
            first, second = (int(link_of[system.body_at(spring.name, port).subject]) for port in ("a", "b"))
            ends = spring.point - mechanism.centre, spring.other - mechanism.centre
            self.springs.append(Between(first, second, *ends, spring))
        self.first_state = len(mechanism.start) + mechanism.rates

    def _take(self, system: System, slot: Slot, actor: shafts.Actor) -> None:
        """Add what acts on the shaft of a joint."""
        freedom = actor.freedom
        q, v = slot.q.start + freedom, slot.v.start + freedom
        if slot.has_ball and not isinstance(actor, shafts.EffortDrive | shafts.Damper):
            why = "a ball's turn about one direction has a rate and no value: efforts and dampers alone can act on it"
            self.conflicts.append((slot.name, why))
        elif isinstance(actor, shafts.MotionDrive):
            if v in [led[1] for led in self._led]:
                self.conflicts.append((slot.name, "two drives prescribe its motion"))
                return
            signal = self._followed(actor, slot.kind.coordinates[freedom][1]) if self._with_mass else actor.signal
            self._led.append((q, v, signal, actor.name))
        elif isinstance(actor, shafts.EndStop):
            for sense, limit in ((-1, actor.lower), (1, actor.upper)):
                if np.isfinite(limit):
                    self.stops.append(Stop(slot.name, q, v, sense, limit, actor.restitution))
        else:
            self.actors.append(_acts(system, slot.name, q, v, actor))
            if isinstance(actor, shafts.DcMotor):
                self._motor(system, actor, slot)

    def _rub(self, rubbing: Rubbing, slot: Slot) -> None:
        """Add friction, as an effort that the solver finds."""
        if slot.has_ball:
            self.conflicts.append((slot.name, "friction acts on turns about one axis and on slides, not on a ball"))
            return
        name, number = rubbing.friction.name, len(self.frictions)
        acts = Acts(name, slot.name, rubbing.q, rubbing.v, layout.EFFORT, Constant(0.0), (), friction=number)
        self.frictions.append(replace(rubbing, actor=len(self.actors)))
        self.actors.append(acts)

    def _motor(self, system: System, motor: shafts.DcMotor, slot: Slot) -> None:
        """Add the rotor of a motor, the actor before, and what its gear loses."""
        number, joint = len(self.actors) - 1, [one.subject for one in system.joints].index(slot.name)
        self.armature[slot.v.start + motor.freedom] += motor.armature
        rotor = len(self.frictions) if motor.rotor_friction > 0.0 else -1
        if rotor >= 0:
            self._rub(brush(motor, slot, joint), slot)
        if motor.lossy:
            self._rub(motor_loss(motor, Lost(motor=number, brush=rotor), slot, joint), slot)

    def _lose(self, system: System, slots: dict[str, Slot]) -> None:
        """Add what gears lose."""
        for number, gear in enumerate(system.gears):
            if gear.lossy:
                side = 0 if gear.efficiency > 0.0 else 1
                joint = system.joint_at(gear.name, "ab"[side])
                slot = slots[joint.subject]
                self._rub(gear_loss(gear, number, side, slot, system.joints.index(joint)), slot)

    def _followed(self, actor: shafts.MotionDrive, turns: bool) -> Signal:
        """The signal as a body with mass can follow it."""
        signal = smooth(actor.signal, self._until)
        if isinstance(signal, Spline):
            deviation = signal.deviation
            words = f"{math.degrees(deviation):.3g}°" if turns else f"{1e3 * deviation:.3g} mm"
            curve = "monotone cubic curve" if signal.monotone else "cubic spline"
            self.notes.append(
                f"the table that drives {actor.subject} is followed by a {curve} at rest at its ends, "
                f"within {words} of the table's straight lines"
            )
        return signal

    @property
    def knots(self) -> tuple[float, ...]:
        """Times at which a signal is not smooth, ascending."""
        signals = [*self.signals, *(actor.signal for actor in self.actors if actor.signal is not None)]
        signals += [load.signal for load in self.loads]
        return tuple(sorted({knot for signal in signals for knot in signal.knots}))

    def led_values(self, t: float) -> Array:
        """(k,) prescribed positions."""
        return np.array([signal.value(t) for signal in self.signals])

    def led_rates(self, t: float) -> Array:
        """(k,) prescribed rates."""
        return np.array([signal.rate(t) for signal in self.signals])

    def led_accelerations(self, t: float) -> Array:
        """(k,) prescribed accelerations."""
        return np.array([signal.acceleration(t) for signal in self.signals])

    @property
    def controlled(self) -> int:
        """How many states controllers and motors have."""
        return sum(sum(actor.states) for actor in self.actors)

    @property
    def meters(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """First of three integrals in the state (`layout.METER`), of each rate that is metered and of each actor; −1
        for frictions, whose effort is not known while they stick."""
        at = self.first_state + self.controlled
        rates = tuple(range(at, at + 3 * len(self.metered), 3))
        actors, at = [], at + 3 * len(self.metered)
        for actor in self.actors:
            actors.append(at if actor.friction < 0 else -1)
            at += 3 if actor.friction < 0 else 0
        return rates, tuple(actors)

    def meter_of(self, rate: int) -> int:
        """First of the three integrals of a rate that is metered."""
        return self.meters[0][self.metered.index(rate)]

    def held(self, stop: Stop, signal: Signal) -> Actuation:
        """The same with the joint of the stop held on the signal."""
        return self._with_led([*self._led, (stop.q, stop.v, signal, stop.joint)])

    def released(self, stop: Stop) -> Actuation:
        """The same with the joint of the stop free again."""
        return self._with_led([led for led in self._led if led[1] != stop.v])

    def passive(self) -> Actuation:
        """The same without drives, stops and dampers: loads, springs and friction alone, nothing led."""
        out = copy.copy(self)
        keep = [k for k, actor in enumerate(self.actors) if actor.friction >= 0 or actor.does == layout.SPRING]
        out.actors = [self.actors[k] for k in keep]
        motors = {number: keep.index(number) if number in keep else -1 for number in range(len(self.actors))}
        out.frictions = [_renumbered(one, keep.index(one.actor), motors) for one in self.frictions]
        out.stops, out.metered = [], ()
        out._lead([], len(self.free) + len(self.led))
        return out

    def _with_led(self, led: list[tuple[int, int, Signal, str]]) -> Actuation:
        out = copy.copy(self)
        out._lead(led, len(self.free) + len(self.led))
        return out

    def _lead(self, led: list[tuple[int, int, Signal, str]], rates: int) -> None:
        """Prescribe these joints (position, rate, signal, name) of a mechanism with so many rates."""
        self._led = led
        self.led_q: Ints = np.array([q for q, _, _, _ in led], dtype=np.int64)
        self.led: Ints = np.array([v for _, v, _, _ in led], dtype=np.int64)
        self.free: Ints = np.setdiff1d(np.arange(rates), self.led)
        self.signals = [signal for _, _, signal, _ in led]

    def stored(self, q: Array, X: Array) -> Array:
        """(T,) energy in the springs (J) at positions (T, nq) and poses (T, L, 4, 4)."""
        total = np.zeros(len(q))
        for actor in self.actors:
            if actor.does == layout.SPRING:
                stiffness, rest = actor.numbers
                total += 0.5 * stiffness * (q[:, actor.q] - rest) ** 2
        for spring in self.springs:
            total += spring.energy(X)
        return total


def _renumbered(one: Rubbing, actor: int, motors: dict[int, int]) -> Rubbing:
    """The friction by other numbers of the actors, −1 for motors that are not among them."""
    lost = one.lost
    if lost is not None and lost.motor >= 0:
        lost = replace(lost, motor=motors[lost.motor])
    return replace(one, actor=actor, lost=lost)


def _acts(system: System, joint: str, q: int, v: int, actor: shafts.Actor) -> Acts:
    """The actor as the kernel takes it."""
    name = actor.name
    if isinstance(actor, shafts.EffortDrive):
        return Acts(name, joint, q, v, layout.EFFORT, actor.signal, ())
    if isinstance(actor, shafts.Spring):
        return Acts(name, joint, q, v, layout.SPRING, None, (actor.stiffness, actor.rest))
    if isinstance(actor, shafts.Damper):
        return Acts(name, joint, q, v, layout.DAMPER, None, (actor.damping,))
    if isinstance(actor, shafts.Servo):
        gains = _gains(actor.controller)
        return Acts(name, joint, q, v, layout.SERVO, actor.target, gains, (actor.controller.ki != 0.0, False))
    assert isinstance(actor, shafts.DcMotor)
    motor = (actor.resistance, actor.inductance, actor.constant, actor.gear)
    supply, current = system.supply(name), actor.inductance > 0.0
    if isinstance(supply, shafts.VoltageSource):
        numbers: tuple[float, ...] = (*motor, *(0.0,) * 5, actor.current_limit)
        return Acts(name, joint, q, v, layout.MOTOR, supply.signal, numbers, (current, False))
    numbers = (*motor, *_gains(supply.controller), actor.current_limit)
    return Acts(name, joint, q, v, layout.CONTROLLED, supply.target, numbers, (current, supply.controller.ki != 0.0))


def _gains(controller: shafts.Controller) -> tuple[float, ...]:
    most = controller.speed_limit if controller.cascade else -1.0
    return controller.kp, controller.ki, controller.kd, controller.limit, most
