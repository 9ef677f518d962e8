"""VHDL-AMS: read back statement by statement along our trajectory, and analysed by GHDL."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import BPoly
from support.export_models import ALL, design, driven_four_bar, known, swinging
from support.other_programs import analysed, controlled_by_voltage, opened, order
from support.places import FIXTURES, manifests, stories
from support.validators import ghdl
from support.vhdl_expressions import Jet
from support.vhdl_reader import SIZES, read
from support.vhdl_residuals import constant, residuals

from kinform.behaviour import JointComponent, Servo
from kinform.exports import export
from kinform.exports.model import export_model
from kinform.exports.vhdl_ams import writer as vhdl_ams
from kinform.exports.vhdl_ams.structure import COUNT
from kinform.foundation.algebra.spatial import cross_motion, multiply, quaternions

FREEDOMS = {
    "pendulum": 1, "gimbal": 3, "seeker": 1, "passive_seeker": 2, "every_joint": 12, "reversed_joints": 8, "nested": 5,
    "four_bar": 1, "slider_crank": 1, "driven_four_bar": 0, "spatial_loop": 1,
    "motorised": 2, "controlled": 2, "freedoms": 7,
}  # fmt: skip
"""Freedoms of the devices, by hand: those that no drive prescribes."""


def kinematics_at(model, k):
    """Coordinates, rates and accelerations of our run at output k."""
    run, mechanism = model.simulation, model.mechanism
    q, v, acceleration = mechanism.start, np.zeros(mechanism.rates), np.zeros(mechanism.rates)
    for n, slot in enumerate(mechanism.slots):
        columns = slice(int(run.joint_offset[n]), int(run.joint_offset[n + 1]))
        q[slot.q] = run.joint_position[k, columns]
        v[slot.v] = run.joint_velocity[k, columns][1 if slot.has_ball else 0 :]
        acceleration[slot.v] = run.joint_acceleration[k, columns][1 if slot.has_ball else 0 :]
    return q, v, acceleration


def jets(model, entities, flat, top, k):
    """Potentials of nodes and quantities of our run at output k, by the names of the flat system."""
    mechanism = model.mechanism
    q, v, acceleration = kinematics_at(model, k)
    X = mechanism.poses(q)
    screws = mechanism.screws(X)
    V = mechanism.twists(screws, v)
    carried = cross_motion(V[mechanism.column_link], screws * v[:, None])
    A = mechanism.moves @ (carried + screws * acceleration[:, None])
    by_text = {}
    for name, link in zip(mechanism.bodies, mechanism.link_of, strict=True):
        R, w, z = X[link, :3, :3], V[link, :3], A[link, :3]
        p = X[link, :3, 3] - R @ mechanism.centre
        # Twists are about the centre: their linear part is the velocity of the body's point that is there.
        dp = V[link, 3:] + np.cross(w, p)
        ddp = A[link, 3:] + np.cross(z, p) + np.cross(w, dp)
        turn = quaternions(R[None])[0]
        dq = 0.5 * multiply(np.concatenate([[0.0], w]), turn)
        ddq = 0.5 * (multiply(np.concatenate([[0.0], z]), turn) + multiply(np.concatenate([[0.0], w]), dq))
        by_text[name] = (
            np.stack([p + mechanism.centre, dp, ddp]), np.stack([w, z, np.full(3, np.nan)]), np.stack([turn, dq, ddq])
        )  # fmt: skip
    potentials, quantities = {}, {}

    def place(node, body):
        p, w, turn = by_text[body]
        for n, axis in enumerate("xyz"):
            potentials[f"{node}_{axis}"] = Jet(p[:, n])
            potentials[f"{node}_r{axis}"] = Jet(w[:, n])
        quantities[f"{node}_q"] = Jet(turn)

    system = model.system
    nodes = {}
    for path, entity, _, ports in flat.leaves:
        if entity.name in ("ground", "rigid_body"):
            nodes[path.rstrip("/").rsplit("/", 1)[-1].removesuffix("_i")] = ports["x"].removesuffix("_x")
    for body in system.bodies:
        label = re.sub(r"_+", "_", re.sub(r"\W", "_", body.name))
        place(nodes[label], body.subject)
    for joint in system.joints:
        (slot,) = (s for s in mechanism.slots if s.name == joint.subject)
        label = re.sub(r"_+", "_", re.sub(r"\W", "_", joint.name))
        paths = [(p, ports) for p, e, _, ports in flat.leaves if p.rstrip("/").rsplit("/", 1)[-1] == f"{label}_i"]
        if not paths:
            continue
        ((_, ports),) = paths
        end = ports["bx"].removesuffix("_x")
        if end not in nodes.values():
            place(end, system.body_at(joint.name, "b").subject)
        if slot.has_ball:
            continue
        for n, (coordinate, _) in enumerate(joint.kind.coordinates):
            values = q[slot.q][n], v[slot.v][n], acceleration[slot.v][n]
            quantities[ports[coordinate]] = Jet(values)
    for path, entity, _, ports in flat.leaves:
        label = path.rstrip("/").rsplit("/", 1)[-1].removesuffix("_i")
        if entity.name in ("servo", "dc_motor"):
            (actor,) = (c for c in system.components if re.sub(r"_+", "_", re.sub(r"\W", "_", c.name)) == label)
            _electric(model, actor, k, path, ports, potentials, quantities)
    return potentials, quantities


def _electric(model, actor, k, path, ports, potentials, quantities):
    """The states of a servo or motor, by integrating its law along our run."""
    run, system = model.simulation, model.system
    (joint,) = (c for c, _ in system.at(actor.name, "shaft") if isinstance(c, JointComponent))
    (column,) = (c for c, name in zip(run.joint_offset, run.joint_names, strict=False) if name == joint.subject)
    states = (run.joint_position, run.joint_velocity, run.joint_acceleration)
    curve = BPoly.from_derivatives(run.time, np.stack([values[:, column + actor.freedom] for values in states], axis=1))
    rate, t = curve.derivative(), float(run.time[k])
    if isinstance(actor, Servo):
        control, target = actor.controller, actor.target
        quantities[ports["target"]] = Jet([target.value(t), target.rate(t), target.acceleration(t)])

        def change(t, y):
            e = target.value(t) - curve(t)
            wanted = control.kp * e + control.ki * y[0] + control.kd * (target.rate(t) - rate(t))
            return [0.0 if wanted * np.sign(e) > control.limit else e]

        states = {"sum": change}
    else:
        supply, motor = system.supply(actor.name), actor.constant * actor.gear
        potentials[ports["p"]] = Jet([supply.signal.value(t), supply.signal.rate(t), np.nan])
        if not actor.inductance:
            return

        def change(t, y):
            return [(supply.signal.value(t) - actor.resistance * y[0] - motor * rate(t)) / actor.inductance]

        states = {"i": change}
    for name, law in states.items():
        value = [0.0]
        for start, end in pairwise(run.time[: k % len(run.time) + 1]):
            value = solve_ivp(law, (start, end), value, rtol=1e-10, atol=1e-12).y[:, -1]
        quantities[f"{path}{name}"] = Jet([value[0], law(t, value)[0], np.nan])


def worst(found, made, samples=None):
    """The worst residual along our run (at its first step, half way and at its end), and all solutions."""
    entities, flat, top = opened(made)
    model = export_model(found)
    run = model.simulation
    out = []
    for k in samples or (1, len(run.time) // 2, -1):
        potentials, quantities = jets(model, entities, flat, top, k)
        # Just after the time of the output: tables begin their next stretch there.
        out.append(residuals(flat, potentials, quantities, float(run.time[k])))
    return max(out, key=lambda r: r.worst), out


@pytest.mark.parametrize("name", ALL)
def test_every_statement_holds_along_our_trajectory(name):
    found = known(name)
    made = export(found, "vhdl-ams")
    largest, _ = worst(found, made)
    assert largest.worst < 1e-6, largest.where
    assert largest.equations == largest.unknowns
    assert largest.freedoms == FREEDOMS[name]
    stated = re.search(r"-- (\d+) equations for \1 unknowns: through", made.files[order(made.files)[2]].decode())
    assert int(stated[1]) == largest.equations


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("m * v'dot == f + m * g", "m * v'dot == f - m * g"),
        ("h'dot == t - cross(r, f)", "h'dot == t + cross(r, f)"),
        ("pb + sb == pa + sa;", "pb + sb == pa + 1.001 * sa;"),
        ("wb == wa + angle_rate * u", "wb == wa - angle_rate * u"),
        ("0.5 * product(imaginary(w), q)", "0.5 * product(q, imaginary(w))"),
        ("a(1) * b(2) - a(2) * b(1)", "a(1) * b(2) + a(2) * b(1)"),
    ],
)
def test_a_wrong_statement_does_not_hold(old, new):
    found = known("gimbal")
    made = export(found, "vhdl-ams")
    files = {name: data.decode().replace(old, new).encode() for name, data in made.files.items()}
    assert files != made.files
    largest, _ = worst(found, replace(made, files=files), samples=(7,))
    assert largest.worst > 1e-5


@pytest.mark.parametrize(
    ("old", "new", "sample"),
    [
        ("kd * e'dot", "kd * value'dot", 22),
        ("given == bound", "given == wanted", 12),
        ("sum'dot == e", "sum'dot == 2.0 * e", 22),
        ("inductance * i'dot", "0.9 * inductance * i'dot", 22),
        ("effort == coupling * gear * i", "effort == coupling * i", 30),
    ],
)
def test_a_wrong_statement_of_a_drive_does_not_hold(old, new, sample):
    found = known("controlled")
    made = export(found, "vhdl-ams")
    files = {name: data.decode().replace(old, new).encode() for name, data in made.files.items()}
    assert files != made.files
    largest, _ = worst(found, replace(made, files=files), samples=(sample,))
    assert largest.worst > 1e-4


def test_efforts_of_drives_are_those_of_our_run():
    found = known("seeker")
    _, solved = worst(found, export(found, "vhdl-ams"), samples=(3, 10))
    run = found.simulation
    for k, result in zip((3, 10), solved, strict=True):
        for number, name in ((1, "base~outer"), (2, "inner~outer")):
            (effort,) = (v for n, v in result.through.items() if n.startswith(f"drive_{number}_"))
            column = run.joint_offset[run.joint_names.index(name)]
            assert effort[0] == pytest.approx(run.joint_effort[k, column], abs=1e-7)


def test_each_component_states_as_many_equations_as_it_has_unknowns():
    """That it has as many is counted along the trajectories, where every statement is evaluated."""
    made = export(known("gimbal"), "vhdl-ams")
    entities, _ = read([made.files[name].decode() for name in ("1_mechanics.vhd", "2_components.vhd")])
    assert set(entities) == set(COUNT)
    for name, entity in entities.items():
        declared = [*entity.quantities.values(), *entity.outputs.values()]
        unknowns = len(entity.branches) + sum(SIZES[kind] for kind in declared)
        assert entity.stated == unknowns == COUNT[name], name


def test_the_bench_starts_where_our_run_does():
    found = known("gimbal")
    made = export(found, "vhdl-ams")
    entities, flat, top = opened(made)
    ((_, _, starts, _),) = entities[f"{top}_bench"].parts
    model = export_model(found)
    assert constant(starts["joint_base_outer_angle_start"]) == pytest.approx(np.radians(10), rel=1e-15)
    assert constant(starts["joint_base_outer_angle_rate_start"]) == pytest.approx(np.radians(40), rel=1e-15)
    np.testing.assert_array_equal(constant(starts["body_inner_q_start"]), model.start["inner"].quaternion)
    given = [c for _, e, c, _ in flat.leaves if e.name == "revolute_joint"]
    assert [c["angle_given"] for c in given] == ["true"] * 3


def test_a_driven_coordinate_is_not_given_a_start():
    text = export(known("driven_four_bar"), "vhdl-ams").files["3_device.vhd"].decode()
    assert not re.search(r"angle_given : boolean := true", text)


def test_a_run_without_forces_holds_what_rests():
    from support.export_models import four_bar

    found = design(four_bar(level="kinematic", initial=()))
    text = export(found, "vhdl-ams").files["3_device.vhd"].decode()
    assert text.count("entity work.motion_constant") == 1
    found = design(driven_four_bar(level="kinematic"))
    assert "motion_constant" not in export(found, "vhdl-ams").files["3_device.vhd"].decode()


@pytest.mark.parametrize("name", ALL)
def test_ghdl_accepts_every_kind_of_component(name, tmp_path):
    ran = analysed(export(known(name), "vhdl-ams"), tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")


OFTEN = {
    "four_bar", "slider_crank", "seeker_2dof", "gear_pair", "screw_right", "cylindrical_gap_005", "shaky_truss",
    "stick_four_bar",
}  # fmt: skip
"""One fixture for each kind of loop, joint and coupling, with meshes and without; the others are of the sweep."""


def named(manifest):
    """A manifest by its place among the fixtures."""
    return "-".join(dict.fromkeys(manifest.relative_to(FIXTURES).with_suffix("").parts))


def often(found):
    """The manifests, those that are not in OFTEN marked as of the sweep."""
    return [pytest.param(m, id=named(m), marks=[pytest.mark.sweep] * (m.stem not in OFTEN)) for m in found]


@pytest.mark.parametrize("manifest", often([*manifests(), *stories()]))
def test_ghdl_accepts_every_fixture(manifest, tmp_path, derive_design):
    ghdl()
    ran = analysed(export(derive_design(manifest), "vhdl-ams"), tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")


def test_ghdl_accepts_a_controller_of_a_voltage(tmp_path):
    made = vhdl_ams.export(controlled_by_voltage())
    assert b"entity work.voltage_controller" in made.files["3_device.vhd"]
    ran = analysed(made, tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("rx => body_base_rx", "rx => body_base_x"),
        ("h'dot == t", "h'dot == torque"),
        ("quantity fx_through", "quantity"),
        ("entity work.rigid_body", "entity work.soft_body"),
        ("terminal x, y, z : translational", "terminal x, y, z : electrical"),
    ],
)
def test_ghdl_rejects_a_broken_twin(old, new, tmp_path):
    made = export(known("gimbal"), "vhdl-ams")
    files = {name: data.decode().replace(old, new).encode() for name, data in made.files.items()}
    if files == made.files:
        files["2_components.vhd"] = files["2_components.vhd"].replace(b" through fx", b" trough fx")
        files["2_components.vhd"] = files["2_components.vhd"].replace(b"fx through", b"fx thru")
    assert files != made.files
    assert analysed(replace(made, files=files), tmp_path).returncode == 1


@pytest.mark.parametrize("manifest", often(manifests()))
def test_every_statement_of_a_fixture_holds_along_its_trajectory(manifest, derive_design):
    """Below the dynamic level no accelerations are known, so all are simulated with forces; what cannot be, says so."""
    found = derive_design(manifest)
    if found.simulation.level != "dynamic":
        found = swinging(found)
    made = export(found, "vhdl-ams")
    rank = found.simulation.rank
    if found.simulation.status not in ("done", "stopped") or rank.max() > rank[0]:
        assert made.lost
        return
    largest, _ = worst(found, made, samples=(-1,))
    # In wrong units a seeker weighs a million tons.
    heaviest = max((b.mass for b in found.mass.bodies if b.mass is not None), default=0.0)
    assert largest.worst < 1e-6 * max(1.0, heaviest), largest.where
    assert largest.equations == largest.unknowns


def test_sub_assemblies_keep_their_entities():
    """Bodies and joints that are all of a sub-assembly are in its entity; what crosses its border is a port."""
    made = export(known("nested"), "vhdl-ams")
    entities, flat, top = opened(made)
    assert {"arm", "arm_wrist"} <= set(entities)
    assert {kind for _, kind, _, _ in entities[top].parts} == {
        "ground",
        "rigid_body",
        "arm",
        "revolute_joint",
        "spherical_joint",
    }
    assert [kind for _, kind, _, _ in entities["arm_wrist"].parts].count("prismatic_joint") == 1
    assert "spring" in {kind for _, kind, _, _ in entities["arm_wrist"].parts}
    assert set(entities["arm"].terminals) >= {"body_arm_upper_x", "body_arm_wrist_finger_x"}
    assert not any(name.startswith("body_arm_wrist_hand") for name in entities[top].inner)
    assert {path.count("/") for path, _, _, _ in flat.leaves} == {1, 2, 3}
