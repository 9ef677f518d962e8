"""vhdl-ams: a package of natures, an entity per kind of component, and the system made of them.

Each body frame is a node of six terminals, positions with forces and angular velocities with torques; the
orientation of a body travels beside it as a quantity. Sub-assemblies keep their entity: it holds the bodies
that are all of it, and the joints among them. Generics carry what the geometry gave; those of the bench
carry the initial conditions. No free tool counts equations, so that is done here and stated in the files.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kinform.behaviour import Ground, JointComponent, LoadComponent, RigidBody
from kinform.exports.equations import Closure, equations_of, inertia_of
from kinform.exports.exported import Exported
from kinform.exports.model import ExportModel
from kinform.exports.names import VHDL, identifiers
from kinform.exports.text import number, render, vector
from kinform.exports.vhdl_ams.drives import drives
from kinform.exports.vhdl_ams.structure import AXES, COUNT, Part, Scope, Writer
from kinform.foundation.algebra.spatial import to_matrix
from kinform.foundation.algebra.vectors import perpendicular
from kinform.model.arrays import Array


def export(model: ExportModel) -> Exported:
    """1_mechanics.vhd, 2_components.vhd, 3_NAME.vhd and 4_NAME_bench.vhd, in the order of their dependence."""
    equations = equations_of(model)
    writer = Writer(equations)
    for scope in writer.scopes.paths[1:]:
        writer.child(scope)
    for body in model.system.bodies:
        _body(writer, body)
    closures = {closure.joint.name: closure for closure in equations.closures}
    left_out = {closing.joint.name for closing in equations.tree.closing} - set(closures)
    for joint in model.system.joints:
        if joint.name not in left_out:
            _joint(writer, joint, closures.get(joint.name))
    drives(writer)
    for load in model.system.steady_loads:
        _load(writer, load)
    for name, (scope, efforts) in writer.efforts.items():
        writer.of[scope].statements.append(f"{name} == {' + '.join(efforts) or '0.0'}")
        writer.equations_made += 1
    return _files(writer)


def _files(writer: Writer) -> Exported:
    model, top = writer.model, writer.entity[writer.scopes.paths[0]]
    lost, remarks = writer.equations.lost, writer.equations.remarks
    bench = identifiers([f"{top} bench"], VHDL, beside=(*writer.entity.values(), "mechanics", *COUNT))[f"{top} bench"]
    order = ("1_mechanics.vhd", "2_components.vhd", f"3_{top}.vhd", f"4_{bench}.vhd")
    system = render(
        __package__, "system.vhd.j2", model=model, lost=lost, remarks=remarks, equations=writer.equations_made,
        order=order, potentials=writer.potentials, tables=writer.tables,
        scopes=[writer.of[path] for path in reversed(writer.scopes.paths)],
    )  # fmt: skip
    counts = {len(gear.others): list(gear.others) for gear in writer.equations.gears if gear.others}
    trains = [counts[count] for count in sorted(counts)]
    files = {
        order[0]: render(__package__, "mechanics.vhd.j2"),
        order[1]: render(__package__, "components.vhd.j2", count=COUNT, trains=trains),
        order[2]: system,
        order[3]: render(__package__, "bench.vhd.j2", model=model, bench=bench, entity=top, starts=writer.starts),
    }
    return Exported(files, tuple(lost), tuple(remarks))


def _array(values: Any) -> str:
    return "(" + vector(np.asarray(values).ravel(), ", ") + ")"


def _frame(side: str, node: str) -> dict[str, str]:
    """Ports of one frame of a component."""
    return {f"{side}{axis}": f"{node}_{axis}" for axis in AXES} | {f"q{side}": f"{node}_q"}


def _body(writer: Writer, body: Ground | RigidBody) -> None:
    label, home = writer.names[body.name], writer.scopes.of[body.name]
    writer.node(label, home, writer.scopes.top_of[body.name])
    if isinstance(body, Ground):
        writer.add(home, Part(f"{label}_i", "ground", body.subject, {}, _frame("", label)))
        return
    mass, centre, inertia = inertia_of(body)
    generics = {
        "m": writer.generic(home, f"{label}_m", "real", number(mass)),
        "c": writer.generic(home, f"{label}_c", "vector3", _array(centre)),
        "i": writer.generic(home, f"{label}_inertia", "matrix3", _array(inertia)),
        "g": writer.gravity(home),
        "q_start": _start(writer, home, label, body.subject),
    }
    writer.add(home, Part(f"{label}_i", "rigid_body", body.subject, generics, _frame("", label)))


def _start(writer: Writer, home: Scope, label: str, body: str) -> str:
    """The generic with the orientation from which a frame starts: that of a body."""
    q = writer.model.start[body].quaternion
    start = "upright" if q[0] == 1.0 else _array(q)
    return writer.generic(home, f"{label}_q_start", "quaternion", "upright", start)


def _load(writer: Writer, load: LoadComponent) -> None:
    home, label = writer.scopes.of[load.name], writer.names[load.name]
    values = {
        "force": ("vector3", _array(load.force)), "torque": ("vector3", _array(load.torque)),
        "s": ("vector3", _array(load.point)), "turning": ("real", number(load.turning)),
    }  # fmt: skip
    generics = writer.generics(home, label, values)
    frame = writer.names[writer.model.system.body_at(load.name, "frame").name]
    writer.add(home, Part(label, "load", load.subject, generics, _frame("", frame)))


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


def _joint(writer: Writer, joint: JointComponent, closure: Closure | None) -> None:
    """A joint with its coordinates; one that closes a loop ends in a frame of its own."""
    system, label, home = writer.model.system, writer.names[joint.name], writer.scopes.of[joint.name]
    first, second = (writer.names[system.body_at(joint.name, port).name] for port in ("a", "b"))
    generics = writer.generics(home, label, _geometry(joint))
    rates, free = writer.equations.rates_of(joint), writer.equations.free
    q, v = writer.model.coordinates(joint.subject)
    ports: dict[str, str] = {}
    if joint.kind.name == "spherical":
        given = all(k in free for k in rates)
        generics["w_start"] = writer.generic(
            home, f"{label}_w_start", "vector3", "zero", _array(_in_world(writer, joint, v))
        )
        generics["given"] = writer.generic(home, f"{label}_given", "boolean", str(given).lower())
    else:
        for k, (coordinate, _) in enumerate(joint.kind.coordinates):
            name = f"{label}_{coordinate}"
            given = rates[k] in free - writer.equations.held
            for what, value in (("start", q[k]), ("rate_start", v[k])):
                generics[f"{coordinate}_{what}"] = writer.generic(
                    home, f"{name}_{what}", "real", "0.0", number(float(value))
                )
            generics[f"{coordinate}_given"] = writer.generic(home, f"{name}_given", "boolean", str(given).lower())
            writer.of[home].declarations += [f"quantity {name} : real", f"quantity {name}_effort : real"]
            writer.efforts[f"{name}_effort"] = (home, [])
            ports |= {coordinate: name, f"{coordinate}_effort": f"{name}_effort"}
    if closure is not None:
        _closure(writer, closure, second)
    end = second if closure is None else f"{label}_end"
    entity = f"{joint.kind.name}_joint"
    joined = _frame("a", first) | _frame("b", end) | ports
    writer.add(home, Part(f"{label}_i", entity, joint.subject, generics, joined))


def _closure(writer: Writer, closure: Closure, second: str) -> None:
    """The frame in which a closing joint ends, and what holds it to the second body."""
    joint = closure.joint
    label, home = writer.names[joint.name], writer.scopes.of[joint.name]
    end = f"{label}_end"
    writer.node(end, home, home)
    turn = {"q_start": _start(writer, home, end, writer.model.system.body_at(joint.name, "b").subject)}
    writer.add(home, Part(f"{end}_i", "massless_frame", f"end of {joint.subject}", turn, _frame("", end)))
    values = {f"n{k + 1}": ("vector3", _array(closure.axes[:, k])) for k in range(3)}
    values["s"] = ("vector3", _array(closure.point))
    rows = zip(("place", "turn"), (closure.place, closure.turn), strict=True)
    values |= {f"{name}{k + 1}": ("boolean", str(on).lower()) for name, row in rows for k, on in enumerate(row)}
    generics = writer.generics(home, f"{label}_closure", values)
    text = f"{joint.subject} closes a loop"
    writer.add(home, Part(f"{label}_closure", "closure", text, generics, _frame("a", end) | _frame("b", second)))


def _in_world(writer: Writer, joint: JointComponent, v: Array) -> Array:
    """Relative angular velocity of a spherical joint in the axes of the world."""
    first = writer.model.system.body_at(joint.name, "a").subject
    return np.asarray(to_matrix(writer.model.start[first].quaternion) @ v)
