"""`/behaviour`: the port model as tables: components by kind with their parameters, ports, nodes, systems in systems.

`components` lists all of them, each with the system that it is in (a row of `systems`; row 0 is the whole), its place
there and its place in the network without levels, which is what was simulated; its parameters are the row of the
same name in the table of its kind. `ports` says in which node each port is, `exposed` which ports a system has.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import h5py

from kinform.behaviour import Behaviour, Component, Node, System, count, flat
from kinform.behaviour.components import COMPONENTS, JointComponent, kind_of
from kinform.behaviour.joints import KINDS, JointGeometry
from kinform.behaviour.nested import arranged
from kinform.behaviour.shafts import Controller
from kinform.behaviour.signals import LAWS, Signal, Table, law_of
from kinform.design import Design
from kinform.results import layout
from kinform.results.held import HeldGroup
from kinform.results.layout import Layout
from kinform.results.records import columns_of, defaults, hint, hints
from kinform.results.table import (
    Column,
    flag,
    integer,
    read_ragged,
    read_rows,
    real,
    text,
    write_ragged,
    write_rows,
)

LAW = integer("law")


def _parameters(cls: type[Component]) -> tuple[Column, ...]:
    """The columns of a kind of component: a law is a row of `laws`, a kind of joint its name."""
    of_fields = {"signal": LAW, "target": LAW, "kind": text("type")}
    inner = {"geometry": columns_of(hint(JointGeometry)), "controller": columns_of(hint(Controller))}
    columns = [text("name")]
    for name in hints(cls):
        if name in of_fields:
            columns.append(of_fields[name])
        elif name in inner:
            columns += inner[name]
        elif name not in ("name", "subject"):
            columns += columns_of(hint(cls), frozenset(hints(cls)), (name,))
    return tuple(columns)


PARAMETERS = {kind: _parameters(cls) for kind, cls in COMPONENTS.items() if cls is not System}
"""Name and parameters of each kind, in the order of the file."""
COMPONENT_ROWS = (
    text("name"), text("subject"), text("kind"), integer("system"), integer("place"), integer("flat"),
    integer("row"), integer("equations"),
)  # fmt: skip
SYSTEM_ROWS = (
    text("name"), text("subject"), integer("inside"), integer("place"), flag("prefixed"), integer("unknowns"),
    integer("of_components"), integer("of_nodes"), integer("of_surroundings"),
)  # fmt: skip
NODE_ROWS = (integer("system"), integer("size"))
PORT_ROWS = (integer("node"), text("component"), text("port"))
EXPOSED_ROWS = (integer("system"), text("port"), text("component"), text("inner"))
LAW_ROWS = (
    text("law"), real("level", "rad, m, N·m, N or V"), real("offset", "as level"), real("slope", "as level, a s"),
    real("amplitude", "as level"), real("speed", "rad/s"), real("phase", "rad"),
)  # fmt: skip
TABLES = {
    "systems": SYSTEM_ROWS, "components": COMPONENT_ROWS, **PARAMETERS, "nodes": NODE_ROWS, "ports": PORT_ROWS,
    "exposed": EXPOSED_ROWS, "laws": LAW_ROWS,
}  # fmt: skip
"""In the order of the file."""
_LATER_KINDS = ("friction", "gas_spring", "bushing")
"""Kinds that files of older versions do not know."""
REASONS = Layout(
    Behaviour, layout.Table("failures"), layout.Table("forces_missing"), layout.Table("held"), layout.Table("imposed")
)


def write(group: h5py.Group, design: Design) -> None:
    """Write the model. Raises ValueError for a kind of component or signal that is none of kinform's."""
    behaviour = design.behaviour
    assert behaviour is not None
    place = {component.name: k for k, component in enumerate(behaviour.system.components)}
    rows = _Rows()
    rows.take(behaviour.nested, -1, 0, "", place)
    for name, columns in TABLES.items():
        of_columns = list(zip(*rows.tables[name], strict=True)) or [()] * len(columns)
        write_rows(group, name, columns, of_columns)
    tables = [signal if isinstance(signal, Table) else Table((), ()) for signal in rows.signals]
    write_ragged(group, "law_times", [table.knots for table in tables], "s")
    write_ragged(group, "law_levels", [table.levels for table in tables], "rad, m, N·m, N or V")
    REASONS.write(group, behaviour)


