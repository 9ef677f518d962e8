"""Levels of systems: taking them out for the solver, putting them in along sub-assemblies, placing a system elsewhere.

A node that reaches through several systems is one node in the flat network: equal across variables, through
variables that sum to zero, whatever the levels between. Bodies that meet in a node move as one: they are welded.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from kinform.behaviour.components import (
    Bushing,
    Elastic,
    Gear,
    Ground,
    JointComponent,
    LoadComponent,
    RigidBody,
    System,
)
from kinform.behaviour.joints import KINDS, JointGeometry
from kinform.behaviour.ports import Component, Node
from kinform.foundation.graphs.graph import UnionFind
from kinform.model.arrays import Array

Leaf = tuple[str, str]


def flat(system: System) -> System:
    """The network without levels: names inside a system get its name in front ("left motor/rotor").

    Two bodies that meet in a node are joined by a fixed joint, so that every node holds one body at most.
    """
    if not system.systems and not any(_crowded(system, node) for node in system.nodes):
        return system
    components, nodes, exposed = _opened(system, "", "")
    found = System(tuple(components), tuple(nodes), system.name, system.subject, tuple(exposed))
    return _welded(found)


def _opened(system: System, names: str, subjects: str) -> tuple[list[Component], list[Node], list[tuple[str, Leaf]]]:
    """Components, nodes and exposed ports of a system with its levels taken out, called with these prefixes."""
    components: list[Component] = []
    groups: list[list[Leaf]] = []
    sizes: list[int] = []
    at: dict[Leaf, int] = {}
    """Number of the group in which a port of a member is."""
    for member in system.components:
        if isinstance(member, System):
            deeper = f"{names}{member.name}/", f"{subjects}{member.subject}/"
            inner, inner_nodes, inner_exposed = _opened(member, *(deeper if member.prefixed else (names, subjects)))
            components += inner
            where = {leaf: len(groups) + k for k, node in enumerate(inner_nodes) for leaf in node.ports}
            groups += [list(node.ports) for node in inner_nodes]
            sizes += [node.size for node in inner_nodes]
            at.update({(member.name, port): where[leaf] for port, leaf in inner_exposed})
        else:
            called = replace(member, name=names + member.name, subject=subjects + member.subject)
            components.append(called)
            for port in member.ports:
                at[member.name, port.name] = len(groups)
                groups.append([(called.name, port.name)])
                sizes.append(port.size)
    merged = UnionFind(len(groups))
    for node in system.nodes:
        first, *others = (at[port] for port in node.ports)
        for other in others:
            merged.union(first, other)
    joined: dict[int, list[Leaf]] = defaultdict(list)
    for k, group in enumerate(groups):
        joined[merged.find(k)] += group
    nodes = [Node(tuple(ports), sizes[k]) for k, ports in joined.items()]
    exposed = [(port, joined[merged.find(at[inner])][0]) for port, inner in system.exposed]
    return components, nodes, exposed


def _crowded(system: System, node: Node) -> bool:
    return sum(isinstance(system.component(name), Ground | RigidBody) for name, _ in node.ports) > 1


def _welded(system: System) -> System:
    """Bodies that share a node get nodes of their own, joined by fixed joints; grounds stay, for they are one."""
    components, nodes = list(system.components), []
    for node in system.nodes:
        bodies = [system.component(name) for name, _ in node.ports]
        bodies = [body for body in bodies if isinstance(body, Ground | RigidBody)]
        ports = list(node.ports)
        bodies.sort(key=lambda body: not isinstance(body, Ground))
        for body in bodies[1:]:
            if isinstance(body, Ground):
                continue
            name = f"weld {bodies[0].name}~{body.name}"
            subject = f"weld {bodies[0].subject}~{body.subject}"
            components.append(JointComponent(name, subject, KINDS["fixed"], JointGeometry()))
            ports.remove((body.name, "frame"))
            ports.append((name, "a"))
            nodes.append(Node(((body.name, "frame"), (name, "b")), node.size))
        nodes.append(Node(tuple(ports), node.size))
    return System(tuple(components), tuple(nodes), system.name, system.subject, system.exposed)


def arranged(system: System, names: Sequence[str]) -> System:
    """The flat system with its components in the order of these names, nodes and ports as they are met in it."""
    components = tuple(system.component(name) for name in names)
    nodes: dict[int, tuple[Node, list[Leaf]]] = {}
    for component in components:
        for port in component.ports:
            node = system.node(component.name, port.name)
            nodes.setdefault(id(node), (node, []))[1].append((component.name, port.name))
    made = tuple(Node(tuple(ports), node.size) for node, ports in nodes.values())
    return System(components, made, system.name, system.subject, system.exposed, system.prefixed)


def nest(system: System, homes: Mapping[str, str]) -> System:
    """The flat system with levels: `homes` is the path ("arm/motor") of the system in which each component is, ""
    for none, by its name. Nodes that leave a system make a port of it, named after the first port in them.

    `flat` gives the same components and nodes back, in another order.
    """
    paths = {part for home in homes.values() for part in _around(home)}
    members: dict[str, list[Component]] = defaultdict(list)
    nodes: dict[str, list[Node]] = defaultdict(list)
    exposed: dict[str, list[tuple[str, Leaf]]] = defaultdict(list)
    for component in system.components:
        members[homes[component.name]].append(component)
    for node in system.nodes:
        label = " ".join(node.ports[0])
        inside: dict[str, list[Leaf]] = defaultdict(list)
        for port in node.ports:
            inside[homes[port[0]]].append(port)
        for path in sorted({up for home in inside for up in _around(home)}, key=_deep, reverse=True):
            outside = [home for home in inside if home != path and path not in _around(home)]
            if outside:
                exposed[path].append((label, inside[path][0]))
                inside[_above(path)].append((_called(path), label))
                nodes[path].append(Node(tuple(inside.pop(path)), node.size))
        (top,) = inside
        nodes[top].append(Node(tuple(inside[top]), node.size))
    for path in sorted(paths, key=lambda path: (-path.count("/"), path)):
        own = path.rsplit("/", 1)[-1]
        made = System(
            tuple(members[path]), tuple(nodes[path]), _called(path), own, tuple(exposed[path]), prefixed=False
        )  # fmt: skip
        members[_above(path)].append(made)
    return System(tuple(members[""]), tuple(nodes[""]), system.name, system.subject, system.exposed)


def _around(home: str) -> list[str]:
    """The path and those around it, but the whole."""
    steps = home.split("/") if home else []
    return ["/".join(steps[: k + 1]) for k in range(len(steps))]


def _deep(path: str) -> tuple[int, str]:
    return path.count("/"), path


def _above(path: str) -> str:
    return path.rpartition("/")[0]


def _called(path: str) -> str:
    return f"system {path}"


def placed(system: System, X_WS: Array) -> System:
    """The system moved by X_WS (4, 4): a motor written once at the origin, put where the device has it."""
    turn, shift = np.asarray(X_WS, dtype=np.float64)[:3, :3], np.asarray(X_WS, dtype=np.float64)[:3, 3]

    def direction(vector: Array) -> Array:
        return np.asarray(turn @ np.asarray(vector, dtype=np.float64))

    def point(vector: Array) -> Array:
        return direction(vector) + shift

    def moved(component: Component) -> Component:
        if isinstance(component, System):
            return placed(component, X_WS)
        if isinstance(component, RigidBody):
            inertia = turn @ component.inertia @ turn.T
            return replace(component, centre_of_mass=point(component.centre_of_mass), inertia=inertia)
        if isinstance(component, JointComponent):
            g = component.geometry
            axes = [None if axis is None else direction(axis) for axis in (g.axis, g.axis2)]
            geometry = JointGeometry(axes[0], None if g.point is None else point(g.point), axes[1], g.pitch)
            return replace(component, geometry=geometry)
        if isinstance(component, LoadComponent):
            force, torque = direction(component.force), direction(component.torque)
            return replace(component, force=force, torque=torque, point=point(component.point))
        if isinstance(component, Gear) and component.pitch_point is not None:
            normals = [None if normal is None else direction(normal) for normal in (component.flank, component.back)]
            return replace(component, pitch_point=point(component.pitch_point), flank=normals[0], back=normals[1])
        if isinstance(component, Elastic):
            if isinstance(component, Bushing):
                component = replace(component, axes=turn @ component.axes)
            return replace(component, point=point(component.point), other=point(component.other))
        return component

    return replace(system, components=tuple(moved(component) for component in system.components))
