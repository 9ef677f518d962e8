"""Sensors: what is asked to be followed during a run, and what was read. SI and radians."""

from __future__ import annotations

from typing import Literal

from kinform.frozen import dataclass
from kinform.model.quantities import Direction, Place

SensorKind = Literal["point", "rotation", "distance", "angle", "reaction"]


@dataclass(frozen=True, eq=False)
class Sensor:
    """What `[[simulation.sensor]]` asks to be followed; places in the world at the pose of the meshes."""

    name: str
    kind: SensorKind
    part: str = ""
    """The part or group that is followed; of a distance or an angle the first of two, of a reaction the one that it
    acts on, "" for the second of the joint."""
    other: str = ""
    """Of a distance or an angle the second."""
    point: Place | None = None
    """On the part; None: its body's centre of mass."""
    other_point: Place | None = None
    """On the other."""
    axis: Direction | None = None
    """Of an angle: about which the second turns, as the first carries it; None: the whole angle, 0 to π."""
    joint: str = ""
    """Of a reaction."""
    frame: str = ""
    """The part in whose axes, and as seen from which, values are; "" for the world."""
    file: str = ""
    line: int | None = None


@dataclass(frozen=True)
class Reading:
    """One column of what sensors read."""

    sensor: str
    quantity: str
    """position, velocity, acceleration; angular velocity and acceleration; distance, angle, rate; force, torque"""
    component: str
    """x, y, z; "" of what has no direction."""
    unit: str
    known: bool = True
    """False: redundant loops leave it open, and the smallest that balances was read."""
