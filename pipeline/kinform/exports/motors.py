"""What formats do not carry of motors and of their controllers, in sentences."""

from __future__ import annotations

import math

from kinform.behaviour import Actor, DcMotor, Servo, System, VoltageController
from kinform.behaviour.shafts import Controller


def left_out(system: System, actor: Actor) -> tuple[str, ...]:
    """Of an actor where nothing but its voltage, its coil and the gains of its controller is written."""
    if isinstance(actor, Servo):
        return slowed(actor.subject, actor.controller)
    if not isinstance(actor, DcMotor):
        return ()
    supply = system.supply(actor.name)
    control = slowed(actor.subject, supply.controller) if isinstance(supply, VoltageController) else ()
    return (*limited(actor), *rotor_of(actor), *control)


def limited(motor: DcMotor) -> tuple[str, ...]:
    """The limit of a motor's current."""
    if not math.isfinite(motor.current_limit):
        return ()
    return (f"{motor.subject}: the limit of its motor's current ({motor.current_limit:g} A)",)


def rotor_of(motor: DcMotor) -> tuple[str, ...]:
    """Inertia and friction of a motor's rotor, in sentences."""
    inertia = f"{motor.subject}: the inertia of its motor's rotor ({motor.rotor_inertia:g} kg·m²)"
    friction = f"{motor.subject}: the friction of its motor's rotor ({motor.rotor_friction:g} N·m)"
    return (*([inertia] if motor.rotor_inertia else []), *([friction] if motor.rotor_friction else []))


def slowed(subject: str, controller: Controller) -> tuple[str, ...]:
    """A controller with a limit of speed as one without, in a sentence."""
    if not controller.cascade:
        return ()
    return (f"{subject}: that its controller asks for {controller.speed_limit:g} rad/s or m/s at most",)
