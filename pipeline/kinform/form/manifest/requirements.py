"""Requirements: one table per kind, each key with the quantity that it is."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from kinform.form.manifest.common import Finite, Name, NonNegative, Pair, Positive, Quantity, Reference, Table, Vector

ROWS_MOST = 10_000
"""Rows of a law that is written in the manifest: what is longer was made by a program, which writes CSV. Chosen, not
measured."""


Length = Quantity("length")
Angle = Quantity("angle")
Point = Quantity("point")
Direction = Quantity("direction")
Place = Quantity("place")
Joint = Quantity("joint")


class _Require(Table):
    name: Name = Field(description="name of the requirement, any text but '/'")


class Cone(Table):
    """Directions within half_angle of an axis."""

    type: Literal["cone"]
    axis: Annotated[Vector, Direction] = Field(description="middle of the cone")
    half_angle: Annotated[float, Field(gt=0, le=180), Angle] = Field(description="degrees")


class Box(Table):
    """A box along the axes of the manifest's frame."""

    type: Literal["box"]
    lower: Annotated[Vector, Quantity("frame")] = Field(description="corner with the least coordinates")
    upper: Annotated[Vector, Quantity("frame")] = Field(description="corner with the greatest coordinates")


class Poses(Table):
    """Single places, or single directions, that are to be reached."""

    type: Literal["poses"]
    points: Annotated[list[Vector] | None, Point] = Field(None, description="places for the point")
    directions: Annotated[list[Vector] | None, Direction] = Field(None, description="directions to point in")


class Reach(_Require):
    """A point, or a pointing direction, of a body covers a region."""

    kind: Literal["reach"]
    part: Annotated[Reference, Place] = Field(description="part or group that carries the point or direction")
    point: Annotated[Vector | None, Point] = Field(None, description="point, at the pose of the meshes")
    direction: Annotated[Vector | None, Direction] = Field(
        None, description="direction, at the pose of the meshes; in place of point"
    )
    region: Annotated[Cone | Box | Poses, Field(discriminator="type")] = Field(description="what to cover")
    tolerance: Annotated[NonNegative | None, Length] = Field(None, description="distance that is near enough")
    angle_tolerance: Annotated[NonNegative | None, Angle] = Field(None, description="degrees that are near enough")


class Follow(_Require):
    """A point of a body, with its orientation if the path has it, follows a path during the simulation."""

    kind: Literal["follow"]
    part: Annotated[Reference, Place] = Field(description="part or group that carries the point")
    point: Annotated[Vector, Point] = Field(description="point, at the pose of the meshes")
    path: Annotated[Reference, Quantity("path")] = Field(
        description="CSV file of time (s), x, y, z and optionally qw, qx, qy, qz, relative to the manifest"
    )
    tolerance: Annotated[Positive, Length] = Field(description="greatest distance from the path")
    angle_tolerance: Annotated[Positive | None, Angle] = Field(None, description="degrees from the orientation")


class Clear(_Require):
    """No collision over the ranges or the motion, with a least distance."""

    kind: Literal["clear"]
    between: Annotated[list[Reference] | None, Field(min_length=2, max_length=2), Place] = Field(
        None, description="two parts or groups; default all"
    )
    over: Literal["ranges", "motion"] = Field("motion", description="the ranges of the joints, or the simulation")
    distance: Annotated[NonNegative, Length] = Field(0.0, description="least distance")


class Hold(_Require):
    """The static effort that holds the poses stays below a limit."""

    kind: Literal["hold"]
    joint: Annotated[Reference, Joint] = Field(description="a [[function.joint]]")
    limit: Positive = Field(description="N·m or N")
    poses: Annotated[list[dict[str, Finite]], Quantity("joint_values")] = Field(
        [], description="tables of joint = degrees or lengths; default the pose of the meshes"
    )


class Efficiency(_Require):
    """Of the work that the drive of a joint puts in, moving slowly against the load, a share comes out."""

    kind: Literal["efficiency"]
    joint: Annotated[Reference, Joint] = Field(description="a [[function.joint]], which the drive moves")
    minimum: Annotated[float, Field(gt=0, le=1)] = Field(description="share, between 0 and 1")
    poses: Annotated[list[dict[str, Finite]], Quantity("joint_values")] = Field(
        [], description="tables of joint = degrees or lengths; default the pose of the meshes"
    )


class SelfLocking(_Require):
    """A joint stays under its load when nothing drives it."""

    kind: Literal["self_locking"]
    joint: Annotated[Reference, Joint] = Field(description="a [[function.joint]], whose drive lets go")
    poses: Annotated[list[dict[str, Finite]], Quantity("joint_values")] = Field(
        [], description="tables of joint = degrees or lengths; default the pose of the meshes"
    )


