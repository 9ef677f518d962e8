"""What gears lose: friction on one of their shafts, in proportion to the effort that they pass on there.

Let y be the effort that a gear gives its shaft at a, which turns at the rate ω. Where y ω < 0 that shaft drives, and of
its power the share η comes out at b; where y ω > 0 it is driven, and gets the share η′ of the power put in at b. Both
are friction on the shaft at a (or at b, where a cannot drive), of (1/η − 1) |y| in the first case and of (1 − η′) |y|
in the second, against ω. Nothing is smoothed where ω or y change their sign: such shafts stick and slip as those of
other frictions do (Pelchen, Schweiger & Otter, Modeling and simulating the efficiency of gearboxes and of planetary
gearboxes, 2nd Modelica conference, 2002). With η′ = 2 − 1/η, teeth that rub alike both ways, both are the same.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.behaviour.components import Gear
from kinform.behaviour.shafts import DcMotor, Friction
from kinform.model.arrays import Array
from kinform.model.simulation import DriveKind
from kinform.simulation.mechanism.mechanism import Mechanism, Slot
from kinform.simulation.mechanism.rubbing import Lost, Rubbing


def friction_of(efficiency: float, back: float) -> tuple[float, float]:
    """(coefficient, lean): the friction is coefficient · (|y| + lean · y · sign ω)."""
    driving, driven = 1.0 / efficiency - 1.0, 1.0 - back
    total = driving + driven
    return 0.5 * total, (driven - driving) / total if total else 0.0


def gear_loss(gear: Gear, number: int, side: int, slot: Slot, joint: int) -> Rubbing:
    """On the shaft of one side, 0 at a and 1 at b, which must be able to drive the other: that of the joint in `slot`,
    number `joint` of the system, which has one freedom."""
    shares = (gear.efficiency, gear.efficiency_back) if side == 0 else (gear.efficiency_back, gear.efficiency)
    return _loss(gear, shares, Lost(gear=number, side=side), slot, joint, 0, 1)


def motor_loss(motor: DcMotor, lost: Lost, slot: Slot, joint: int) -> Rubbing:
    """On the shaft of the motor, of the rotor's side."""
    shares = motor.efficiency, motor.efficiency_back
    return _loss(motor, shares, lost, slot, joint, motor.freedom, motor.rates)


def brush(motor: DcMotor, slot: Slot, joint: int) -> Rubbing:
    """The friction of a motor's rotor as its joint feels it."""
    effort = motor.rotor_friction * abs(motor.gear)
    friction = Friction(
        f"rotor of {motor.name}", motor.subject, 0.0, 0.0, effort, effort, freedom=motor.freedom, rates=motor.rates
    )
    return _on(friction, slot, joint, "rotor")


def _loss(
    gear: Gear | DcMotor, shares: tuple[float, float], lost: Lost, slot: Slot, joint: int, freedom: int, rates: int
) -> Rubbing:
    coefficient, lean = friction_of(*shares)
    name = f"loss of {gear.name}"
    friction = Friction(name, gear.subject, coefficient, coefficient, freedom=freedom, rates=rates)
    return replace(_on(friction, slot, joint, "gear_loss"), lost=lost, lean=lean)


def _on(friction: Friction, slot: Slot, joint: int, called: DriveKind) -> Rubbing:
    q, v = slot.q.start + friction.freedom, slot.v.start + friction.freedom
    return Rubbing(friction, slot.name, joint, 0, np.zeros(3), q, v, -1, called=called)


def multipliers(mechanism: Mechanism, rest: Array) -> Array:
    """(…, G) by which the rows of `mechanism.gear_v` are multiplied to give the shafts `rest` (…, n); the least where
    redundant gears share them."""
    return np.asarray((rest * mechanism.scale) @ np.linalg.pinv(mechanism.gear_v * mechanism.scale))
