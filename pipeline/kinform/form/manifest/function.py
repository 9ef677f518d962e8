"""Tables that state function: intended joints, couplings, drives with their laws, loads."""

from __future__ import annotations

from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from kinform.form.manifest.springs import Bushing, GasSpring, PointSpring
from kinform.form.tables import (
    ROWS_MOST,
    Finite,
    JointType,
    Name,
    NonNegative,
    Positive,
    Reference,
    Table,
    Vector,
)
from kinform.requirements import all_kinds
from kinform.requirements.table import RequirementTable

COUPLED_MOST = 16
"""Joints of one stated coupling: a compound planetary train has at most as many; each is a column of its row."""


Share = Annotated[Finite, Field(ge=1e-9, le=1.0)]
"""Of power that comes out. One over it is a number that can be worked with; of a nanowatt in a watt nothing is left."""


class IntendedJointTable(Table):
    """`[[function.joint]]`: values are of the second of `between` about `axis`, relative to the first."""

    name: Name = Field(description="name of the joint, any text but '/'")
    between: Annotated[list[Reference], Field(max_length=2)] = Field(
        [],
        description="a part, group or sub-assembly of each side; each stands for the body that contains it. One of "
        "them, or none, where contact at the axis leaves only one way of parting",
    )
    type: JointType = Field(description="type of the joint")
    axis: Vector | None = Field(None, description="direction of the axis; the normal of a planar joint")
    axis2: Vector | None = Field(None, description="second axis of a universal joint")
    point: Vector | None = Field(None, description="point on the axis; the centre of a spherical joint")
    pitch: Finite | None = Field(None, description="length a turn of a screw, right-handed positive")
    range: Annotated[list[float], Field(min_length=2, max_length=2)] | None = Field(
        None, description="[lower, upper] in degrees (prismatic: lengths); inf for a free side"
    )
    closure: bool = Field(
        False, description="it only closes a loop at its point, whatever joint does that: the type is no more than that"
    )


class Coupling(Table):
    """`[[function.coupling]]`: value(first) = ratio · value(second), or a sum over more joints."""

    joints: Annotated[list[Reference], Field(min_length=2, max_length=COUPLED_MOST)] = Field(
        description="two joints of [[function.joint]]; three and more for planetary trains and differentials"
    )
    ratio: Finite | Annotated[list[Finite], Field(min_length=1, max_length=COUPLED_MOST - 1)] = Field(
        description="value(first) / value(second), values in degrees or lengths; not zero. With three joints and more "
        "a list: value(first) = ratio[0] · value(second) + ratio[1] · value(third) + …"
    )
    efficiency: Share = Field(
        1.0, description="of two joints: share of the work put in at the first that comes out at the second"
    )
    efficiency_back: Annotated[Finite, Field(le=1.0)] | None = Field(
        None,
        description="of the work put in at the second, at the first; zero or less: the second cannot drive the first. "
        "Default 2 - 1 / efficiency: teeth that rub alike both ways",
    )


class Constant(Table):
    """A constant."""

    type: Literal["constant"]
    value: Finite = Field(description="the constant")


class Sine(Table):
    """offset + amplitude·sin(2π·frequency·t + phase)."""

    type: Literal["sine"]
    amplitude: Finite = Field(description="greatest deviation from offset")
    frequency: NonNegative = Field(description="Hz")
    phase: Finite = Field(0.0, description="degrees")
    offset: Finite = Field(0.0, description="mean value")


class Ramp(Table):
    """offset + rate·t."""

    type: Literal["ramp"]
    rate: Finite = Field(description="change a second")
    offset: Finite = Field(0.0, description="value at time zero")


Column = Annotated[list[Finite], Field(min_length=2, max_length=ROWS_MOST)]


class TimeTable(Table):
    """Linear between rows of time and value, of a CSV file or written here; the first and last value hold outside."""

    type: Literal["table"]
    file: Reference | None = Field(None, description="CSV file of time (s) and value, relative to the manifest")
    times: Column | None = Field(None, description="in place of a file: seconds, ascending")
    values: Column | None = Field(None, description="as many values")


