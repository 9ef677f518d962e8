"""Assemblies, kinematics and masses built by hand, without any mesh: what geometry would have given."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform.kinematics.joints.pair.joint import twists_of
from kinform.mass import compile_mass
from kinform.model.assembly import Assembly, MassOverride, Part, Source
from kinform.model.function import Drive, Function, InitialValue, IntendedJoint, Law, SimulationRequest
from kinform.model.kinematics import FREEDOMS, Body, ConstraintMatrix, Joint, Kinematics, Misfit, Mobility
from kinform.model.tolerances import Tolerances

HERE = Source("device.toml", 1)
Z = (0.0, 0.0, 1.0)


def body(name, mass=1.0, com=(0.0, 0.0, 0.0), inertia=None):
    """A part with stated mass, alone in its body; mass None: a stick."""
    override = None
    if mass is not None:
        tensor = np.zeros((3, 3)) if inertia is None else np.asarray(inertia, float)
        override = MassOverride(mass, np.asarray(com, float), tensor if tensor.ndim == 2 else np.diag(tensor))
    return Part(name, None, np.eye(4), True, None, None, override, "m", HERE)


def joint(a, b, kind, axis=None, point=None, axis2=None, pitch=None, status="determined", freedoms=None):
    """A joint between bodies a and b, in this order."""
    unit = None if axis is None else np.asarray(axis, float) / np.linalg.norm(axis)
    unit2 = None if axis2 is None else np.asarray(axis2, float) / np.linalg.norm(axis2)
    point = None if point is None else np.asarray(point, float)
    count = FREEDOMS[kind] if freedoms is None else freedoms
    placed = kind != "general" and (point is not None or kind in ("fixed", "prismatic"))
    twists = twists_of(kind, unit, point, pitch, unit2) if placed else np.zeros((count, 6))
    return Joint(
        f"{a}~{b}", (a, b), kind, unit, point, unit2, pitch, count, twists, ("cylinder",), status,
        "made by hand", (), (), np.zeros(6),
    )  # fmt: skip


def kinematics(parts, joints, ground="base"):
    """Every part its own body."""
    bodies = tuple(Body(p.name, (p.name,), p.name == ground) for p in parts)
    none = np.zeros(0, dtype=np.int64)
    matrix = ConstraintMatrix((), np.zeros(0), none, np.zeros(1, dtype=np.int64), none, none, np.zeros(3), 1.0)
    mobility = Mobility(0, None, 0, 0, 0, 0, np.zeros((0, len(bodies), 6)), (), ())
    return Kinematics(bodies, tuple(joints), matrix, mobility, Misfit())


def assembly(parts, function=None, request=None):
    """An assembly of these parts; `base` is its ground."""
    return Assembly(
        "device", "m", tuple(parts), (), (), "base", Tolerances(), False, function or Function(),
        request or SimulationRequest(), (), HERE, (),
    )  # fmt: skip


def device(parts, joints, *, drives=(), loads=(), couplings=(), intended=(), **request):
    """(assembly, kinematics, mass) of parts with a massless base added."""
    parts = sorted([*parts, body("base", mass=None)], key=lambda p: p.name)
    function = Function(joints=tuple(intended), drives=tuple(drives), loads=tuple(loads), couplings=tuple(couplings))
    made = assembly(parts, function, SimulationRequest(**request))
    chain = kinematics(parts, joints)
    return made, chain, compile_mass(made, chain)


def intended(name, a, b, kind, axis=None, point=None, **more):
    """An intended joint in the designer's order and sign."""
    values = {"axis2": None, "pitch": None, "range": None, "file": "device.toml", "line": 1} | more
    axis = None if axis is None else np.asarray(axis, float)
    point = None if point is None else np.asarray(point, float)
    return IntendedJoint(name, (a, b), kind, axis, point=point, **values)


def drive(name, kind, law=None, **parameters):
    """A drive; lengths in metres."""
    return Drive(name, kind, law, parameters, 1.0, "device.toml", 1)


def sine(amplitude, frequency, phase=0.0, offset=0.0):
    """Law in manifest units: degrees for turns."""
    return Law("sine", amplitude=amplitude, frequency=frequency, phase=phase, offset=offset)


def initial(name, position=0.0, velocity=0.0):
    """Initial value in degrees or metres."""
    return InitialValue(name, position, velocity, 1.0, "device.toml", 1)


def without_mass(made):
    """The same assembly with nothing known of its masses."""
    return replace(made, parts=tuple(replace(part, override=None) for part in made.parts))


def rod(name, start, end, mass=1.0):
    """A thin uniform rod from start to end."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    along = end - start
    length = np.linalg.norm(along)
    across = np.eye(3) - np.outer(along, along) / length**2
    return body(name, mass, 0.5 * (start + end), mass * length**2 / 12.0 * across)
