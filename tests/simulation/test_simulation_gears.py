"""Gears from meshes: their motion, efforts, tooth forces and bearing loads against closed forms and MuJoCo."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.dynamics import moved
from support.gear_trains import epicyclic
from support.places import FIXTURES
from support.solids import assembly, part
from support.validators import package

from kinform import contacts, kinematics, surfaces
from kinform.exports import export
from kinform.mass import compile_mass
from kinform.model.function import Coupling, Drive, Function, Law, SimulationRequest
from kinform.simulation import simulate

PRESSURE = np.radians(20.0)
PINION, WHEEL = "frame~pinion", "frame~wheel"


@pytest.fixture(scope="module")
def run(derive_design):
    """A fixture simulated under drives and gravity, at a level."""

    def make(name, drives=(), gravity=(0.0, 0.0, 0.0), level="dynamic", couplings=(), **request):
        found = derive_design(FIXTURES / "mechanisms" / name / f"{name}.toml")
        asked = SimulationRequest(gravity=np.array(gravity), **({"duration": 0.2, "step": 0.01} | request))
        function = replace(found.assembly.function, drives=tuple(drives), couplings=tuple(couplings))
        return moved(replace(found, assembly=replace(found.assembly, simulation=asked, function=function)), level)

    return make


def driven(joint, kind, **law):
    return Drive(joint, kind, Law(**law), {}, 1.0, "device.toml", 1)


def inertias(design):
    """About z of the pinion and the wheel."""
    bodies = {body.name: body for body in design.mass.bodies}
    return bodies["pinion"].inertia[2, 2], bodies["wheel"].inertia[2, 2]


@pytest.mark.parametrize("torque", [-0.02, pytest.param(0.01, marks=pytest.mark.sweep)])
def test_a_torque_turns_both_wheels_by_the_inertia_that_it_feels(run, torque):
    """α = T / (I₁ + n² I₂); the teeth carry what the wheel takes, at the pressure angle; the bearings take it up."""
    found = run("gear_pair", [driven("pinion_bearing", "effort", type="constant", value=torque)])
    result, n = found.simulation, 18 / 24
    assert result.status == "done"
    first, second = inertias(found)
    rate = torque / (first + n * n * second)
    k, w = (result.joint_names.index(name) for name in (PINION, WHEEL))
    np.testing.assert_allclose(result.joint_position[:, k], 0.5 * rate * result.time**2, rtol=1e-9, atol=1e-13)
    np.testing.assert_allclose(result.joint_position[:, w], -n * result.joint_position[:, k], atol=1e-12)
    passed = second * n * rate
    assert result.gear_names == ("pinion~wheel",)
    np.testing.assert_allclose(result.gear_effort[:, 0], [[-n * passed, -passed]] * len(result.time), rtol=1e-9)
    force = abs(passed) / (0.5 * 24 * 3e-3) / np.cos(PRESSURE)
    np.testing.assert_allclose(result.gear_force[:, 0], force, rtol=1e-3)
    loads = result.F_B[:, :, 3:]
    np.testing.assert_allclose(np.linalg.norm(loads, axis=2), force, rtol=1e-3)
    # each flank pushes its wheel away from the other, whatever the sense of the torque
    assert (loads[:, k, 0] > 0.0).all()
    assert (loads[:, w, 0] < 0.0).all()
    assert result.balance.max() < 1e-9
    assert not result.undetermined.any()


def test_a_prescribed_motion_needs_the_torque_of_both_wheels(run):
    found = run(
        "gear_pair",
        [driven("wheel_bearing", "motion", type="sine", amplitude=30, frequency=2)],
        duration=0.5,
        step=0.005,
    )
    first, second = inertias(found)
    w = found.simulation.joint_names.index(WHEEL)
    t = found.simulation.time
    rate = -np.radians(30) * (4 * np.pi) ** 2 * np.sin(4 * np.pi * t)
    need = rate * (second + first * (24 / 18) ** 2)
    np.testing.assert_allclose(found.simulation.joint_effort[:, w], need, atol=1e-9 * np.abs(need).max())


def test_a_rack_falls_as_its_pinion_lets_it(run):
    """a = m g / (m + I / r²), r the pitch radius."""
    found = run("rack_and_pinion", gravity=(-9.81, 0.0, 0.0), duration=0.1)
    result, radius = found.simulation, 0.5 * 18 * 3e-3
    assert result.status == "done"
    bodies = {body.name: body for body in found.mass.bodies}
    mass, spin = bodies["rack"].mass, bodies["pinion"].inertia[2, 2] / radius**2
    fall = -9.81 * mass / (mass + spin)
    slide = result.joint_position[:, result.joint_names.index("frame~rack")]
    np.testing.assert_allclose(slide, 0.5 * fall * result.time**2, rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(result.gear_force, abs(spin * fall) / np.cos(PRESSURE), rtol=2e-3)
    total = result.energy @ np.array([1.0, 1.0, -1.0])
    assert np.abs(total - total[0]).max() < 1e-7 * np.ptp(result.energy[:, 0])


@pytest.mark.parametrize("level", ["kinematic", "dynamic"])
def test_a_run_ends_where_the_rack_does(run, level):
    """Nine teeth: half a pitch beyond the last one, less for where it stands."""
    found = run(
        "rack_and_pinion", [driven("pinion_bearing", "motion", type="ramp", rate=90)], level=level, duration=1.0
    )
    result = found.simulation
    assert result.status == "stopped"
    assert "pinion~rack" in result.reason
    last, radius = result.joint_position[-1, result.joint_names.index("frame~rack")], 0.5 * 18 * 3e-3
    end = 4.5 * np.pi * 3e-3 - radius * np.radians(3) - 0.32e-3
    assert 0.0 < end - last < radius * np.radians(0.9)
    assert len(result.F_A) == (len(result.time) if level == "dynamic" else 0)


def test_stated_couplings_count_as_found_where_teeth_keep_theirs(run):
    """The ratio of the geometry holds, whatever is stated: the difference is a finding of its own."""
    stated = Coupling(("pinion_bearing", "wheel_bearing"), -2.0, "device.toml", 9)
    drives = [driven("pinion_bearing", "motion", type="ramp", rate=90)]
    result = run("gear_pair", drives, couplings=[stated], level="kinematic").simulation
    k, w = (result.joint_names.index(name) for name in (PINION, WHEEL))
    assert result.joint_position[-1, k] / result.joint_position[-1, w] == pytest.approx(-24 / 18)


def test_a_geneva_wheel_is_refused_with_the_reason(run):
    result = run("geneva_driven").simulation
    assert result.status == "refused"
    assert [subject for subject, _ in result.failures] == ["driver~wheel"]


def test_mujoco_turns_them_by_its_own_coupling(run, tmp_path):
    mujoco = package("mujoco")
    found = run(
        "gear_pair", [driven("pinion_bearing", "effort", type="constant", value=0.01)], gravity=(1.0, -3.0, -9.0)
    )
    made = export(found, "mjcf")
    assert made.remarks
    for name, data in made.files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(data)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "gear_pair.xml"))
    state = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, state, 0)
    model.opt.timestep = 1e-4
    for _ in range(2000):
        mujoco.mj_step(model, state)
    np.testing.assert_allclose(state.qpos, found.simulation.joint_position[-1], rtol=1e-7)


def test_a_planet_in_a_ring_turns_back_as_its_carrier_turns_on():
    """ω_planet = (1 − 50/20) ω_carrier; α = T / (I_c + m a² + I_p (1 − 50/20)²)."""
    made = assembly(*(part(name, solid, np.eye(4)) for name, solid in epicyclic().items()), ground="frame")
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in made.parts}
    joined = kinematics.derive(made, found, contacts.find(made, found))
    assert (joined.mobility.instantaneous, joined.mobility.finite) == (1, 1)
    mass, torque = compile_mass(made, joined, found), 3e-5
    request = SimulationRequest(gravity=np.zeros(3), duration=0.2, step=0.02)
    drive = driven("carrier~frame", "effort", type="constant", value=torque)
    run = simulate(replace(made, simulation=request, function=Function(drives=(drive,))), joined, mass, level="dynamic")
    assert run.status == "done", run.reason
    bodies = {body.name: body for body in mass.bodies}

    def about_z(name):
        body = bodies[name]
        return body.inertia[2, 2] + body.mass * (body.centre_of_mass[:2] @ body.centre_of_mass[:2])

    own = bodies["planet"].inertia[2, 2]
    rate = torque / (about_z("carrier") + about_z("planet") - own + own * 1.5**2)
    # values of `carrier~frame` are of the frame relative to the carrier
    turned = -run.joint_position[:, run.joint_names.index("carrier~frame")]
    np.testing.assert_allclose(np.abs(turned), 0.5 * rate * run.time**2, rtol=1e-8, atol=1e-12)
    w, _, _, z = run.q_WB[-1, run.body_names.index("planet")]
    np.testing.assert_allclose(2.0 * np.arctan2(z, w), -1.5 * turned[-1], rtol=1e-8)
    assert run.balance.max() < 1e-9
