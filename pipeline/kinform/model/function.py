"""Function: what the designer wants. SI and radians, world frame, except where a unit cannot be known yet."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np

from kinform.frozen import dataclass
from kinform.model.arrays import Array
from kinform.model.kinematics import JointType
from kinform.model.quantities import XYZ, Direction, Metres, Place, Ratio, columns
from kinform.model.sensors import Sensor
from kinform.model.springs import StatedSpring

Stated = Annotated[float, "unit of the manifest"]
"""Where only the joint says whether it is an angle or a length."""
LawType = Literal["constant", "sine", "ramp", "table"]
DriveKind = Literal["motion", "effort", "spring", "damper", "friction", "servo", "dc_motor"]
LoadFrame = Literal["world", "body"]
"""world: the direction is fixed. body: it turns with the part."""
SimulationLevel = Literal["functional", "kinematic", "dynamic"]
StopsAt = Literal["range", "found", ""]
"""range: joints stop at the ends of their stated ranges. found: where meshes meet. "": they pass both."""
PASSIVE: tuple[DriveKind, ...] = ("spring", "damper", "friction")
"""Kinds of drives that only answer to motion."""
LOSING = {"efficiency", "efficiency_back", "rotor_friction"}
"""Parameters of motors by which they lose power."""
StatedRate = Annotated[float, "unit of the manifest a second"]


@dataclass(frozen=True, eq=False)
class IntendedJoint:
    """A joint as the designer wants it, between two parts or groups; values are of the second
    about `axis` relative to the first."""

    name: str
    between: Annotated[tuple[str, str], columns("between_a", "between_b")]
    type: JointType
    axis: Direction | None
    """(3,) unit, as the designer's sign has it."""
    axis2: Direction | None
    point: Place | None
    """(3,) m."""
    pitch: Metres | None
    """Metres a turn."""
    range: Annotated[tuple[float, float], "rad or m", columns("range_lower", "range_upper")] | None
    """(lower, upper) rad or m; ±inf for a free side."""
    file: str
    line: int | None
    closure: bool = False
    """It only closes a loop at its point: contact that lets the bodies do some of its motion does not contradict it."""
    named: int = 2
    """How many of its sides the designer names, the first ones: the others are "" until contact has told them."""

    @property
    def as_named(self) -> IntendedJoint:
        """The joint as the designer gives it, without the sides that contact told."""
        first, second = self.between
        names = (first if self.named > 0 else "", second if self.named > 1 else "")
        return self if names == self.between else replace(self, between=names)


@dataclass(frozen=True)
class Coupling:
    """value(first) = ratio · value(second) + Σ others[name] · value(name), in SI values of the joints."""

    joints: Annotated[tuple[str, str], columns("joint_a", "joint_b")]
    ratio: Ratio
    file: str
    line: int | None
    others: dict[str, Any] = field(default_factory=dict)
    """By the names of further joints, of trains with three and more: the ratio of each."""
    efficiency: Ratio = 1.0
    """Of two joints: share of the work put in at the first that comes out at the second."""
    efficiency_back: Ratio = 1.0
    """Of the work put in at the second, at the first; zero or less: it locks itself."""

    @property
    def lossy(self) -> bool:
        """Whether work is lost in it."""
        return self.efficiency != 1.0 or self.efficiency_back != 1.0

    @property
    def terms(self) -> dict[str, float]:
        """By joint what multiplies its value in the sum that is zero: 1 at the first."""
        return {self.joints[0]: 1.0, self.joints[1]: -self.ratio} | {
            name: -float(ratio) for name, ratio in self.others.items()
        }

    @property
    def every(self) -> tuple[str, ...]:
        """Names of all its joints, in the order in which they are stated."""
        return (*self.joints, *self.others)


@dataclass(frozen=True, eq=False)
class Law:
    """A function of time in the manifest's units (degrees or lengths of the manifest for motions,
    N or N·m for efforts): `type` is constant, sine, ramp or table.

    constant: value. sine: offset + amplitude·sin(2π·frequency·t + phase), phase in degrees.
    ramp: offset + rate·t. table: linear between (times, values), held outside.
    """

    type: LawType
    value: Stated = 0.0
    amplitude: Stated = 0.0
    frequency: Annotated[float, "Hz"] = 0.0
    phase: Annotated[float, "deg"] = 0.0
    offset: Stated = 0.0
    rate: StatedRate = 0.0
    times: tuple[Annotated[float, "s"], ...] = ()
    values: tuple[Stated, ...] = ()
    file: str | None = None
    """The table's CSV file."""


@dataclass(frozen=True, eq=False)
class Drive:
    """Something that acts on an intended joint, or on a joint as kinform names it."""

    joint: str
    kind: DriveKind
    law: Law | None
    parameters: dict[str, float]
    """Further numbers of the kind (stiffness, damping, rest, kp, …, gear) that are stated, in manifest units."""
    metres_per_unit: Metres
    file: str
    line: int | None
    freedom: str = ""
    """Which freedom of the joint, as `kinform.function.FREEDOMS` calls them; "": the one that it has, or is left."""

    def scale(self, rotational: bool) -> float:
        """Factor from the manifest's values of a motion (degrees or lengths) to SI."""
        return math.pi / 180.0 if rotational else self.metres_per_unit