class _Rows:
    """The rows of all tables as systems are taken apart, in the order of their columns."""

    def __init__(self) -> None:
        self.tables: dict[str, list[tuple[Any, ...]]] = defaultdict(list)
        self.signals: list[Signal] = []

    def take(self, system: System, inside: int, place: int, names: str, flat_place: dict[str, int]) -> None:
        """Add the system, which is `place`-th in the system of row `inside`; `names` comes before names inside."""
        tables, count_of = self.tables, count(system)
        number = len(tables["systems"])
        counts = (count_of.unknowns, count_of.of_components, count_of.of_nodes, count_of.of_surroundings)
        tables["systems"].append((system.name, system.subject, inside, place, system.prefixed, *counts))
        for node in system.nodes:
            tables["ports"] += [(len(tables["nodes"]), *port) for port in node.ports]
            tables["nodes"].append((number, node.size))
        tables["exposed"] += [(number, port, *inner) for port, inner in system.exposed]
        for k, member in enumerate(system.components):
            if isinstance(member, System):
                deeper = f"{names}{member.name}/" if member.prefixed else names
                self.take(member, number, k, deeper, flat_place)
                continue
            kind, at = kind_of(member), flat_place[names + member.name]
            row = (member.name, member.subject, kind, number, k, at, len(tables[kind]), member.equations)
            tables["components"].append(row)
            values = self._parameters(member)
            tables[kind].append(tuple(values[column.field] for column in PARAMETERS[kind]))

    def _parameters(self, component: Component) -> dict[str, Any]:
        values = {name: getattr(component, name) for name in hints(type(component))}
        for name in ("signal", "target"):
            if name in values:
                values["law"] = len(self.signals)
                self._add(values[name])
        if isinstance(component, JointComponent):
            values |= {"type": component.kind.name, **vars(component.geometry)}
        return values | (vars(values["controller"]) if "controller" in values else {})

    def _add(self, signal: Signal) -> None:
        law = law_of(signal)
        self.signals.append(signal)
        numbers = (getattr(signal, column.field, None) for column in LAW_ROWS[1:])
        self.tables["laws"].append((law, *numbers))


def read(group: HeldGroup) -> Behaviour:
    """The model that `write` wrote."""
    signals = _read_laws(group)
    kinds = {kind: _read_kind(group, kind) for kind in PARAMETERS}
    systems = read_rows(group, "systems", SYSTEM_ROWS)
    rows = read_rows(group, "components", COMPONENT_ROWS)
    members: dict[int, dict[int, Component]] = defaultdict(dict)
    for row in rows:
        members[row["system"]][row["place"]] = _component(row, kinds[row["kind"]][row["row"]], signals)
    ports: dict[int, list[tuple[str, str]]] = defaultdict(list)
    for row in read_rows(group, "ports", PORT_ROWS):
        ports[row["node"]].append((row["component"], row["port"]))
    nodes: dict[int, list[Node]] = defaultdict(list)
    for k, row in enumerate(read_rows(group, "nodes", NODE_ROWS)):
        nodes[row["system"]].append(Node(tuple(ports[k]), row["size"]))
    exposed: dict[int, list[tuple[str, tuple[str, str]]]] = defaultdict(list)
    for row in read_rows(group, "exposed", EXPOSED_ROWS):
        exposed[row["system"]].append((row["port"], (row["component"], row["inner"])))
    nested: System | None = None
    for k, row in reversed(list(enumerate(systems))):  # inner ones come after those around them
        inside = tuple(member for _, member in sorted(members[k].items(), key=lambda item: item[0]))
        nested = System(inside, tuple(nodes[k]), row["name"], row["subject"], tuple(exposed[k]), row["prefixed"])
        members[row["inside"]][row["place"]] = nested
    assert nested is not None
    system = flat(nested)
    names = _flat_names(systems, rows)
    order = [names[k] for k in sorted(range(len(rows)), key=lambda k: rows[k]["flat"])]
    named = set(names)
    welds = [component.name for component in system.components if component.name not in named]
    return Behaviour(arranged(system, [*order, *welds]), nested, **REASONS.read_fields(group))


def _read_kind(group: HeldGroup, kind: str) -> list[dict[str, Any]]:
    """The parameters of components of a kind; files of older versions lack some kinds, and the law of loads."""
    later = defaults(COMPONENTS[kind]) | defaults(Controller)
    if kind in _LATER_KINDS and kind not in group:
        return []
    return read_rows(group, kind, PARAMETERS[kind], later | {"law"} if "signal" in later else later)


def _flat_names(systems: list[dict[str, Any]], rows: list[dict[str, Any]]) -> list[str]:
    """Names of the components where levels are left out."""
    before: list[str] = []
    for system in systems:
        around = before[system["inside"]] if before else ""
        before.append(f"{around}{system['name']}/" if system["prefixed"] and before else around)
    return [before[row["system"]] + row["name"] for row in rows]


def _read_laws(group: HeldGroup) -> list[Signal]:
    times, levels = read_ragged(group, "law_times"), read_ragged(group, "law_levels")
    signals: list[Signal] = []
    for row, knots, values in zip(read_rows(group, "laws", LAW_ROWS), times, levels, strict=True):
        cls = LAWS[row["law"]]
        numbers = {name: row[name] for name in hints(cls) if name in row}
        signals.append(Table(tuple(knots.tolist()), tuple(values.tolist())) if cls is Table else cls(**numbers))
    return signals


def _component(row: dict[str, Any], parameters: dict[str, Any], signals: list[Signal]) -> Component:
    """The component of a row of `components` and of the table of its kind."""
    cls = COMPONENTS[row["kind"]]
    fields = {key: value for key, value in parameters.items() if key not in ("name", "law", "type")}
    if "law" in parameters:
        fields["signal" if "signal" in hints(cls) else "target"] = signals[parameters["law"]]
    if "controller" in hints(cls):
        fields["controller"] = Controller(**{name: fields.pop(name) for name in hints(Controller) if name in fields})
    if cls is JointComponent:
        fields = {"kind": KINDS[parameters["type"]], "geometry": JointGeometry(**fields)}
    return cls(name=row["name"], subject=row["subject"], **fields)
