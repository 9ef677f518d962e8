"""`[[function.spring]]`, `[[function.gas_spring]]`, `[[function.bushing]]`: what pulls between two parts."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from kinform.form.tables import Name, NonNegative, Pair, Positive, Table, Vector

Points = Annotated[list[Vector], Field(min_length=2, max_length=2)]
Two = Annotated[list[Positive], Field(min_length=2, max_length=2)]
OfAxes = Annotated[list[NonNegative], Field(min_length=3, max_length=3)]
_POINTS = "a point on each, at the pose of the meshes"
_DAMPING = "N·s/m, whatever the units of the file"


class _Between(Table):
    name: Name | None = Field(None, description="what it is called; default its number")
    between: Pair = Field(description="two parts or groups of different bodies")


class PointSpring(_Between):
    """A spring, with a damper or without, between a point of one part and a point of another."""

    points: Points = Field(description=_POINTS)
    stiffness: NonNegative = Field(0.0, description="N/m, whatever the units of the file")
    damping: NonNegative = Field(0.0, description=_DAMPING)
    rest: NonNegative | None = Field(None, description="length without force; default that at the pose of the meshes")


class GasSpring(_Between):
    """A gas spring: pushes with one force at one length and with another at another."""

    points: Points = Field(description=_POINTS)
    lengths: Two = Field(description="two lengths between the points, the extended one first")
    forces: Two = Field(description="N at these lengths; the second is greater")
    exponent: NonNegative = Field(
        0.0, description="of the gas law, force · volume^n: 1 slow, up to 1.4 quick; 0: straight between the two"
    )
    damping: NonNegative = Field(0.0, description=_DAMPING)


class Bushing(_Between):
    """An elastic bearing: forces against displacements and torques against turns, along and about three axes."""

    point: Vector = Field(description="its centre, at the pose of the meshes, where it is without force")
    stiffness: OfAxes = Field(description="N/m along x, y, z of the file, carried by the first part")
    torsion: OfAxes = Field([0.0, 0.0, 0.0], description="N·m/rad about x, y, z")
    damping: OfAxes = Field([0.0, 0.0, 0.0], description="N·s/m along x, y, z")
    torsion_damping: OfAxes = Field([0.0, 0.0, 0.0], description="N·m·s/rad about x, y, z")
