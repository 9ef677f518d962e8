"""json: the port model as data, its JSON Schema (published in docs/), and reading it back.

The tables of the file follow from the records of `kinform.behaviour`: `kind`, as `kind_of` calls it, and a key
for each field. Written by hand is only what JSON says in another form: nodes and exposed ports by name, the geometry of
a joint beside its type, and the whole. Numbers are doubles in shortest decimal form, so that reading gives an equal
model, bit by bit.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_type_hints

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, create_model

from kinform.behaviour import Component, Gear, JointComponent, Node, RigidBody, Signal, System, count, flat
from kinform.behaviour.components import COMPONENTS, kind_of
from kinform.behaviour.joints import KINDS, JointGeometry
from kinform.behaviour.shafts import Controller
from kinform.behaviour.signals import LAWS, law_of
from kinform.errors import InputError, Problem
from kinform.exports.exported import Exported
from kinform.exports.model import ExportModel
from kinform.exports.names import FILES, identifiers
from kinform.foundation.escapes import json_text
from kinform.model.arrays import Array

SCHEMA = "kinform/port-model/1"

KEYS = {"signal": "law", "knots": "times"}
"""Keys of fields that are called otherwise in the file."""
DESCRIPTIONS = {"name": "Unique in the model.", "subject": "What the user calls it."}

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
Matrix = Annotated[list[Vector], Field(min_length=3, max_length=3)]


def export(model: ExportModel) -> Exported:
    """One file with the port model."""
    starts = []
    for joint in model.system.joints:
        position, velocity = model.coordinates(joint.subject)
        starts.append({"joint": joint.name, "position": position.tolist(), "velocity": velocity.tolist()})
    text = write(model.nested, model.name, gravity=model.gravity, start=starts, missing=model.missing)
    name = identifiers([model.name], FILES)[model.name]
    return Exported({f"{name}.json": text.encode()}, model.missing)


def write(
    system: System,
    name: str,
    *,
    gravity: Sequence[float] | Array = (0.0, 0.0, -9.81),
    start: Sequence[Mapping[str, Any]] = (),
    missing: Sequence[str] = (),
) -> str:
    """The text of the file with a system of any depth, called `name`, under gravity (3,) m/s².

    `start` and `missing` as in the schema. Raises ValueError for signals and components that are none of kinform's,
    and for laws that contain a value that is not finite.
    """
    whole = {
        "schema": SCHEMA,
        "name": name,
        "gravity": [float(value) for value in gravity],
        **network(system),
        "start": list(start),
        "count": _counts(flat(system)),
        "missing": list(missing),
    }
    return json_text(json.dumps(whole, indent=1, ensure_ascii=False, allow_nan=False)) + "\n"


def read(text: str | bytes) -> System:
    """The components and nodes in a file that `export` or `write` wrote. Raises InputError for anything else."""
    try:
        return _system(PortModel.model_validate_json(text))
    except ValidationError as error:
        raise InputError(
            Problem(f"{'.'.join(map(str, item['loc']))}: {item['msg']}", remedy="see the schema of the port model")
            for item in error.errors(include_url=False)
        ) from error
    except ValueError as error:
        raise InputError([Problem(str(error), remedy="export the model again")]) from error


def schema() -> dict[str, Any]:
    """JSON Schema of the file."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **PortModel.model_json_schema(by_alias=True)}


def network(system: System) -> dict[str, Any]:
    """Components, nodes, and the ports that the system exposes where it does. Raises ValueError as `write` does."""
    ports = [{"name": port, "component": c, "port": p} for port, (c, p) in system.exposed]
    return {
        "components": [_written(component) for component in system.components],
        "nodes": [
            {"size": node.size, "ports": [{"component": c, "port": p} for c, p in node.ports]} for node in system.nodes
        ],
        **({"ports": ports} if ports else {}),
    }


def _written(component: Component) -> dict[str, Any]:
    head = {"name": component.name, "subject": component.subject, "kind": kind_of(component)}
    if isinstance(component, System):
        return head | {"prefixed": component.prefixed, **network(component), "count": _counts(component)}
    if isinstance(component, JointComponent):
        return head | {"type": component.kind.name} | _values_of(component.geometry)
    return head | _values_of(component)


