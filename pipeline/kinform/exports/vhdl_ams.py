"""vhdl-ams: a package of natures, an entity per kind of component, and the system made of them.

Each body frame is a node of six terminals, positions with forces and angular velocities with torques; the
orientation of a body travels beside it as a quantity. Sub-assemblies keep their entity: it holds the bodies
that are all of it, and the joints among them. Generics carry what the geometry gave; those of the bench
carry the initial conditions. No free tool counts equations, so that is done here and stated in the files.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kinform.behaviour import Ground, JointComponent, RigidBody
from kinform.exports.exported import Exported
from kinform.exports.loops import Closure, Loops, held_rates, loops, singular
from kinform.exports.losses import of_teeth
from kinform.exports.model import ExportModel
from kinform.exports.names import VHDL, identifiers
from kinform.exports.text import number, render, vector
from kinform.exports.tree import Tree, grow
from kinform.exports.vhdl_drives import drives
from kinform.exports.vhdl_structure import AXES, COUNT, Part, Writer
from kinform.foundation.algebra.spatial import to_matrix
from kinform.foundation.algebra.vectors import perpendicular
from kinform.model.arrays import Array

__all__ = ["export"]


def export(model: ExportModel) -> Exported:
    """1_mechanics.vhd, 2_components.vhd, 3_NAME.vhd and 4_NAME_bench.vhd, in the order of their dependence."""
    tree = grow(model.system)
    found = loops(model, tree)
    lost = [*model.lost, *singular(model)]
    remarks: list[str] = [*of_teeth(model.system)]
    writer = Writer(model)
    for scope in writer.scopes.paths[1:]:
        writer.child(scope)
    held = held_rates(model, found, lost, remarks)
    for body in model.system.bodies:
        _body(writer, body)
    closures = {closure.joint.subject: closure for closure in found.closures}
    for joint in model.system.joints:
        if any(c.joint is joint and c.rigid for c in tree.closing):
            continue
        if any(c.joint is joint for c in tree.closing) and joint.subject not in closures:
            lost.append(f"{joint.subject}: it closes a loop that is not connected with the ground")
            continue
        _joint(writer, tree, joint, closures.get(joint.subject), found, held)
    drives(writer, found, held, lost, remarks)
    for load in model.system.loads:
        home = writer.scopes.of[load.name]
        frame = writer.names[model.system.body_at(load.name, "frame").name]
        label = writer.names[load.name]
        generics = {
            name: writer.generic(home, f"{label}_{name}", kind, value)
            for name, kind, value in (
                ("force", "vector3", _array(load.force)), ("torque", "vector3", _array(load.torque)),
                ("s", "vector3", _array(load.point)), ("turning", "real", number(load.turning)),
            )
        }  # fmt: skip
        writer.add(home, Part(label, "load", load.subject, generics, _frame("", frame)))
    for name, (scope, efforts) in writer.efforts.items():
        writer.of[scope].statements.append(f"{name} == {' + '.join(efforts) or '0.0'}")
        writer.equations += 1
    if model.ranges:
        remarks.append("joints do not stop at the ends of their ranges, as in our simulation")
    if found.closures:
        remarks.append("redundant constraints of loops are left out: closures hold independent directions only")
    return _files(writer, lost, remarks)


def _files(writer: Writer, lost: list[str], remarks: list[str]) -> Exported:
    model, top = writer.model, writer.entity[writer.scopes.paths[0]]
    bench = identifiers([f"{top} bench"], VHDL, beside=(*writer.entity.values(), "mechanics", *COUNT))[f"{top} bench"]
    order = ("1_mechanics.vhd", "2_components.vhd", f"3_{top}.vhd", f"4_{bench}.vhd")
    system = render(
        "system.vhd.j2", model=model, lost=lost, remarks=remarks, equations=writer.equations, order=order,
        potentials=writer.potentials, tables=writer.tables,
        scopes=[writer.of[path] for path in reversed(writer.scopes.paths)],
    )  # fmt: skip
    files = {
        order[0]: render("mechanics.vhd.j2"),
        order[1]: render("components.vhd.j2", count=COUNT),
        order[2]: system,
        order[3]: render("bench.vhd.j2", model=model, bench=bench, entity=top, starts=writer.starts),
    }
    return Exported(files, tuple(lost), tuple(remarks))


def _array(values: Any) -> str:
    return "(" + vector(np.asarray(values).ravel(), ", ") + ")"


def _turn(q: Array) -> str:
    """A quaternion, by name where it is the identity."""
    return "upright" if q[0] == 1.0 else _array(q)


def _frame(side: str, node: str) -> dict[str, str]:
    """Ports of one frame of a component."""
    return {f"{side}{axis}": f"{node}_{axis}" for axis in AXES} | {f"q{side}": f"{node}_q"}


def _body(writer: Writer, body: Ground | RigidBody) -> None:
    model, label = writer.model, writer.names[body.name]
    home = writer.scopes.of[body.name]
    writer.node(label, home, writer.scopes.top_of(body.name))
    if isinstance(body, Ground):
        writer.add(home, Part(f"{label}_i", "ground", body.subject, {}, _frame("", label)))
        return
    known = body.mass is not None
    mass, centre, inertia = (
        (body.mass, body.centre_of_mass, body.inertia) if known else (0.0, np.zeros(3), np.zeros((3, 3)))
    )
    start = _turn(model.start[body.subject].quaternion)
    generics = {
        "m": writer.generic(home, f"{label}_m", "real", number(mass or 0.0)),
        "c": writer.generic(home, f"{label}_c", "vector3", _array(centre)),
        "i": writer.generic(home, f"{label}_inertia", "matrix3", _array(inertia)),
        "g": writer.gravity(home),
        "q_start": writer.generic(home, f"{label}_q_start", "quaternion", "upright", start),
    }
    writer.add(home, Part(f"{label}_i", "rigid_body", body.subject, generics, _frame("", label)))


def _geometry(joint: JointComponent) -> dict[str, tuple[str, str]]:
    """Generics of a joint that come from its geometry: type and value."""
    geometry, kind = joint.geometry, joint.kind.name

    def of(values: Any) -> tuple[str, str]:
        return "vector3", _array(values)

    if kind == "fixed":
        return {}
    if kind == "spherical":
        return {"s": of(geometry.point)}
    axis = np.asarray(geometry.axis)
    if kind == "prismatic":
        return {"n": of(axis)}
    if kind == "planar":
        u, v = perpendicular(axis)
        return {"n1": of(u), "n2": of(v), "n3": of(axis), "s": of(geometry.point)}
    if kind == "universal":
        return {"n1": of(axis), "n2": of(geometry.axis2), "s": of(geometry.point)}
    lead = {} if kind != "screw" else {"lead": ("real", number((geometry.pitch or 0.0) / (2.0 * np.pi)))}
    return {"n": of(axis), "s": of(geometry.point), **lead}


def _joint(
    writer: Writer, tree: Tree, joint: JointComponent, closure: Closure | None, found: Loops, held: frozenset[int]
) -> None:
    system, label, home = writer.model.system, writer.names[joint.name], writer.scopes.of[joint.name]
    first, second = (writer.names[system.body_at(joint.name, port).name] for port in ("a", "b"))
    generics = {
        name: writer.generic(home, f"{label}_{name}", kind, value) for name, (kind, value) in _geometry(joint).items()
    }
    (slot,) = (s for s in writer.model.mechanism.slots if s.name == joint.subject)
    q, v = writer.model.coordinates(joint.subject)
    ports: dict[str, str] = {}
    if joint.kind.name == "spherical":
        free = all(k in found.free for k in range(slot.v.start, slot.v.stop))
        world = _world(writer, joint, v)
        generics["w_start"] = writer.generic(home, f"{label}_w_start", "vector3", "zero", _array(world))
        generics["given"] = writer.generic(home, f"{label}_given", "boolean", str(free).lower())
    else:
        for k, (coordinate, _) in enumerate(joint.kind.coordinates):
            name = f"{label}_{coordinate}"
            known = slot.v.start + k in found.free and slot.v.start + k not in held
            for what, value in (("start", q[k]), ("rate_start", v[k])):
                generics[f"{coordinate}_{what}"] = writer.generic(
                    home, f"{name}_{what}", "real", "0.0", number(float(value))
                )
            generics[f"{coordinate}_given"] = writer.generic(home, f"{name}_given", "boolean", str(known).lower())
            writer.of[home].declarations += [f"quantity {name} : real", f"quantity {name}_effort : real"]
            writer.efforts[f"{name}_effort"] = (home, [])
            ports |= {coordinate: name, f"{coordinate}_effort": f"{name}_effort"}
    target = second
    if closure is not None:
        target = f"{label}_end"
        writer.node(target, home, home)
        body = system.body_at(joint.name, "b").subject
        start = _turn(writer.model.start[body].quaternion)
        turn = {"q_start": writer.generic(home, f"{target}_q_start", "quaternion", "upright", start)}
        writer.add(home, Part(f"{target}_i", "massless_frame", f"end of {joint.subject}", turn, _frame("", target)))
        values = {f"n{k + 1}": ("vector3", _array(closure.axes[:, k])) for k in range(3)}
        values["s"] = ("vector3", _array(closure.point))
        rows = zip(("place", "turn"), (closure.place, closure.turn), strict=True)
        values |= {f"{name}{k + 1}": ("boolean", str(on).lower()) for name, row in rows for k, on in enumerate(row)}
        maps = {
            name: writer.generic(home, f"{label}_closure_{name}", kind, value) for name, (kind, value) in values.items()
        }
        text = f"{joint.subject} closes a loop"
        writer.add(home, Part(f"{label}_closure", "closure", text, maps, _frame("a", target) | _frame("b", second)))
    entity = f"{joint.kind.name}_joint"
    writer.add(
        home, Part(f"{label}_i", entity, joint.subject, generics, _frame("a", first) | _frame("b", target) | ports)
    )


def _world(writer: Writer, joint: JointComponent, v: Array) -> Array:
    """Relative angular velocity of a spherical joint in the axes of the world."""
    first = writer.model.system.body_at(joint.name, "a").subject
    return np.asarray(to_matrix(writer.model.start[first].quaternion) @ v)
