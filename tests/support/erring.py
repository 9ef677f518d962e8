"""For each rule that may find an error a small design in which it does, with the files that it is read from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinform import contacts, kinematics, stages, surfaces
from kinform.changes import read_lock, snapshot, with_lock, write_lock
from kinform.consistency import check
from kinform.design import Design
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.model.function import Coupling, Function, InitialValue, Law, SimulationRequest
from support.assemblies import assembly
from support.devices import intended, sine
from support.gear_trains import gear_pair
from support.mistakes import WRONG, changed_function, changed_joint, drive, with_function
from support.places import FIXTURES
from support.requirements import (
    ORIGIN,
    Y,
    Z,
    arm,
    bar,
    circle,
    gimbal,
    requiring,
    rubbing_arm,
    thin_wall,
    wheel,
)
from support.robots import ring
from support.solids import block, part, save
from support.walkers import Box, Walker


def checked(design):
    return replace(design, report=check(design))


def whole(path):
    design = stages.joints(stages.contacts(stages.import_(path)))
    return stages.check(stages.simulate(stages.mass(design)))


def fixture(*path):
    return lambda folder, derive: checked(derive(FIXTURES.joinpath(*path)))


def hinge(derive):
    found = derive(FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml")
    own = found.kinematics.joints[0]
    return with_function(found, Function(joints=(intended("swing", *own.bodies, "revolute", own.axis, own.point),)))


def of_hinge(change):
    return lambda folder, derive: checked(change(hinge(derive)))


def stated(folder, text):
    """The lines of the manifest that designs without one name."""
    (folder / "m.toml").write_text(text)


def required(make):
    def made(folder, derive):
        stated(folder, "\n" * 39 + 'kind = "r"\n')
        return checked(make(derive))

    return made


def walking(change):
    """A description whose rules need no more than its text and its geometry."""

    def made(folder, derive):
        walker = Walker()
        change(walker.links["torso"], walker)
        (folder / "walker.urdf").write_text(walker.text())
        return whole(folder / "walker.urdf")

    return made


def meshed(change):
    """One part of whose facets some are changed, as OBJ."""

    def made(folder, derive):
        mesh = block(20, 30, 40).to_mesh64()
        vertices, faces = np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts, dtype=int)
        lines = [f"v {x} {y} {z}" for x, y, z in vertices.tolist()]
        lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in change(faces).tolist()]
        (folder / "block.obj").write_text("\n".join(lines) + "\n")
        part = '[[part]]\nname = "block"\nmesh = "block.obj"\ndensity = 1000\n'
        (folder / "m.toml").write_text(f'schema = 1\n[assembly]\nname = "a"\nunits = "mm"\n{part}')
        return whole(folder / "m.toml")

    return made


def manifest(folder, parts, rest, more=""):
    """A manifest of solids (mm)."""
    lines = ["schema = 1", "[assembly]", 'name = "made"', 'units = "mm"']
    for name, solid in parts.items():
        save(solid, folder / f"{name}.stl")
        lines += ["[[part]]", f'name = "{name}"', f'mesh = "{name}.stl"', more]
    (folder / "made.toml").write_text("\n".join([*lines, rest]))
    return folder / "made.toml"


def weightless(folder, derive):
    rest = '[simulation]\nlevel = "dynamic"\nduration = 1.0\nstep = 0.01\n'
    path = manifest(folder, {"base": block(20, 20, 20), "arm": block(10, 10, 10).translate((0, 0, 15))}, rest)
    return whole(path)


def pinned(folder, derive):
    """A pin in a bore that a URDF leaves free."""
    (folder / "ring.obj").write_text(ring(0.01, 0.03, 0.06))
    pin = '<origin xyz="0 0 0.03"/><geometry><cylinder radius="0.01" length="0.06"/></geometry>'
    (folder / "r.urdf").write_text(
        '<robot name="r">\n<link name="base"><visual><geometry><mesh filename="ring.obj"/></geometry></visual></link>\n'
        f'<link name="pin"><visual>{pin}</visual></link>\n'
        '<joint name="j" type="floating"><parent link="base"/><child link="pin"/></joint>\n</robot>\n'
    )
    return whole(folder / "r.urdf")


def limited(limits):
    def made(folder, derive):
        def shape(size, at):
            place, sides = (" ".join(map(str, values)) for values in (at, size))
            return f'<visual><origin xyz="{place}"/><geometry><box size="{sides}"/></geometry></visual>'

        (folder / "r.urdf").write_text(
            f'<robot name="r">\n<link name="base">{shape((0.1, 0.1, 0.1), (0, 0, 0))}</link>\n'
            f'<link name="arm">{shape((0.1, 0.1, 0.1), (0, 0, 0.1))}</link>\n'
            '<joint name="j" type="revolute">\n<parent link="base"/><child link="arm"/>\n'
            f'<axis xyz="0 0 1"/>\n{limits}\n</joint>\n</robot>\n'
        )
        return whole(folder / "r.urdf")

    return made


def followed(folder, derive):
    """A finger that follows another one backwards, with the limits of that one."""
    limited('<limit lower="0" upper="0.5" effort="1" velocity="1"/>')(folder, derive)
    text = (folder / "r.urdf").read_text()
    other = (
        '<link name="other"><visual><origin xyz="0 0 -0.1"/><geometry><box size="0.1 0.1 0.1"/></geometry></visual>'
        "</link>\n"
        '<joint name="k" type="revolute">\n<parent link="base"/><child link="other"/>\n<axis xyz="0 0 1"/>\n'
        '<limit lower="0" upper="0.5" effort="1" velocity="1"/>\n<mimic joint="j" multiplier="-1"/>\n</joint>\n</robot>'
    )
    (folder / "r.urdf").write_text(text.replace("</robot>", other))
    return whole(folder / "r.urdf")


def sub_assembly(folder, derive):
    found = derive(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
    subs = tuple(replace(one, mobility=2) for one in found.assembly.subassemblies)
    return checked(replace(found, assembly=replace(found.assembly, subassemblies=subs)))


def geared(folder, derive):
    solids = gear_pair(20, 24)
    made = assembly(*(part(name, solid, np.eye(4)) for name, solid in solids.items()), ground=None)
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    touching = contacts.find(made, found)
    design = Design(made, surfaces=found, contacts=touching, kinematics=kinematics.derive(made, found, touching))
    axes = tuple(
        intended(name, "housing", gear, "revolute", Z, ORIGIN) for name, gear in (("a", "gear0"), ("b", "gear1"))
    )
    return checked(with_function(design, Function(joints=axes, couplings=(Coupling(("a", "b"), 3.0, "m.toml", 9),))))


def turned_into(folder, derive):
    """The gimbal asked to turn by 45°, and driven so: its motor meets the housing."""
    found = derive(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
    function, limit = found.assembly.function, np.radians(45.0)
    joints = tuple(replace(j, range=(-limit, limit)) if j.name == "yaw" else j for j in function.joints)
    law = Law("sine", amplitude=45.0, frequency=0.5)
    drives = tuple(replace(d, law=law) if d.joint == "yaw" else d for d in function.drives)
    changed = replace(found.assembly, function=replace(function, joints=joints, drives=drives))
    run = stages.simulate(replace(found, assembly=changed), level="kinematic", ranges=False)
    return stages.check(replace(run, simulation=replace(run.simulation, ranges=found.simulation.ranges)))


def carriage(folder, derive):
    """A carriage that leaves its rail."""
    rail = block(200, 60, 20).translate((0, 0, -10))
    walls = [block(200, 10, 40).translate((0, y, 0)) for y in (-25, 25)]
    parts = {"rail": rail + walls[0] + walls[1], "carriage": block(40, 40, 20).translate((0, 0, 10))}
    rest = """[[function.joint]]
