"""`/behaviour`: the port model as tables: components by kind with their parameters, ports, nodes, systems in systems.

`components` lists all of them, each with the system that it is in (a row of `systems`; row 0 is the whole), its place
there and its place in the network without levels, which is what was simulated; its parameters are the row of the
same name in the table of its kind. `ports` says in which node each port is, `exposed` which ports a system has.
"""

from __future__ import annotations

import dataclasses
from collections import defaultdict
from collections.abc import Iterable
from typing import Any

import h5py

from kinform.behaviour import Behaviour, Component, Node, System, count, flat
from kinform.behaviour.components import Controller, JointComponent
from kinform.behaviour.joints import KINDS, JointGeometry
from kinform.behaviour.kinds import COMPONENTS, kind_of
from kinform.behaviour.nested import arranged
from kinform.behaviour.signals import Constant, Ramp, Signal, Sine, Table
from kinform.results.table import (
    Column,
    flag,
    integer,
    matrix,
    read_ragged,
    read_rows,
    real,
    text,
    vector,
    write_ragged,
    write_rows,
)

__all__ = ["read", "write"]

_CONTROLLER = (
    real("kp", "V or N·m or N, a rad or m"), real("ki", "as kp, a s"), real("kd", "as kp, times s"),
    real("limit", "V or N·m or N"),
)  # fmt: skip
_LAW = (integer("law"),)
_PARAMETERS: dict[str, tuple[Column, ...]] = {
    "ground": (),
    "rigid_body": (real("mass", "kg"), vector("centre_of_mass", "m"), matrix("inertia", "kg·m²")),
    "joint": (text("type"), vector("axis", "1"), vector("point", "m"), vector("axis2", "1"), real("pitch", "m")),
    "motion": _LAW,
    "effort": _LAW,
    "spring": (real("stiffness", "N·m/rad or N/m"), real("rest", "rad or m")),
    "damper": (real("damping", "N·m·s/rad or N·s/m"),),
    "end_stop": (real("lower", "rad or m"), real("upper", "rad or m")),
    "servo": (*_LAW, *_CONTROLLER),
    "dc_motor": (
        real("resistance", "Ω"), real("inductance", "H"), real("constant", "N·m/A"), real("gear", "1 or rad/m"),
    ),
    "voltage_source": _LAW,
    "voltage_controller": (*_LAW, *_CONTROLLER),
    "spring_damper": (
        vector("point", "m"), vector("other", "m"), real("stiffness", "N/m"), real("damping", "N·s/m"),
        real("rest", "m"),
    ),
    "gear": (real("ratio", "1"), vector("pitch_point", "m"), vector("flank", "1"), vector("back", "1"),
        real("lower", "rad or m"), real("upper", "rad or m"),
    ),
    "load": (vector("force", "N"), vector("torque", "N·m"), vector("point", "m"), flag("turning")),
}  # fmt: skip
"""Parameters of each kind; a law is a row of `laws`."""
_ADDED = {"gear": ("pitch_point", "flank", "back", "lower", "upper")}
"""Parameters that files of the same schema may lack, by kind."""
_COMPONENTS = (
    text("name"), text("subject"), text("kind"), integer("system"), integer("place"), integer("flat"),
    integer("row"), integer("equations"),
)  # fmt: skip
_SYSTEMS = (
    text("name"), text("subject"), integer("inside"), integer("place"), flag("prefixed"), integer("unknowns"),
    integer("of_components"), integer("of_nodes"), integer("of_surroundings"),
)  # fmt: skip
_NODES = (integer("system"), integer("size"))
_PORTS = (integer("node"), text("component"), text("port"))
_EXPOSED = (integer("system"), text("port"), text("component"), text("inner"))
_LAWS = (
    text("law"), real("level", "rad, m, N·m, N or V"), real("offset", "as level"), real("slope", "as level, a s"),
    real("amplitude", "as level"), real("speed", "rad/s"), real("phase", "rad"),
)  # fmt: skip
_WHY = (text("subject"), text("reason"))
_SIGNALS: dict[str, tuple[type, tuple[str, ...]]] = {
    "constant": (Constant, ("level",)),
    "ramp": (Ramp, ("offset", "slope")),
    "sine": (Sine, ("offset", "amplitude", "speed", "phase")),
    "table": (Table, ()),
}


