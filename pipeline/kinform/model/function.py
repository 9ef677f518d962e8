"""Function: what the designer wants. SI and radians, world frame, except where a unit cannot be known yet."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from kinform.model.arrays import Array

__all__ = [
    "Coupling",
    "Drive",
    "Function",
    "InitialValue",
    "IntendedJoint",
    "Law",
    "Load",
    "Requirement",
    "SimulationRequest",
]


@dataclass(frozen=True, eq=False)
class IntendedJoint:
    """A joint as the designer wants it, between two parts or groups; values are of the second
    about `axis` relative to the first."""

    name: str
    between: tuple[str, str]
    type: str
    axis: Array | None
    """(3,) unit, as the designer's sign has it."""
    axis2: Array | None
    point: Array | None
    """(3,) m."""
    pitch: float | None
    """Metres a turn."""
    range: tuple[float, float] | None
    """(lower, upper) rad or m; ±inf for a free side."""
    file: str
    line: int | None


@dataclass(frozen=True)
class Coupling:
    """value(first) = ratio · value(second), in SI values of the two joints."""

    joints: tuple[str, str]
    ratio: float
    file: str
    line: int | None


@dataclass(frozen=True, eq=False)
class Law:
    """A function of time in the manifest's units (degrees or lengths of the manifest for motions,
    N or N·m for efforts): `type` is constant, sine, ramp or table.

    constant: value. sine: offset + amplitude·sin(2π·frequency·t + phase), phase in degrees.
    ramp: offset + rate·t. table: linear between (times, values), held outside.
    """

    type: str
    value: float = 0.0
    amplitude: float = 0.0
    frequency: float = 0.0
    phase: float = 0.0
    offset: float = 0.0
    rate: float = 0.0
    times: tuple[float, ...] = ()
    values: tuple[float, ...] = ()
    file: str | None = None
    """The table's CSV file."""


@dataclass(frozen=True, eq=False)
class Drive:
    """Something that acts on an intended joint, or on a joint as kinform names it."""

    joint: str
    kind: str
    """motion, effort, spring, damper, servo, dc_motor."""
    law: Law | None
    parameters: dict[str, float]
    """Further numbers of the kind (stiffness, damping, rest, kp, …, gear) that are stated, in manifest units."""
    metres_per_unit: float
    file: str
    line: int | None

    def scale(self, rotational: bool) -> float:
        """Factor from the manifest's values of a motion (degrees or lengths) to SI."""
        return math.pi / 180.0 if rotational else self.metres_per_unit


@dataclass(frozen=True, eq=False)
class Load:
    """Force (N) or torque (N·m) on a part at a point, in the world or in the body's frame."""

    part: str
    force: Array | None
    torque: Array | None
    point: Array | None
    """(3,) m, world at the pose of the meshes; None: centre of mass."""
    frame: str
    """"world" (fixed direction) or "body" (turns with the part)."""
    file: str
    line: int | None


@dataclass(frozen=True, eq=False)
class Requirement:
    """A requirement with the keys of its kind, as the manifest gives them."""

    name: str
    kind: str
    values: dict[str, Any]
    file: str
    line: int | None


@dataclass(frozen=True, eq=False)
class Function:
    """All of `[function]`, with the functions of sub-assemblies merged under their prefix."""

    mobility: int | None = None
    mobility_line: int | None = None
    joints: tuple[IntendedJoint, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    drives: tuple[Drive, ...] = ()
    loads: tuple[Load, ...] = ()
    requirements: tuple[Requirement, ...] = ()

    @property
    def stated(self) -> bool:
        """Whether the designer stated anything at all."""
        return self.mobility is not None or bool(
            self.joints or self.couplings or self.drives or self.loads or self.requirements
        )


@dataclass(frozen=True)
class InitialValue:
    """Initial position and velocity of a joint in manifest units; 0 is the pose of the meshes."""

    joint: str
    position: float
    velocity: float
    metres_per_unit: float
    file: str
    line: int | None


@dataclass(frozen=True, eq=False)
class SimulationRequest:
    """`[simulation]`; seconds, m/s²."""

    level: str | None = None
    duration: float = 1.0
    step: float = 0.01
    gravity: Array = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    initial: tuple[InitialValue, ...] = ()
    file: str | None = None
    line: int | None = None
    assumed: tuple[str, ...] = ()
    """Which of duration, step and gravity the manifest does not state, sorted."""
