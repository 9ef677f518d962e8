"""What formats of trees of links cannot say, in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

from kinform.behaviour import DcMotor, EffortDrive, MotionDrive, Servo, System
from kinform.exports.robot import Driver, Robot

__all__ = ["of_teeth", "tree_losses"]

_WHAT: dict[type[Driver], str] = {
    MotionDrive: "its motion follows a law",
    EffortDrive: "its effort follows a law",
    Servo: "a servo with its gains and target",
    DcMotor: "a DC motor with its voltage",
}


def of_teeth(system: System) -> Iterator[str]:
    """What becomes of teeth where a format has gears as ratios between joints."""
    for gear in system.gears:
        if gear.pitch_point is not None:
            ends = math.isfinite(gear.lower) or math.isfinite(gear.upper)
            yield (
                f"{gear.subject}: a ratio between its joints; what its teeth push on the bearings is left out"
                + (", and that they end" if ends else "")
            )


def tree_losses(made: Robot, format: str, *, springs: bool = False) -> Iterator[str]:
    """Loops, laws of drives, springs, loads and initial values. `springs`: the format has them."""
    for closing in made.closing:
        yield f"{closing.joint.subject}: the joint closes a loop, and {format} has trees only; it is left out"
        for actor in made.model.system.actors(closing.joint.name):
            yield f"{closing.joint.subject}: what acts on it ({type(actor).__name__}) is left out with it"
    for link in made.links:
        for drive in link.drives:
            yield f"{drive.subject}: {_WHAT[type(drive)]}, which {format} does not have; only that it is driven"
        if not springs:
            for spring in link.springs:
                yield f"{spring.subject}: a spring of {spring.stiffness:g} N·m/rad or N/m"
    for load in made.loads:
        yield f"{load.subject}: a load"
    if made.moved:
        yield "the initial positions and velocities; zero is the pose of the meshes"