LawTable = Annotated[Constant | Sine | Ramp | TimeTable, Field(discriminator="type")]


FreedomName = Literal["turn", "slide", "turn2", "u", "v", "x", "y", "z"]
WHICH_FREEDOM = (
    "of a joint with several: turn or slide (cylindrical), turn or turn2 (universal), turn, u or v (planar), x, y or z "
    "(spherical); default the one that the rest of the assembly leaves"
)


class _Drive(Table):
    joint: Reference = Field(description="a [[function.joint]], or a joint as kinform names it")
    freedom: FreedomName | None = Field(None, description=WHICH_FREEDOM)


class Motion(_Drive):
    """The joint follows the law (degrees or lengths)."""

    kind: Literal["motion"]
    law: LawTable = Field(description="position over time, degrees or lengths")


class Effort(_Drive):
    """A torque (N·m) or force (N) on the joint."""

    kind: Literal["effort"]
    law: LawTable = Field(description="N·m or N over time")


class Spring(_Drive):
    """A spring towards its rest position."""

    kind: Literal["spring"]
    stiffness: Positive = Field(description="N·m/rad or N/m, whatever the units of the file")
    rest: Finite = Field(0.0, description="position without effort, degrees or lengths")


class Damper(_Drive):
    """A viscous damper."""

    kind: Literal["damper"]
    damping: Positive = Field(description="N·m·s/rad or N·s/m, whatever the units of the file")


class Friction(_Drive):
    """Coulomb friction: the coefficient by what presses in the joint, and what there is without load."""

    kind: Literal["friction"]
    coefficient: NonNegative | None = Field(
        None, description="in motion; default that of the materials in contact, where no effort is stated"
    )
    static: NonNegative | None = Field(None, description="coefficient at rest; default that in motion")
    effort: NonNegative | None = Field(None, description="N·m or N without load, in motion")
    static_effort: NonNegative | None = Field(None, description="N·m or N without load, at rest; default as in motion")
    radius: NonNegative | None = Field(
        None, description="of the journal, mean of a thread; default from the contact; 0: no journal rubs"
    )
    thrust_radius: NonNegative | None = Field(
        None, description="mean radius of the ring that carries thrust; default from the contact; 0: none rubs"
    )
    length: NonNegative | None = Field(
        None,
        description="of journal or guide, about the joint's point; default from the contact; 0: moments across "
        "the axis are carried without friction; of a joint that slides it goes along with the shorter side, or, where "
        "contact does not show which that is, with the second of `between`",
    )
    flank: Annotated[float, Field(ge=0.0, lt=90.0)] | None = Field(
        None, description="degrees: half the angle of a thread; default from the contact"
    )
    least_reactions: bool = Field(
        False,
        description="where redundant constraints share the load that presses, take the least reactions that balance; "
        "default such friction is refused",
    )


CASCADE = "1/s, in place of kp: a loop of speed in one of position; the speed asked for is this times the distance"
FASTEST = "with position_gain: greatest speed asked for, degrees or lengths a second"


class Servo(_Drive):
    """A position controller with limited effort."""

    kind: Literal["servo"]
    law: LawTable = Field(description="target position over time, degrees or lengths")
    kp: Positive | None = Field(None, description="N·m/rad or N/m; or give position_gain")
    kd: NonNegative = Field(0.0, description="N·m·s/rad or N·s/m")
    ki: NonNegative = Field(0.0, description="N·m/(rad·s) or N/(m·s)")
    limit: Positive | None = Field(None, description="greatest effort, N·m or N")
    position_gain: Positive | None = Field(None, description=CASCADE)
    speed_limit: Positive | None = Field(None, description=FASTEST)
    speed_gain: Positive | None = Field(None, description="with position_gain: N·m·s/rad or N·s/m")
    speed_integral: NonNegative = Field(0.0, description="with position_gain: N·m/rad or N/m")


