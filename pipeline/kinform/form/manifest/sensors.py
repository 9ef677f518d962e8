"""`[[simulation.sensor]]`: what is to be followed during a run."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from kinform.form.tables import Name, Pair, Reference, Table, Vector

_FRAME = "part or group in whose axes, and as seen from which, values are; default the world"


class _Sensor(Table):
    name: Name = Field(description="what its columns are called, any text but '/'")


class PointSensor(_Sensor):
    """Position, velocity and acceleration of a point of a part."""

    kind: Literal["point"]
    part: Reference = Field(description="part or group that carries the point")
    point: Vector | None = Field(None, description="at the pose of the meshes; default its body's centre of mass")
    frame: Reference | None = Field(None, description=_FRAME)


class RotationSensor(_Sensor):
    """Angular velocity and angular acceleration of a part."""

    kind: Literal["rotation"]
    part: Reference = Field(description="part or group that turns")
    frame: Reference | None = Field(None, description=_FRAME)


class DistanceSensor(_Sensor):
    """Distance between a point of one part and a point of another, and how fast it grows."""

    kind: Literal["distance"]
    between: Pair = Field(description="two parts or groups of different bodies")
    points: Annotated[list[Vector], Field(min_length=2, max_length=2)] | None = Field(
        None, description="a point of each, at the pose of the meshes; default their bodies' centres of mass"
    )


class AngleSensor(_Sensor):
    """Angle by which the second part has turned relative to the first since the pose of the meshes, and its rate."""

    kind: Literal["angle"]
    between: Pair = Field(description="two parts or groups of different bodies")
    axis: Vector | None = Field(
        None,
        description="about this axis of the first, right-handed, turns counted; default the whole angle, 0 to 180°",
    )


class ReactionSensor(_Sensor):
    """Force and torque that a joint carries, about the joint's point."""

    kind: Literal["reaction"]
    joint: Reference = Field(description="a [[function.joint]], or a joint as kinform names it")
    part: Reference | None = Field(None, description="side on which it acts; default the second of the joint")
    frame: Reference | None = Field(None, description="part or group in whose axes it is; default the world")


Sensor = Annotated[
    PointSensor | RotationSensor | DistanceSensor | AngleSensor | ReactionSensor, Field(discriminator="kind")
]
