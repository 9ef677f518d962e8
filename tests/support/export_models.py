"""Designs made by hand for exports, each with our run of it, and how to put exports where tools find them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from kinform import stages
from kinform.design import Design
from kinform.exports import export, write
from kinform.exports.model import export_model
from kinform.model.assembly import Subassembly
from kinform.model.function import Law, Load, SimulationRequest
from kinform.simulation import simulate
from support.devices import HERE, Z, body, device, drive, initial, joint, rod, sine

DOWN = np.array([0.0, -9.81, 0.0])
X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
SLANT = np.array([1.0, -2.0, 2.0]) / 3.0


def design(made, *, run=True):
    """The design of (assembly, kinematics, mass), simulated."""
    assembly, chain, mass = made
    return Design(assembly, kinematics=chain, mass=mass, simulation=simulate(*made) if run else None)


def block(name, centre, mass=1.0, moments=(2e-2, 3e-2, 4e-2), products=(1e-3, -2e-3, 5e-4)):
    """A body without any symmetry."""
    xy, xz, yz = products
    a, b, c = moments
    return body(name, mass, centre, [[a, xy, xz], [xy, b, yz], [xz, yz, c]])


def pendulum(**request):
    """One body on a slanted axis off the origin."""
    parts = [block("bob", (0.4, 0.1, 0.3))]
    joints = [joint("base", "bob", "revolute", SLANT, (0.1, 0.2, 0.3))]
    return device(parts, joints, **({"duration": 1.0, "step": 0.05} | request))


def gimbal(**request):
    """Three turns; two joints list the outer body second, so that trees run through them backwards."""
    parts = [block("outer", (0, 0.1, 0)), block("inner", (0.05, 0, 0), 0.7), block("a rotor", (0, 0, 0.1), 0.4)]
    joints = [
        joint("base", "outer", "revolute", Z, (0, 0, 0.1)),
        joint("inner", "outer", "revolute", X, (0.1, 0, 0.1)),
        joint("a rotor", "inner", "revolute", SLANT, (0.2, 0.1, 0)),
    ]
    start = (initial("base~outer", 10, 40), initial("inner~outer", -20, 15), initial("a rotor~inner", 0, 200))
    return device(parts, joints, initial=start, **({"duration": 1.0, "step": 0.05} | request))


def seeker(**request):
    """Two driven turns and a free one."""
    parts = [block("outer", (0, 0.1, 0)), block("inner", (0.05, 0, 0), 0.7), block("camera", (0, 0.2, 0.1), 0.2)]
    joints = [
        joint("base", "outer", "revolute", Z, (0, 0, 0)),
        joint("inner", "outer", "revolute", Y, (0, 0, 0)),
        joint("camera", "inner", "prismatic", X, (0, 0, 0)),
    ]
    drives = [
        drive("base~outer", "motion", sine(25, 0.5)),
        drive("inner~outer", "motion", Law("table", times=(-0.2, 0.4, 0.9), values=(0.0, 20.0, -10.0))),
        drive("camera~inner", "spring", stiffness=200.0, rest=0.01),
        drive("camera~inner", "damper", damping=2.0),
    ]
    return device(parts, joints, drives=drives, **({"duration": 1.0, "step": 0.05} | request))


def freedoms(**request):
    """Springs, dampers and efforts on one freedom each of joints that have several; the tree runs through the universal
    joint backwards."""
    parts = [block("a fork", (0.2, 0.1, 0)), block("ram", (0.05, 0, 0.1), 0.7), block("slab", (0.2, 0.3, 0), 0.5)]
    joints = [
        joint("base", "ram", "cylindrical", Z, (0, 0, 0)),
        joint("a fork", "ram", "universal", X, (0.1, 0, 0), Y),
        joint("base", "slab", "planar", SLANT, (0.2, 0.2, 0)),
    ]
    law = Law("constant", value=0.4)
    drives = [
        replace(drive("base~ram", "spring", stiffness=90.0, rest=0.02), freedom="slide"),
        replace(drive("base~ram", "damper", damping=0.3), freedom="turn"),
        replace(drive("a fork~ram", "spring", stiffness=3.0, rest=15.0), freedom="turn"),
        replace(drive("a fork~ram", "effort", law), freedom="turn2"),
        replace(drive("base~slab", "servo", Law("constant", value=0.05), kp=40.0, kd=2.0), freedom="v"),
        replace(drive("base~slab", "spring", stiffness=30.0), freedom="u"),
        replace(drive("base~slab", "damper", damping=0.1), freedom="turn"),
    ]
    return device(parts, joints, drives=drives, **({"duration": 0.6, "step": 0.05} | request))


def passive_seeker(**request):
    """The same two turns with forces: a spring, a damper, a torque, loads in the world and on the body."""
    parts = [block("outer", (0, 0.1, 0)), block("inner", (0.05, 0, 0), 0.7)]
    joints = [joint("base", "outer", "revolute", Z, (0, 0, 0)), joint("inner", "outer", "revolute", Y, (0, 0, 0.1))]
    drives = [
        drive("base~outer", "spring", stiffness=3.0, rest=20.0),
        drive("base~outer", "damper", damping=0.1),
        drive("inner~outer", "effort", Law("constant", value=0.3)),
    ]
    loads = [
        Load("inner", np.array([0.3, -0.2, 0.5]), np.array([0.01, 0.02, 0.0]), np.array([0.2, 0, 0]), "body", "d", 1),
        Load("outer", np.array([0.0, 0.4, 0.1]), np.array([0.0, 0.0, 0.03]), np.array([0, 0.1, 0.1]), "world", "d", 2),
    ]
    return device(parts, joints, drives=drives, loads=loads, **({"duration": 1.0, "step": 0.05} | request))


def swinging(found, **request):
    """The same design left to itself under a slanted gravity: dynamics, without drives, and without ranges, which
    exports would make limits of."""
    key = (id(found), *sorted(request.items()))
    if key not in _swung:
        asked = SimulationRequest(**({"gravity": np.array([3.0, -2.0, -9.0]), "duration": 0.2, "step": 0.01} | request))
        function = replace(found.assembly.function, drives=())
        assembly = replace(found.assembly, simulation=asked, function=function)
        _swung[key] = found, stages.simulate(replace(found, assembly=assembly), level="dynamic", ranges=False)
    return _swung[key][1]


_swung = {}
"""Designs of `swinging`, with those that they were made from."""


def motorised(**request):
    """A servo on one turn, a DC motor on the other."""
    parts = [block("outer", (0, 0.1, 0)), block("inner", (0.05, 0, 0), 0.7)]
    joints = [joint("base", "outer", "revolute", Z, (0, 0, 0)), joint("inner", "outer", "revolute", Y, (0, 0, 0.1))]
    drives = [
        drive("base~outer", "servo", Law("constant", value=20.0), kp=4.0, kd=0.5, ki=2.0, limit=50.0),
        drive("inner~outer", "dc_motor", resistance=2.0, constant=0.05, gear=10.0, voltage=6.0),
    ]
    return device(parts, joints, drives=drives, **({"duration": 0.2, "step": 0.05} | request))


def controlled(**request):
    """A servo that reaches its limit on a table, a motor with a coil on a voltage that swings."""
    parts = [block("outer", (0, 0.1, 0)), block("inner", (0.05, 0, 0), 0.7)]
    joints = [joint("base", "outer", "revolute", Z, (0, 0, 0)), joint("inner", "outer", "revolute", Y, (0, 0, 0.1))]
    swept = Law("table", times=(0.1, 0.2, 0.4), values=(0.0, 40.0, -20.0))
    drives = [
        drive("base~outer", "servo", swept, kp=4.0, kd=0.3, ki=2.0, limit=1.2),
        drive("inner~outer", "dc_motor", sine(12, 2), resistance=2.0, constant=0.05, gear=10.0, inductance=0.02),
    ]
    return device(parts, joints, drives=drives, **({"duration": 0.5, "step": 0.01} | request))


def every_joint(**request):
    """A chain with all kinds of joints, some of them backwards."""
    parts = [block(f"b{k}", (0.1 * k, 0.05, 0.02 * k), 1.0 / k) for k in range(1, 8)]
    joints = [
        joint("b1", "base", "cylindrical", SLANT, (0, 0, 0.1)),
        joint("b1", "b2", "universal", X, (0.1, 0, 0), axis2=Y),
        joint("b2", "b3", "screw", Y, (0.2, 0, 0), pitch=0.05),
        joint("b3", "b4", "fixed"),
        joint("b4", "b5", "spherical", None, (0.4, 0, 0)),
        joint("b5", "b6", "planar", SLANT, (0.5, 0.1, 0)),
        joint("b6", "b7", "prismatic", Z, (0.6, 0, 0)),
    ]
    start = (initial("b2~b3", 30, 60), initial("b6~b7", 0.02, 0.3))
    return device(parts, joints, initial=start, **({"duration": 0.3, "step": 0.02} | request))


def reversed_joints(**request):
    """Spherical, planar and universal joints that the tree runs through backwards."""
    parts = [block("a", (0.1, 0.05, 0)), block("ball", (0.2, 0.05, 0.1), 0.5), block("aa", (0.3, 0, 0.1), 0.3)]
    joints = [
        joint("ball", "base", "spherical", None, (0.05, 0, 0)),
        joint("a", "ball", "planar", SLANT, (0.2, 0, 0)),
        joint("a", "aa", "universal", X, (0.3, 0, 0), axis2=SLANT),
    ]
    return device(parts, joints, **({"duration": 0.3, "step": 0.02} | request))


def four_bar(**request):
    """A crank and rocker that falls; every hinge is a journal, so the loop is three times redundant."""
    a, b, c = np.array([0.03, 0.05, 0.0]), np.array([0.09, 0.07, 0.0]), np.array([0.1, 0.0, 0.0])
    parts = [rod("crank", (0, 0, 0), a, 0.3), rod("coupler", a, b, 0.4), rod("rocker", b, c, 0.5)]
    parts = [_thick(part) for part in parts]
    joints = [
        joint("base", "crank", "revolute", Z, (0, 0, 0)),
        joint("base", "rocker", "revolute", Z, c),
        joint("coupler", "crank", "revolute", Z, a),
        joint("coupler", "rocker", "revolute", Z, b),
    ]
    values = {"duration": 0.5, "step": 0.02, "gravity": DOWN, "initial": (initial("base~crank", 0, 300),)}
    return device(parts, joints, **(values | request))


def slider_crank(**request):
    """A crank that turns freely and drives a slider."""
    a, b = np.array([0.03, 0.04, 0.0]), np.array([0.15, 0.0, 0.0])
    parts = [_thick(rod("crank", (0, 0, 0), a, 0.3)), _thick(rod("rod", a, b, 0.2)), block("slider", b, 0.3)]
    joints = [
        joint("base", "crank", "revolute", Z, (0, 0, 0)),
        joint("base", "slider", "prismatic", X, b),
        joint("crank", "rod", "revolute", Z, a),
        joint("rod", "slider", "revolute", Z, b),
    ]
    values = {"duration": 0.5, "step": 0.02, "gravity": DOWN, "initial": (initial("base~crank", 0, 300),)}
    return device(parts, joints, **(values | request))


def driven_four_bar(**request):
    """The four-bar with its crank driven."""
    return four_bar(drives=[drive("base~crank", "motion", Law("ramp", rate=90.0))], initial=(), **request)


def spatial_loop(**request):
    """Two rods between the ground's universal and spherical joints: a loop without redundancy."""
    p, m, e = np.zeros(3), np.array([0.4, 0.1, -0.3]), np.array([0.8, 0, 0.1])
    parts = [block("one", 0.5 * (p + m), 0.5), block("two", 0.5 * (m + e), 0.4)]
    joints = [
        joint("base", "one", "universal", X, p, axis2=Y),
        joint("base", "two", "spherical", None, e),
        joint("one", "two", "universal", Y, m, axis2=Z),
    ]
    return device(parts, joints, **({"duration": 0.4, "step": 0.02} | request))