name = "stroke"
between = ["rail", "carriage"]
type = "prismatic"
axis = [1, 0, 0]
[[function.drive]]
joint = "stroke"
kind = "motion"
law = {type = "sine", amplitude = 150.0, frequency = 1}
[simulation]
duration = 0.3
step = 0.01
"""
    path = manifest(folder, parts, rest, "density = 1000")
    return whole(path)


def locked(folder, derive):
    found = derive(FIXTURES / "pairs" / "revolute_collars" / "revolute_collars.toml")
    before = snapshot(found)
    (own,) = before.joints
    text = write_lock(replace(before, joints=(replace(own, type="spherical", freedoms=3),)))
    (folder / "b.lock.json").write_text(text)
    return replace(found, report=with_lock(check(found), found, read_lock(text, "b.lock.json")))


def opened(made):
    """A run whose disc has left its axis."""
    run = made.simulation
    places = run.p_WB.copy()
    places[50, run.body_names.index("disc")] += [1e-3, 0.0, 0.0]
    residual = np.zeros(len(run.time))
    residual[50] = 1e-3
    return replace(made, simulation=replace(run, p_WB=places, residual=residual))


def stopped(made):
    run = made.simulation
    arrays = ("time", "p_WB", "q_WB", "joint_position", "joint_velocity", "joint_effort", "energy", "residual", "rank")
    short = {name: getattr(run, name)[:50] for name in arrays}
    return replace(made, simulation=replace(run, status="stopped", reason="singular", **short))


def threaded(design):
    own = design.kinematics.joints[0]
    made = changed_joint(design, type="screw", pitch=0.002, twists=twists_of("screw", own.axis, own.point, 0.002))
    return changed_function(made, joints=(intended("swing", *own.bodies, "screw", own.axis, own.point, pitch=0.003),))


def acting(folder, derive):
    stated(folder, "\n" * 29 + 'joint = "wing"\n')
    return checked(changed_function(hinge(derive), drives=(drive("wing"),)))


def starting(folder, derive):
    stated(folder, "\n" * 8 + "[simulation.initial.wing]\n")
    made = hinge(derive)
    request = SimulationRequest(initial=(InitialValue("wing", 1.0, 0.0, 1.0, "m.toml", 9),), file="m.toml", line=8)
    return checked(replace(made, assembly=replace(made.assembly, simulation=request)))


def coarse(design):
    """The shaft of a file whose numbers go in steps of a thousandth of its size."""
    parts = tuple(
        replace(p, mesh=replace(p.mesh, resolution=1e-3 * p.mesh.diagonal)) if p.name == "shaft" else p
        for p in design.assembly.parts
    )
    return replace(design, assembly=replace(design.assembly, parts=parts))


def flipped(faces, some):
    out = faces.copy()
    out[some] = out[some][:, ::-1]
    return out


def absent(folder, derive):
    made = derive(FIXTURES / "pairs" / "free_apart" / "free_apart.toml")
    first, second = (p.name for p in made.assembly.parts)
    return checked(with_function(made, Function(joints=(intended("j", first, second, "revolute", Z, ORIGIN),))))


RUN = sine(30.0, 0.5)
POINT = {"part": "disc", "point": [0.1, 0, 0], "path": "p.csv", "tolerance": 1e-3}
POLES = {"type": "poses", "directions": [[0, 0, 1.0]]}


def pair(name):
    return FIXTURES / "pairs" / name / f"{name}.toml"


ERRING = {
    "KF101": fixture("broken", "seeker_open_mesh", "seeker_open_mesh.toml"),
    "KF102": meshed(lambda faces: faces[:, ::-1]),
    "KF103": meshed(lambda faces: flipped(faces, [0])),
    "KF110": fixture("broken", "seeker_wrong_units", "seeker_wrong_units.toml"),
    "KF111": of_hinge(coarse),
    "KF120": weightless,
    "KF121": walking(lambda torso, _: torso.products.update(ixx=-1e-4)),
    "KF123": walking(lambda torso, _: (setattr(torso, "mass_factor", 40.0), setattr(torso, "inertia_factor", 40.0))),
    "KF130": walking(lambda torso, _: setattr(torso, "collision", [Box((1e-4, 2e-4, 2e-4), (0.0, 0.0, 0.1))])),
    "KF131": walking(lambda torso, _: setattr(
        torso, "more", '<collision><geometry><mesh filename="meshes/gone.stl"/></geometry></collision>')),
    "KF201": fixture("broken", "seeker_gimbal_overlaps", "seeker_gimbal_overlaps.toml"),
    "KF203": fixture("pairs", "free_apart", "free_apart.toml"),
    "KF301": fixture("broken", "four_bar_missing_pin", "four_bar_missing_pin.toml"),
    "KF302": sub_assembly,
    "KF401": absent,
    "KF402": of_hinge(WRONG["KF402"]),
    "KF403": of_hinge(WRONG["KF403"]),
    "KF404": of_hinge(WRONG["KF404"]),
    "KF405": of_hinge(threaded),
    "KF406": fixture("broken", "seeker_missing_dowel", "seeker_missing_dowel.toml"),
    "KF409": acting,
    "KF410": starting,
    "KF411": geared,
    "KF412": turned_into,
    "KF414": fixture("broken", "four_bar_missing_pin", "four_bar_missing_pin.toml"),
    "KF415": limited('<limit lower="1.57" upper="-1.57" effort="1" velocity="1"/>'),
    "KF417": pinned,
    "KF418": followed,
    "KF421": required(lambda _: requiring(gimbal(), "reach", part="inner", direction=[1.0, 0, 0], region=POLES)),
    "KF422": required(lambda _: requiring(wheel(RUN), "follow", rows=circle(shift=0.002), **POINT)),
    "KF423": required(lambda _: requiring(
        bar(thin_wall(), reach=60), "clear", between=["bar", "base"], over="ranges")),
    "KF424": required(lambda _: requiring(arm(), "hold", joint="shoulder", limit=1.0)),
    "KF425": required(lambda _: requiring(wheel(RUN), "torque", joint="spin", limit=1e-3)),
    "KF426": required(lambda _: requiring(wheel(RUN), "speed", joint="spin", limit=1.0)),
    "KF427": required(lambda _: requiring(wheel(RUN), "reaction", joint="spin", force=4.0)),
    "KF428": required(lambda _: requiring(arm(), "mass", of="upper", maximum=0.5)),
    "KF429": required(lambda _: requiring(arm(), "centre_of_mass", of="upper", point=[0, 0, 0], tolerance=0.1)),
    "KF430": required(lambda _: requiring(arm(), "inertia", of="upper", axis=list(Y), maximum=1e-3)),
    "KF431": required(lambda _: requiring(arm(), "balance", of="upper", joint="shoulder", limit=0.1)),
    "KF432": required(lambda derive: requiring(derive(pair("planar_block")), "retained", part="block")),
    "KF433": required(lambda derive: requiring(
        derive(pair("cylindrical_gap_015")), "fit", between=["block", "shaft"], maximum=1e-4)),
    "KF434": required(lambda _: requiring(rubbing_arm(), "efficiency", joint="shoulder", minimum=0.999)),
    "KF435": required(lambda _: requiring(rubbing_arm(), "self_locking", joint="shoulder")),
    "KF436": required(lambda _: requiring(
        wheel(RUN), "torque_speed", joint="spin", speeds=[0.0, 9.0], efforts=[1e-3, 0.0])),
    "KF450": locked,
    "KF502": lambda folder, derive: checked(stopped(wheel(RUN))),
    "KF503": lambda folder, derive: checked(opened(wheel(RUN))),
    "KF505": turned_into,
    "KF507": carriage,
}  # fmt: skip
"""Code → (folder for files, derive) → design with findings, of which at least one of that code is an error."""