ARMS = frozenset({"radius", "thrust_radius", "length", "flank"})
"""Keys of a friction that say where what presses in a joint rubs."""
_TURN, _SLIDE = frozenset({"radius", "thrust_radius", "length"}), frozenset({"length"})
_ARMS_OF = {
    ("revolute", "turn"): _TURN,
    ("prismatic", "slide"): _SLIDE,
    ("cylindrical", "turn"): _TURN,
    ("cylindrical", "slide"): _SLIDE,
    ("screw", "turn"): frozenset({"radius", "flank"}),
}


def friction_arms(joint: str, freedom: str = "") -> frozenset[str]:
    """Those of `ARMS` that act in a joint of this type, on this freedom; "": on any that it has."""
    every = (arms for (kind, name), arms in _ARMS_OF.items() if kind == joint and freedom in ("", name))
    return frozenset().union(*every)


@dataclass(frozen=True)
class MaterialFriction:
    """Coulomb friction between two materials."""

    materials: Annotated[tuple[str, str], columns("material_a", "material_b")]
    coefficient: Ratio
    """In motion."""
    static: Ratio
    """At rest."""
    file: str
    line: int | None
    prefix: str = ""
    """Of the names of the parts between which it holds: of the sub-assembly that states it."""


@dataclass(frozen=True, eq=False)
class Load:
    """Force (N) or torque (N·m) on a part at a point, in the world or in the body's frame."""

    part: str
    force: Annotated[Array, "N", XYZ] | None
    torque: Annotated[Array, "N·m", XYZ] | None
    point: Place | None
    """(3,) m, world at the pose of the meshes; None: centre of mass."""
    frame: LoadFrame
    file: str
    line: int | None
    law: Law | None = None
    """What force and torque are multiplied by; None: 1."""


@dataclass(frozen=True, eq=False)
class Requirement:
    """A requirement with the keys of its kind, as the manifest gives them."""

    name: str
    kind: str
    values: dict[str, Any]
    file: str
    line: int | None

    @property
    def when_run(self) -> bool:
        """Whether it is asked about only when there is a run."""
        return bool(self.values.get("when_run", False))


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
    frictions: tuple[MaterialFriction, ...] = ()
    """Of `[[friction]]`."""
    springs: tuple[StatedSpring, ...] = ()
    complete: tuple[str, ...] = ()
    """Prefixes of the manifests whose joints are all that are meant to move; "" for the top one."""

    @cached_property
    def named_joints(self) -> dict[str, IntendedJoint]:
        """The joints by their names."""
        return {str(joint.name): joint for joint in self.joints}

    @property
    def as_named(self) -> Function:
        """The same without the sides of joints that contact told."""
        return replace(self, joints=tuple(joint.as_named for joint in self.joints))

    def with_sides(self, sides: Mapping[str, tuple[str, str]]) -> Function:
        """The same with the sides of some joints, by their names."""
        joints = (replace(one, between=sides[one.name]) if one.name in sides else one for one in self.joints)
        return replace(self, joints=tuple(joints))

    @property
    def driven(self) -> bool:
        """Whether anything is to be moved: springs and dampers alone move nothing."""
        return any(drive.kind not in PASSIVE for drive in self.drives)

    @property
    def rubs(self) -> bool:
        """Whether friction is stated, or what gears and rotors of motors lose."""
        drives = any(drive.kind == "friction" or LOSING & drive.parameters.keys() for drive in self.drives)
        return drives or any(coupling.lossy for coupling in self.couplings)

    @property
    def stated(self) -> bool:
        """Whether the designer stated anything at all."""
        return self.mobility is not None or bool(
            self.joints or self.couplings or self.drives or self.loads or self.springs or self.requirements
        )


@dataclass(frozen=True)
class InitialValue:
    """Initial position and velocity of a joint in manifest units; 0 is the pose of the meshes."""

    joint: str
    position: Stated
    velocity: StatedRate
    metres_per_unit: Metres
    file: str
    line: int | None
    freedom: str = ""
    """As of `Drive`."""
    solved: bool = False
    """Whether the position is solved for: what loops leave of it, followed from the pose of the meshes."""


@dataclass(frozen=True, eq=False)
class SimulationRequest:
    """`[simulation]`; seconds, m/s²."""

    level: SimulationLevel | None = None
    duration: Annotated[float, "s"] = 1.0
    step: Annotated[float, "s"] = 0.01
    gravity: Annotated[Array, "m/s²", XYZ] = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    initial: tuple[InitialValue, ...] = ()
    file: str | None = None
    line: int | None = None
    partial: bool = False
    """Whether joints that are not understood are held while the rest moves."""
    stops: StopsAt = ""
    restitution: Ratio = 0.0
    """Of these stops: the share of the speed that an impact leaves."""
    assumed: tuple[str, ...] = ()
    """Which of duration, step and gravity the manifest does not state, sorted."""
    sensors: tuple[Sensor, ...] = ()