def write(group: h5py.Group, behaviour: Behaviour) -> None:
    """Write the model. Raises ValueError for a kind of component or signal that is none of kinform's."""
    place = {component.name: k for k, component in enumerate(behaviour.system.components)}
    rows = _Rows()
    rows.take(behaviour.nested, -1, 0, "", place)
    write_rows(group, "systems", _SYSTEMS, rows.systems)
    write_rows(group, "components", _COMPONENTS, rows.components)
    for kind, columns in _PARAMETERS.items():
        write_rows(group, kind, (text("name"), *columns), rows.kinds[kind])
    write_rows(group, "nodes", _NODES, rows.nodes)
    write_rows(group, "ports", _PORTS, rows.ports)
    write_rows(group, "exposed", _EXPOSED, rows.exposed)
    write_rows(group, "laws", _LAWS, [_law(signal) for signal in rows.signals])
    tables = [signal if isinstance(signal, Table) else Table((), ()) for signal in rows.signals]
    write_ragged(group, "law_times", [table.knots for table in tables], "s")
    write_ragged(group, "law_levels", [table.levels for table in tables], "rad, m, N·m, N or V")
    for name in ("failures", "forces_missing"):
        found = getattr(behaviour, name)
        write_rows(group, name, _WHY, [{"subject": subject, "reason": why} for subject, why in found])


class _Rows:
    """The rows of all tables as systems are taken apart."""

    def __init__(self) -> None:
        self.systems: list[dict[str, Any]] = []
        self.components: list[dict[str, Any]] = []
        self.kinds: dict[str, list[dict[str, Any]]] = defaultdict(list)
        self.nodes: list[dict[str, Any]] = []
        self.ports: list[dict[str, Any]] = []
        self.exposed: list[dict[str, Any]] = []
        self.signals: list[Signal] = []

    def take(self, system: System, inside: int, place: int, names: str, flat_place: dict[str, int]) -> None:
        """Add the system, which is `place`-th in the system of row `inside`; `names` comes before names inside."""
        own, counted = len(self.systems), count(system)
        self.systems.append(
            {
                "name": system.name, "subject": system.subject, "inside": inside, "place": place,
                "prefixed": system.prefixed, "unknowns": counted.unknowns, "of_components": counted.of_components,
                "of_nodes": counted.of_nodes, "of_surroundings": counted.of_surroundings,
            }
        )  # fmt: skip
        for node in system.nodes:
            self.ports += [{"node": len(self.nodes), "component": c, "port": p} for c, p in node.ports]
            self.nodes.append({"system": own, "size": node.size})
        for port, (component, inner) in system.exposed:
            self.exposed.append({"system": own, "port": port, "component": component, "inner": inner})
        for k, member in enumerate(system.components):
            if isinstance(member, System):
                deeper = f"{names}{member.name}/" if member.prefixed else names
                self.take(member, own, k, deeper, flat_place)
                continue
            kind = kind_of(member)
            self.components.append(
                {
                    "name": member.name, "subject": member.subject, "kind": kind, "system": own, "place": k,
                    "flat": flat_place[names + member.name], "row": len(self.kinds[kind]),
                    "equations": member.equations,
                }
            )  # fmt: skip
            self.kinds[kind].append({"name": member.name, **self._parameters(member)})

    def _parameters(self, component: Component) -> dict[str, Any]:
        out: dict[str, Any] = {}
        for field in dataclasses.fields(component):
            value = getattr(component, field.name)
            if field.name in ("signal", "target"):
                out["law"] = len(self.signals)
                self.signals.append(value)
            elif isinstance(value, JointGeometry | Controller):
                out |= {inner.name: getattr(value, inner.name) for inner in dataclasses.fields(value)}
            elif isinstance(component, JointComponent) and field.name == "kind":
                out["type"] = value.name
            elif field.name not in ("name", "subject"):
                out[field.name] = value
        return out


def _law(signal: Signal) -> dict[str, Any]:
    for name, (cls, fields) in _SIGNALS.items():
        if type(signal) is cls:
            return (
                {column.field: None for column in _LAWS}
                | {field: getattr(signal, field) for field in fields}
                | {"law": name}
            )
    raise ValueError(f"a signal of the kind {type(signal).__name__} is none of kinform's")


