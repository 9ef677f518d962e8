"""The shape of the exported port model: its JSON Schema, published in docs/, and what reading is checked against."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

__all__ = [
    "SCHEMA",
    "BodyData",
    "ComponentData",
    "ConstantLaw",
    "ControllerData",
    "CountData",
    "DamperData",
    "DcMotorData",
    "EffortData",
    "EndStopData",
    "ExposedData",
    "GearData",
    "GroundData",
    "JointData",
    "LawData",
    "LoadData",
    "MotionData",
    "NodeData",
    "PortData",
    "PortModel",
    "RampLaw",
    "ServoData",
    "SineLaw",
    "SpringDamperData",
    "SpringData",
    "StartData",
    "SystemData",
    "TableLaw",
    "VoltageControllerData",
    "VoltageData",
    "schema",
]

SCHEMA = "kinform/port-model/1"

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Matrix = Annotated[list[Vector], Field(min_length=3, max_length=3)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True, use_attribute_docstrings=True)


class ConstantLaw(_Strict):
    """`level` for ever."""

    law: Literal["constant"] = "constant"
    level: float


class RampLaw(_Strict):
    """offset + slope·t."""

    law: Literal["ramp"] = "ramp"
    offset: float
    slope: float


class SineLaw(_Strict):
    """offset + amplitude·sin(speed·t + phase); rad/s, rad."""

    law: Literal["sine"] = "sine"
    offset: float
    amplitude: float
    speed: float
    phase: float


class TableLaw(_Strict):
    """Straight lines between (times, levels), held outside."""

    law: Literal["table"] = "table"
    times: list[float]
    levels: list[float]


LawData = Annotated[ConstantLaw | RampLaw | SineLaw | TableLaw, Field(discriminator="law")]


class _Named(_Strict):
    name: str
    """Unique in the model."""
    subject: str
    """What the user calls it."""


class GroundData(_Named):
    """At rest. Port: frame."""

    kind: Literal["ground"] = "ground"


class BodyData(_Named):
    """Newton and Euler. World frame at the pose of the meshes. Port: frame."""

    kind: Literal["rigid_body"] = "rigid_body"
    mass: float | None
    centre_of_mass: Vector | None
    inertia: Matrix | None


class JointData(_Named):
    """What a joint leaves free, in the world at the pose of the meshes. Ports: a, b, and shaft unless fixed."""

    kind: Literal["joint"] = "joint"
    type: Literal["fixed", "revolute", "prismatic", "cylindrical", "spherical", "planar", "screw", "universal"]
    axis: Vector | None
    point: Vector | None
    axis2: Vector | None
    pitch: float | None


class MotionData(_Named):
    """The joint's value follows the law. Port: shaft."""

    kind: Literal["motion"] = "motion"
    law: LawData


class EffortData(_Named):
    """The effort follows the law. Port: shaft."""

    kind: Literal["effort"] = "effort"
    law: LawData


class SpringData(_Named):
    """effort = stiffness · (rest − value). Port: shaft."""

    kind: Literal["spring"] = "spring"
    stiffness: float
    rest: float


class DamperData(_Named):
    """effort = −damping · rate. Port: shaft."""

    kind: Literal["damper"] = "damper"
    damping: float


class EndStopData(_Named):
    """The value stays between the limits, a null side is free; impacts are without rebound. Port: shaft."""

    kind: Literal["end_stop"] = "end_stop"
    lower: float | None
    upper: float | None


class ControllerData(_Strict):
    """kp · e + ki · ∫e + kd · ė, within ±limit (null: any)."""

    kp: float
    ki: float
    kd: float
    limit: float | None


class ServoData(_Named):
    """The effort is the controller's output for the target. Port: shaft."""

    kind: Literal["servo"] = "servo"
    target: LawData
    controller: ControllerData


class DcMotorData(_Named):
    """L di/dt = V − R i − k g ω, effort = k g i. Ports: shaft, terminals."""

    kind: Literal["dc_motor"] = "dc_motor"
    resistance: float
    inductance: float
    constant: float
    gear: float


class VoltageData(_Named):
    """The voltage across the terminals follows the law. Port: terminals."""

    kind: Literal["voltage_source"] = "voltage_source"
    law: LawData


class VoltageControllerData(_Named):
    """The voltage is the controller's output for the target of the shaft's value. Ports: shaft, terminals."""

    kind: Literal["voltage_controller"] = "voltage_controller"
    target: LawData
    controller: ControllerData


class SpringDamperData(_Named):
    """stiffness · (length − rest) + damping · d(length)/dt between two points. Ports: a, b."""

    kind: Literal["spring_damper"] = "spring_damper"
    point: Vector
    other: Vector
    stiffness: float
    damping: float
    rest: float


class GearData(_Named):
    """value at a = ratio · value at b. Ports: a, b. Of teeth the pitch point, and the directions in which either
    flank of those at a pushes those at b, and the values at a between which there are teeth."""

    kind: Literal["gear"] = "gear"
    ratio: float
    pitch_point: Vector | None = None
    flank: Vector | None = None
    back: Vector | None = None
    lower: float | None = None
    upper: float | None = None


class LoadData(_Named):
    """A given wrench on a body at a point; `turning` with the body. Port: frame."""

    kind: Literal["load"] = "load"
    force: Vector
    torque: Vector
    point: Vector
    turning: bool


class PortData(_Strict):
    """A port of a component."""

    component: str
    port: str


class NodeData(_Strict):
    """Ports that meet: across variables equal, through variables summing to zero."""

    size: int
    """Across variables; as many through variables."""
    ports: list[PortData]


class ExposedData(_Strict):
    """A port of a system: the node inside in which a port of a component is."""

    name: str
    component: str
    port: str


class CountData(_Strict):
    """Unknowns and equations at the level of rates and efforts."""

    unknowns: int
    equations: int


class SystemData(_Named):
    """Components and nodes, to any depth; from outside a component with the ports that it exposes."""

    kind: Literal["system"] = "system"
    prefixed: bool
    """Whether names inside get the system's in front where levels are left out; else they are unique already."""
    components: list[ComponentData]
    nodes: list[NodeData]
    ports: list[ExposedData] = []
    count: CountData
    """Of this level: a system inside counts as one component."""


ComponentData = Annotated[
    GroundData
    | BodyData
    | JointData
    | MotionData
    | EffortData
    | SpringData
    | DamperData
    | GearData
    | LoadData
    | EndStopData
    | ServoData
    | DcMotorData
    | VoltageData
    | VoltageControllerData
    | SpringDamperData
    | SystemData,
    Field(discriminator="kind"),
]


class StartData(_Strict):
    """Coordinates and rates of a joint at time zero; 0 is the pose of the meshes."""

    joint: str
    """Name of the component."""
    position: list[float]
    velocity: list[float]


class PortModel(_Strict):
    """The device as components with ports, joined at nodes. SI units, radians, quaternions wxyz."""

    model_config = ConfigDict(title=SCHEMA)

    schema_name: Literal["kinform/port-model/1"] = Field(alias="schema")
    name: str
    gravity: Vector
    components: list[ComponentData]
    nodes: list[NodeData]
    ports: list[ExposedData] = []
    """Where the whole is a system to be put into others."""
    start: list[StartData]
    count: CountData
    """Of the network without levels."""
    missing: list[str]
    """What the design has and the model has not, in sentences."""


def schema() -> dict[str, Any]:
    """JSON Schema of the file."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **PortModel.model_json_schema(by_alias=True)}
