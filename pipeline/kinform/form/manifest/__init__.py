"""The manifest, schema 1, as pydantic tables. Types and shapes only; see `form.tables` for why."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from kinform.form.manifest import check, function, parts
from kinform.form.manifest.check import CheckTable
from kinform.form.manifest.function import WHICH_FREEDOM, FreedomName, FunctionTable
from kinform.form.manifest.parts import (
    AssemblyTable,
    Assume,
    Fasteners,
    FrictionTable,
    Group,
    Material,
    Part,
    Subassembly,
    TolerancesTable,
)
from kinform.form.manifest.sensors import Sensor
from kinform.form.tables import Finite, Positive, Table, Vector

__all__ = [
    "Initial",
    "Manifest",
    "SimulationTable",
    "check",
    "function",
    "json_schema",
    "parts",
]


class Initial(Table):
    """`[simulation.initial.JOINT]`."""

    position: Finite | Literal["closest"] = Field(
        0.0,
        description='degrees or lengths; 0 is the pose of the meshes. "closest": as the loops have it for the other '
        "values, followed from there",
    )
    velocity: Finite = Field(0.0, description="degrees or lengths a second")
    freedom: FreedomName | None = Field(None, description=WHICH_FREEDOM)


class SimulationTable(Table):
    """`[simulation]`."""

    level: Literal["functional", "kinematic", "dynamic"] | None = Field(
        None, description="default the highest that is known"
    )
    duration: Positive = Field(1.0, description="seconds")
    step: Positive = Field(0.01, description="seconds between outputs")
    gravity: Vector = Field([0.0, 0.0, -9.81], description="m/s², whatever the units of the file")
    partial: bool = Field(
        False,
        description="hold the joints that are not understood, and move the rest: what that shows is not verified",
    )
    stops: Literal["range", "found"] | None = Field(
        None,
        description="joints with one freedom stop at the ends of their stated ranges, or, with found, where parts meet "
        "when each is moved from the pose of the meshes; default they pass them",
    )
    restitution: Annotated[float, Field(ge=0.0, le=1.0)] = Field(
        0.0, description="of these stops: share of the speed that an impact leaves"
    )
    initial: dict[str, Initial] = Field({}, description="by name of a function.joint, or as kinform names it")
    sensor: list[Sensor] = Field([], description="points, bodies and joints to follow")


class Manifest(Table):
    """A kinform manifest, schema 1."""

    schema_: int = Field(alias="schema", ge=1, le=1, description="version of this format: 1")
    assembly: AssemblyTable = Field(description="name, units and ground")
    materials: dict[str, Material] = Field({}, description="materials by name")
    friction: list[FrictionTable] = Field([], description="Coulomb friction between materials")
    part: list[Part] = Field([], description="the parts")
    group: list[Group] = Field([], description="parts that are fastened together")
    subassembly: list[Subassembly] = Field([], description="other manifests, placed as a whole")
    assume: list[Assume] = Field([], description="what the user overrides")
    tolerances: TolerancesTable = Field(
        default_factory=lambda: TolerancesTable.model_validate({}), description="lengths and angles that decide"
    )
    fasteners: Fasteners = Field(
        default_factory=lambda: Fasteners.model_validate({}), description="fastening by suggestion"
    )
    function: FunctionTable | None = Field(None, description="what the device is for")
    simulation: SimulationTable | None = Field(None, description="the motion to simulate")
    check: CheckTable | None = Field(None, description="which rules run, their severities, and what is ignored")


def json_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the manifest, for editors."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | Manifest.model_json_schema()