class DcMotor(_Drive):
    """A DC motor with a gear; the voltage is a number, a law, or what a position controller (`kp`) makes of its law."""

    kind: Literal["dc_motor"]
    resistance: Positive = Field(description="ohm")
    inductance: NonNegative = Field(0.0, description="henry")
    constant: Positive = Field(description="N·m/A, which equals V·s/rad")
    gear: Finite = Field(1.0, description="motor turns a turn of the joint; not zero")
    voltage: Finite | None = Field(None, description="volt; or give a law")
    law: LawTable | None = Field(
        None, description="volt over time, in place of voltage; with kp the target position, degrees or lengths"
    )
    current_limit: Positive | None = Field(None, description="greatest current of the supply, ampere")
    kp: Positive | None = Field(None, description="controls the position of the joint: V/rad or V/m")
    kd: NonNegative = Field(0.0, description="V·s/rad or V·s/m")
    ki: NonNegative = Field(0.0, description="V/(rad·s) or V/(m·s)")
    limit: Positive | None = Field(None, description="greatest voltage of the controller")
    position_gain: Positive | None = Field(None, description=CASCADE)
    speed_limit: Positive | None = Field(None, description=FASTEST)
    speed_gain: Positive | None = Field(None, description="with position_gain: V·s/rad or V·s/m")
    speed_integral: NonNegative = Field(0.0, description="with position_gain: V/rad or V/m")
    rotor_inertia: NonNegative = Field(0.0, description="kg·m² about the motor's axis, before the gear")
    rotor_friction: NonNegative = Field(0.0, description="N·m of the motor without load, before the gear")
    efficiency: Share = Field(1.0, description="of the gear: share of the rotor's work that comes out at the joint")
    efficiency_back: Annotated[Finite, Field(le=1.0)] | None = Field(
        None,
        description="of the joint's work, at the rotor; zero or less: the joint cannot drive it. Default "
        "2 - 1 / efficiency: teeth that rub alike both ways",
    )


Drive = Annotated[Motion | Effort | Spring | Damper | Friction | Servo | DcMotor, Field(discriminator="kind")]


class Load(Table):
    """`[[function.load]]`: a force or torque on a part."""

    part: Reference = Field(description="the part that is loaded")
    force: Vector | None = Field(None, description="N")
    torque: Vector | None = Field(None, description="N·m")
    point: Vector | None = Field(
        None, description="where the force acts, at the pose of the meshes; default the centre of mass"
    )
    frame: Literal["world", "body"] = Field("world", description="fixed in the world, or turning with the body")
    law: LawTable | None = Field(None, description="what force and torque are multiplied by over time; default 1")


if TYPE_CHECKING:
    Require = RequirementTable
else:
    Require = Annotated[reduce(or_, [kind.table for kind in all_kinds()]), Field(discriminator="kind")]


class FunctionTable(Table):
    """`[function]`: what the device is for."""

    # The largest mobility that can be stated: more than six times the parts that a design may have.
    mobility: Annotated[int, Field(ge=0, le=1_000_000)] | None = Field(
        None, description="compared with the effective mobility"
    )
    complete: bool = Field(
        False, description="every joint that is meant to move is stated: contact that none of them moves holds"
    )
    joint: list[IntendedJointTable] = Field([], description="intended joints")
    coupling: list[Coupling] = Field([], description="gears, racks and screws between intended joints")
    drive: list[Drive] = Field([], description="what acts on joints")
    load: list[Load] = Field([], description="forces and torques on parts")
    spring: list[PointSpring] = Field([], description="springs and dampers between points of two parts")
    gas_spring: list[GasSpring] = Field([], description="gas springs between points of two parts")
    bushing: list[Bushing] = Field([], description="elastic bearings between two parts")
    require: list[Require] = Field([], description="requirements")