def read(group: h5py.Group) -> Behaviour:
    """The model that `write` wrote."""
    signals = _read_laws(group)
    kinds = {
        kind: read_rows(group, kind, (text("name"), *columns), added=_ADDED.get(kind, ()))
        for kind, columns in _PARAMETERS.items()
    }
    systems = read_rows(group, "systems", _SYSTEMS)
    rows = read_rows(group, "components", _COMPONENTS)
    members: dict[int, dict[int, Component]] = defaultdict(dict)
    for row in rows:
        members[row["system"]][row["place"]] = _component(row, kinds[row["kind"]][row["row"]], signals)
    ports: dict[int, list[tuple[str, str]]] = defaultdict(list)
    for row in read_rows(group, "ports", _PORTS):
        ports[row["node"]].append((row["component"], row["port"]))
    nodes: dict[int, list[Node]] = defaultdict(list)
    for k, row in enumerate(read_rows(group, "nodes", _NODES)):
        nodes[row["system"]].append(Node(tuple(ports[k]), row["size"]))
    exposed: dict[int, list[tuple[str, tuple[str, str]]]] = defaultdict(list)
    for row in read_rows(group, "exposed", _EXPOSED):
        exposed[row["system"]].append((row["port"], (row["component"], row["inner"])))
    made: System | None = None
    for k, row in reversed(list(enumerate(systems))):  # inner ones come after those around them
        inside = tuple(member for _, member in sorted(members[k].items(), key=lambda item: item[0]))
        made = System(inside, tuple(nodes[k]), row["name"], row["subject"], tuple(exposed[k]), row["prefixed"])
        members[row["inside"]][row["place"]] = made
    assert made is not None
    order = sorted(range(len(rows)), key=lambda k: rows[k]["flat"])
    found = flat(made)
    names = _flat_names(systems, rows)
    welds = [component.name for component in found.components if component.name not in set(names)]
    return Behaviour(
        arranged(found, [*(names[k] for k in order), *welds]),
        made,
        tuple(_reasons(group, "failures")),
        tuple(_reasons(group, "forces_missing")),
    )


def _flat_names(systems: list[dict[str, Any]], rows: list[dict[str, Any]]) -> list[str]:
    """Names of the components where levels are left out."""
    before: list[str] = []
    for system in systems:
        around = before[system["inside"]] if before else ""
        before.append(f"{around}{system['name']}/" if system["prefixed"] and before else around)
    return [before[row["system"]] + row["name"] for row in rows]


def _read_laws(group: h5py.Group) -> list[Signal]:
    times, levels = read_ragged(group, "law_times"), read_ragged(group, "law_levels")
    out: list[Signal] = []
    for row, knots, values in zip(read_rows(group, "laws", _LAWS), times, levels, strict=True):
        cls, fields = _SIGNALS[row["law"]]
        if cls is Table:
            out.append(Table(tuple(knots.tolist()), tuple(values.tolist())))
        else:
            out.append(cls(**{field: row[field] for field in fields}))
    return out


def _component(row: dict[str, Any], parameters: dict[str, Any], signals: list[Signal]) -> Component:
    cls = COMPONENTS[row["kind"]]
    given = {"name": row["name"], "subject": row["subject"]}
    own: dict[str, Any] = {key: value for key, value in parameters.items() if key != "name"}
    fields = {field.name for field in dataclasses.fields(cls)}
    if "law" in own:
        own["signal" if "signal" in fields else "target"] = signals[own.pop("law")]
    if "controller" in fields:
        own["controller"] = Controller(**{key: own.pop(key) for key in ("kp", "ki", "kd", "limit")})
    if cls is JointComponent:
        geometry = JointGeometry(**{key: own.pop(key) for key in ("axis", "point", "axis2", "pitch")})
        own = {"kind": KINDS[own.pop("type")], "geometry": geometry}
    return cls(**given, **own)


def _reasons(group: h5py.Group, name: str) -> Iterable[tuple[str, str]]:
    return ((row["subject"], row["reason"]) for row in read_rows(group, name, _WHY))