def _read(table: Any) -> Component:
    if isinstance(table, SystemTable):
        return _system(table, table.name, table.subject, table.prefixed)
    if table.kind != "joint":
        return COMPONENTS[table.kind](**_fields_of(COMPONENTS[table.kind], table))
    kind, geometry = KINDS[table.type], JointGeometry(**_fields_of(JointGeometry, table))
    kind.chain(geometry)  # raises where the geometry lacks something
    return JointComponent(table.name, table.subject, kind, geometry)


def _system(table: PortModel | SystemTable, name: str = "", subject: str = "", prefixed: bool = True) -> System:
    components = tuple(_read(component) for component in table.components)
    nodes = tuple(Node(tuple((p.component, p.port) for p in node.ports), node.size) for node in table.nodes)
    exposed = tuple((port.name, (port.component, port.port)) for port in table.ports)
    return System(components, nodes, name, subject, exposed, prefixed)


def _counts(system: System) -> dict[str, int]:
    counts = count(system)
    return {"unknowns": counts.unknowns, "equations": counts.equations}


def _written_law(signal: Signal) -> dict[str, Any]:
    return {"law": law_of(signal), **_values_of(signal)}


def _read_law(table: Any) -> Signal:
    if table.law == "table" and (len(table.times) != len(table.levels) or len(table.times) < 2):
        raise ValueError("a table needs two or more times and as many levels")
    return LAWS[table.law](**_fields_of(LAWS[table.law], table))


@dataclasses.dataclass(frozen=True)
class _Entry:
    """How a field of a record stands in the file."""

    field: str
    type: Any
    """Of its key, which pydantic checks."""
    written: Callable[[Any], Any] = lambda value: value
    read: Callable[[Any], Any] = lambda value: value
    sparse: bool = False
    """Left out where it is null, or a count that is the usual one."""
    usual: Any = ...
    """What it is where a file does not say it; `...`: it must."""

    @property
    def key(self) -> str:
        return KEYS.get(self.field, self.field)


@cache
def _entries(record: type) -> tuple[_Entry, ...]:
    """Of the fields of a record; knots of smooth signals, which have none, do not stand in the file."""
    hints = get_type_hints(record)
    fields = [field for field in dataclasses.fields(record) if field.default != ()]
    return tuple(_entry(record, field, hints[field.name]) for field in fields)


def _entry(record: type, field: dataclasses.Field[Any], hint: Any) -> _Entry:
    """By the type of the field: arrays are lists, and what is not known or not bounded is null."""
    name = field.name
    sparse = (record is Gear and field.default is not dataclasses.MISSING) or name in ("current_limit", "speed_limit")
    if hint is Signal and field.default is not dataclasses.MISSING:
        steady = field.default
        return _Entry(
            name, LawTable | None, lambda signal: None if signal == steady else _written_law(signal),
            lambda table: steady if table is None else _read_law(table), True,
        )  # fmt: skip
    if hint is Signal:
        return _Entry(name, LawTable, _written_law, _read_law)
    if hint is Controller:
        return _Entry(name, ControllerTable, _values_of, lambda table: Controller(**_fields_of(Controller, table)))
    if hint == dict[str, float]:
        return _Entry(name, hint | None, lambda ratios: ratios or None, lambda ratios: ratios or {}, True)
    if hint == tuple[float, ...]:
        return _Entry(name, list[float], list, tuple)
    if hint == Array and record is RigidBody:
        square = name == "inertia"
        unknown = np.full((3, 3) if square else 3, np.nan)
        kind: Any = (Matrix if square else Vector) | None
        return _Entry(name, kind, _list, lambda rows: unknown.copy() if rows is None else np.array(rows))
    if hint == Array and name == "axes":
        return _Entry(name, Matrix, _list, np.array)
    if hint in (Array, Array | None):
        kind = Vector if hint == Array else Vector | None
        return _Entry(name, kind, _list, lambda row: None if row is None else np.array(row), sparse)
    if isinstance(field.default, float) and math.isinf(field.default):
        free = field.default
        return _Entry(name, float | None, _bound, lambda value: free if value is None else value, sparse)
    if hint is int and field.default is not dataclasses.MISSING:
        usual = field.default
        written: Callable[[Any], Any] = lambda value: None if value == usual else value
        return _Entry(name, int | None, written, lambda value: usual if value is None else value, True)
    if isinstance(field.default, float):
        return _Entry(name, hint, usual=field.default)
    return _Entry(name, hint)


