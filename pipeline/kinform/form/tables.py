"""Types that several tables of the manifest share.

Pydantic checks shapes and types here; what one key says about another is checked in `form.readers`, where
every problem can be given the line of its own key, and by kinds of requirements.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from kinform.form.constants import LARGEST_NUMBER, NAME_LENGTH

PATH_LENGTH = 4095
"""Characters of the path of a file: what Linux takes."""
ROWS_MOST = 10_000
"""Rows of a law or a curve that is written in the manifest; longer ones are CSV files. Chosen, not measured: 100 s at a
hundred a second."""


Finite = Annotated[float, Field(ge=-LARGEST_NUMBER, le=LARGEST_NUMBER, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, le=LARGEST_NUMBER, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, le=LARGEST_NUMBER, allow_inf_nan=False)]
Vector = Annotated[list[Finite], Field(min_length=3, max_length=3)]
Matrix = Annotated[list[Vector], Field(min_length=3, max_length=3)]
Colour = Annotated[str, StringConstraints(pattern=r"^#[0-9a-fA-F]{6}$")]
"""As in style sheets."""
Name = Annotated[str, StringConstraints(min_length=1, max_length=NAME_LENGTH, pattern=r"^[^/\x00]+$")]
Path = Annotated[str, StringConstraints(min_length=1, max_length=NAME_LENGTH, pattern=r"^[^/\x00]+(/[^/\x00]+)*$")]
"""Names with "/" between them, as parts of a scene have."""
Reference = Annotated[str, StringConstraints(min_length=1, max_length=PATH_LENGTH, pattern=r"^[^\x00]+$")]
"""Of a part, joint, material, file or rule."""
Pair = Annotated[list[Reference], Field(min_length=2, max_length=2)]
Unit = Literal["m", "cm", "mm", "um", "in", "ft"]
JointType = Literal["fixed", "revolute", "prismatic", "cylindrical", "spherical", "planar", "screw", "universal"]


class Table(BaseModel):
    """A table of the manifest: exact types, no unknown keys."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, defer_build=True)


class Posed(Table):
    """Something with a pose in the frame of its manifest: position, and quaternion or rpy."""

    position: Vector | None = Field(None, description="three lengths; default the origin")
    quaternion: Annotated[list[Finite], Field(min_length=4, max_length=4)] | None = Field(
        None, description="unit quaternion [w, x, y, z]; not together with rpy"
    )
    rpy: Vector | None = Field(
        None, description="degrees [roll, pitch, yaw], R = Rz(yaw)·Ry(pitch)·Rx(roll); not with quaternion"
    )