def nested(**request):
    """A chain in sub-assemblies: an arm with a wrist in it, driven inside and held from outside."""
    parts = [
        block("arm/upper", (0.1, 0, 0)), block("arm/wrist/hand", (0.3, 0.1, 0), 0.5),
        block("arm/wrist/finger", (0.4, 0, 0.1), 0.2), block("tool", (0.5, 0, 0), 0.3),
    ]  # fmt: skip
    joints = [
        joint("arm/upper", "base", "revolute", Y, (0, 0, 0)),
        joint("arm/upper", "arm/wrist/hand", "revolute", Z, (0.2, 0, 0)),
        joint("arm/wrist/finger", "arm/wrist/hand", "prismatic", X, (0.3, 0, 0)),
        joint("arm/wrist/finger", "tool", "spherical", None, (0.45, 0, 0)),
    ]
    drives = [
        drive("arm/wrist/finger~arm/wrist/hand", "spring", stiffness=400.0, rest=0.01),
        drive("arm/upper~arm/wrist/hand", "motion", sine(20, 1)),
    ]
    start = (initial("arm/upper~base", 5, 30), initial("arm/wrist/finger~arm/wrist/hand", 0.01, 0.1))
    push = Load("arm/wrist/hand", np.array([0.0, 1.0, 0.0]), None, None, "world", "d", 1)
    values = {"drives": drives, "initial": start, "loads": [push], "duration": 0.4, "step": 0.02}
    assembly, chain, mass = device(parts, joints, **(values | request))
    known_as = (Subassembly("arm", "arm.toml", None, HERE), Subassembly("arm/wrist", "wrist.toml", None, HERE))
    return replace(assembly, subassemblies=known_as), chain, mass


CHAINS = {
    made.__name__: made
    for made in (
        pendulum,
        gimbal,
        seeker,
        passive_seeker,
        every_joint,
        reversed_joints,
        nested,
        motorised,
        controlled,
        freedoms,
    )
}
LOOPS = {made.__name__: made for made in (four_bar, slider_crank, driven_four_bar, spatial_loop)}
ALL = CHAINS | LOOPS


@cache
def known(name):
    """The design of that name, with our run."""
    found = design(ALL[name]())
    assert found.simulation.status == "done", found.simulation.reason
    assert found.simulation.level == "dynamic"
    return found


def written(found, format, folder):
    """The file of an export, written to the folder, and what was lost."""
    made = export(found, format)
    write(made, folder)
    (main,) = (folder / name for name in made.files if "/" not in name) if format != "vhdl-ams" else (folder,)
    return main, made.lost


def model_of(found):
    """What exporters read."""
    return export_model(found)


def _thick(part):
    """A rod with some moment about its own axis too, as MuJoCo wants."""
    return replace(part, override=replace(part.override, inertia=part.override.inertia + 1e-5 * np.eye(3)))