def _list(array: Array | None) -> Any:
    return None if array is None or not np.all(np.isfinite(array)) else array.tolist()


def _bound(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _values_of(record: Any) -> dict[str, Any]:
    """The values of a record by their keys in the file."""
    values = ((entry, entry.written(getattr(record, entry.field))) for entry in _entries(record.__class__))
    return {entry.key: value for entry, value in values if value is not None or not entry.sparse}


def _fields_of(record: type, table: Any) -> dict[str, Any]:
    """The fields of a record, out of a table that has its keys."""
    return {entry.field: entry.read(getattr(table, entry.key)) for entry in _entries(record)}


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, strict=True)


class _Documented(_Strict):
    model_config = ConfigDict(use_attribute_docstrings=True)


def _table_of(record: type, *parts: type, **keys: Any) -> type[_Strict]:
    """The table of a record: these keys, then one for each field of the record, or of its `parts` where they are
    given."""
    for entry in (entry for part in parts or (record,) for entry in _entries(part)):
        default = None if entry.sparse else entry.usual
        keys[entry.key] = (entry.type, Field(default, description=DESCRIPTIONS.get(entry.key)))
    return create_model(record.__name__, __base__=_Strict, __doc__=record.__doc__, **keys)


def _named(name: str) -> tuple[Any, str]:
    """Type and default of a key that always has this value."""
    return Literal.__getitem__(name), name


class PortTable(_Documented):
    """A port of a component."""

    component: str
    port: str


class NodeTable(_Documented):
    """Ports that meet: across variables equal, through variables summing to zero."""

    size: int
    """Across variables; as many through variables."""
    ports: list[PortTable]


class ExposedTable(_Documented):
    """A port of a system: the node inside in which a port of a component is."""

    name: str
    component: str
    port: str


class CountTable(_Documented):
    """Unknowns and equations at the level of rates and efforts."""

    unknowns: int
    equations: int


class SystemTable(_Documented):
    """Components and nodes, to any depth; from outside a component with the ports that it exposes."""

    name: str
    """Unique in the model."""
    subject: str
    """What the user calls it."""
    kind: Literal["system"] = "system"
    prefixed: bool
    """Whether names inside get the system's in front where levels are left out; else they are unique already."""
    components: list[ComponentTable]
    nodes: list[NodeTable]
    ports: list[ExposedTable] = []
    count: CountTable
    """Of this level: a system inside counts as one component."""


class StartTable(_Documented):
    """Coordinates and rates of a joint at time zero; 0 is the pose of the meshes."""

    joint: str
    """Name of the component."""
    position: list[float]
    velocity: list[float]


class PortModel(_Documented):
    """The device as components with ports, joined at nodes. SI units, radians, quaternions wxyz."""

    model_config = ConfigDict(title=SCHEMA)

    schema_name: Literal["kinform/port-model/1"] = Field(alias="schema")
    name: str
    gravity: Vector
    components: list[ComponentTable]
    nodes: list[NodeTable]
    ports: list[ExposedTable] = []
    """Where the whole is a system to be put into others."""
    start: list[StartTable]
    count: CountTable
    """Of the network without levels."""
    missing: list[str]
    """What the design has and the model has not, in sentences."""


def _one_of(tables: Iterable[type[_Strict]], key: str) -> Any:
    """Any of the tables, told apart by the value of a key."""
    return Annotated[reduce(or_, tables), Field(discriminator=key)]


def _table_of_component(kind: str) -> type[_Strict]:
    record, tag = COMPONENTS[kind], _named(kind)
    if record is System:
        return SystemTable
    if record is JointComponent:
        types = Literal.__getitem__(tuple(KINDS))
        return _table_of(record, Component, JointGeometry, kind=tag, type=(types, ...))
    return _table_of(record, kind=tag)


LawTable = _one_of((_table_of(record, law=_named(law)) for law, record in LAWS.items()), "law")
ControllerTable = _table_of(Controller)
if TYPE_CHECKING:
    ComponentTable = _Strict
else:
    ComponentTable = _one_of(map(_table_of_component, COMPONENTS), "kind")