class Torque(_Require):
    """The peak effort of a joint during the simulation stays below a limit."""

    kind: Literal["torque"]
    joint: Annotated[Reference, Joint] = Field(description="a [[function.joint]]")
    limit: Positive = Field(description="N·m or N")
    when_run: bool = Field(False, description="true: a limit of the joint, asked about only when a run drives it")


class Speed(_Require):
    """The peak speed of a joint during the simulation stays below a limit."""

    kind: Literal["speed"]
    joint: Annotated[Reference, Joint] = Field(description="a [[function.joint]]")
    limit: Annotated[Positive, Quantity("joint_value")] = Field(description="degrees or lengths a second")
    when_run: bool = Field(False, description="true: a limit of the joint, asked about only when there is a run")


class TorqueSpeed(_Require):
    """What a drive gives, and how fast, stays below the curve of its motor during the simulation."""

    kind: Literal["torque_speed"]
    joint: Annotated[Reference, Joint] = Field(description="a [[function.joint]] that is driven")
    speeds: Annotated[list[NonNegative], Quantity("joint_value"), Field(min_length=2, max_length=ROWS_MOST)] = Field(
        description="degrees or lengths a second, ascending from 0; the last is the greatest speed"
    )
    efforts: Annotated[list[NonNegative], Field(min_length=2, max_length=ROWS_MOST)] = Field(
        description="N·m or N that the drive can give at each of the speeds, straight between them; none greater than "
        "the one before"
    )


class Reaction(_Require):
    """The peak reaction in a joint during the simulation stays below a limit."""

    kind: Literal["reaction"]
    joint: Annotated[Reference, Joint] = Field(description="a [[function.joint]]")
    force: Positive | None = Field(None, description="N")
    torque: Positive | None = Field(None, description="N·m")


class Mass(_Require):
    """A mass within bounds."""

    kind: Literal["mass"]
    of: Annotated[Reference | None, Place] = Field(None, description="part or group; default all")
    minimum: NonNegative | None = Field(None, description="kg")
    maximum: NonNegative | None = Field(None, description="kg")


class CentreOfMass(_Require):
    """A centre of mass near a point, at the pose of the meshes."""

    kind: Literal["centre_of_mass"]
    of: Annotated[Reference | None, Place] = Field(None, description="part or group; default all")
    point: Annotated[Vector, Point] = Field(description="where it should be")
    tolerance: Annotated[Positive, Length] = Field(description="greatest distance from there")


class Inertia(_Require):
    """A moment of inertia about an axis through the centre of mass, or through a point, within bounds."""

    kind: Literal["inertia"]
    of: Annotated[Reference | None, Place] = Field(None, description="part or group; default all")
    axis: Annotated[Vector, Direction] = Field(description="direction of the axis")
    point: Annotated[Vector | None, Point] = Field(None, description="on the axis; default the centre of mass")
    minimum: NonNegative | None = Field(None, description="kg·m²")
    maximum: NonNegative | None = Field(None, description="kg·m²")


class Balance(_Require):
    """The static imbalance about an axis stays below a limit."""

    kind: Literal["balance"]
    of: Annotated[Reference, Place] = Field(description="part or group")
    joint: Annotated[Reference | None, Joint] = Field(None, description="axis of this joint; or axis and point")
    axis: Annotated[Vector | None, Direction] = Field(None, description="direction of the axis")
    point: Annotated[Vector | None, Point] = Field(None, description="on the axis")
    limit: Positive = Field(description="kg·m: mass times distance from the axis")


class Retained(_Require):
    """No part can leave along any direction but those listed."""

    kind: Literal["retained"]
    part: Annotated[Reference, Place] = Field(description="part or group")
    directions: Annotated[list[Vector], Direction] = Field([], description="directions in which it may leave")


class Fit(_Require):
    """A clearance between two parts within bounds; negative is press."""

    kind: Literal["fit"]
    between: Annotated[Pair, Place] = Field(description="two parts or groups")
    minimum: Annotated[Finite | None, Length] = Field(None, description="least clearance")
    maximum: Annotated[Finite | None, Length] = Field(None, description="greatest clearance")


Require = Annotated[
    Reach
    | Follow
    | Clear
    | Hold
    | Efficiency
    | SelfLocking
    | Torque
    | Speed
    | TorqueSpeed
    | Reaction
    | Mass
    | CentreOfMass
    | Inertia
    | Balance
    | Retained
    | Fit,
    Field(discriminator="kind"),
]
