"""Motors with a rotor, its friction and a lossy gear of their own, and loops of speed: closed forms, the same machine
with the rotor as a body, and MuJoCo."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.validators import package

import kinform
from kinform.behaviour import Constant, Controller, Model, Sine
from kinform.errors import InputError
from kinform.exports import export
from kinform.simulation import Course, simulate_system

R, K, GEAR, MOST = 1.5, 0.05, 20.0, 3.0
LOAD, ROTOR, BRUSH = 0.08, 3e-4, 0.01
NONE, SPIN = np.zeros(3), (0.0, 0.0, 1.0)


def _one(
    efficiency,
    back=None,
    *,
    brush=BRUSH,
    volts=None,
    load=None,
    most=MOST,
    until=0.5,
    step=0.02,
    supply=None,
    gear=GEAR,
):
    """A wheel on a motor that has its rotor in itself."""
    model = Model()
    model.ground("ground")
    model.body("wheel", 1.0, (0, 0, 0), (1, 1, LOAD))
    model.joint("axle", "ground", "wheel", "revolute", point=(0, 0, 0), axis=SPIN)
    losses = {"rotor_inertia": ROTOR, "rotor_friction": brush, "efficiency": efficiency, "efficiency_back": back}
    model.motor("motor", "axle", R, 0.0, K, gear, most, **losses)
    if supply is None:
        model.voltage("supply", "motor", volts or Constant(0.0))
    else:
        supply(model)
    if load is not None:
        model.effort("load", "axle", Constant(load))
    return simulate_system(model.system(), Course(until, step, NONE))


def _two(efficiency, back, *, volts, load, until, step):
    """The same with the rotor as a body with a hinge, on a lossy gear."""
    model = Model()
    model.ground("ground")
    model.body("wheel", 1.0, (0, 0, 0), (1, 1, LOAD))
    model.body("rotor", 1.0, (0.5, 0, 0), (1, 1, ROTOR))
    model.joint("axle", "ground", "wheel", "revolute", point=(0, 0, 0), axis=SPIN)
    model.joint("shaft", "ground", "rotor", "revolute", point=(0.5, 0, 0), axis=SPIN)
    model.gear("gearbox", "shaft", "axle", GEAR, efficiency=efficiency, efficiency_back=back)
    model.motor("motor", "shaft", R, 0.0, K, 1.0, MOST)
    model.friction("brush", "shaft", effort=BRUSH)
    model.voltage("supply", "motor", volts)
    model.effort("load", "axle", Constant(load))
    return simulate_system(model.system(), Course(until, step, NONE))


def _sound(run):
    assert run.status == "done", run.reason
    exchanged = np.ptp(run.energy, axis=0).max()
    assert np.abs(run.energy @ [1.0, 1.0, -1.0]).max() < 1e-8 * max(exchanged, 1.0)
    assert run.balance.max() < 1e-9


def test_a_wheel_runs_up_by_what_rotor_and_gear_leave():
    """α = η g (k I − f) / (J + η g² Jr) at the limit of the current."""
    run = _one(0.8, volts=Constant(48.0))
    _sound(run)
    rate = 0.8 * GEAR * (K * MOST - BRUSH) / (LOAD + 0.8 * GEAR**2 * ROTOR)
    np.testing.assert_allclose(run.joint_velocity[:, 0], rate * run.time, rtol=1e-9, atol=1e-12)


def test_a_gear_that_turns_the_sense_round_gives_the_opposite_motion():
    one, other = (_one(0.7, volts=Constant(6.0), load=-way, gear=way * GEAR, until=0.1) for way in (1.0, -1.0))
    _sound(other)
    np.testing.assert_allclose(one.joint_position, -other.joint_position, atol=1e-11)


def test_a_load_turns_the_rotor_by_what_comes_back():
    """α (J + g² Jr / η′) = M with next to no current."""
    run = _one(0.8, 0.7, brush=0.0, load=5.0, most=1e-12)
    np.testing.assert_allclose(run.joint_velocity[:, 0], 5.0 / (LOAD + GEAR**2 * ROTOR / 0.7) * run.time, rtol=1e-8)
    locked = _one(0.4, brush=0.0, load=5.0, most=1e-12)
    assert np.all(locked.joint_position == 0.0)


@pytest.mark.parametrize(("efficiency", "back"), [(0.75, 0.6), pytest.param(0.45, -0.2, marks=pytest.mark.sweep)])
def test_the_rotor_in_the_motor_is_the_rotor_as_a_body(efficiency, back):
    """Friction, loss and load as the voltage swings: sticking and slipping at the same times."""
    law, asked = Sine(1.0, 14.0, 14.0, 0.0), {"load": -1.0, "until": 0.2, "step": 0.02}
    one, two = _one(efficiency, back, volts=law, **asked), _two(efficiency, back, volts=law, **asked)
    _sound(one)
    _sound(two)
    assert one.friction_sticks.any() and not one.friction_sticks.all()
    axle = two.joint_names.index("axle")
    assert np.ptp(one.joint_position[:, 0]) > 0.1
    np.testing.assert_allclose(one.joint_position[:, 0], two.joint_position[:, axle], atol=1e-8)


def _chain(links, armature):
    """Bars on hinges, the rotor of each a motor without voltage or back EMF to speak of."""
    model = Model()
    model.ground("ground")
    for k in range(links):
        model.body(f"bar {k:02}", 1.0 + 0.1 * k, (k + 0.4, 0, 0.05), (0.02, 0.1, 0.09))
        before = f"bar {k - 1:02}" if k else "ground"
        axis = SPIN if k % 3 == 2 else (0.0, 1.0, 0.0)
        model.joint(f"hinge {k:02}", before, f"bar {k:02}", "revolute", point=(k, 0, 0), axis=axis)
        model.motor(f"motor {k:02}", f"hinge {k:02}", 1.0, 0.0, 1e-9, 10.0, rotor_inertia=armature * (k + 1) / 100.0)
        model.voltage(f"supply {k:02}", f"motor {k:02}", Constant(0.0))
    return model.system()


@pytest.mark.parametrize("links", [3, 14])
def test_rotors_in_a_chain_swing_as_those_of_mujoco(links):
    """By the mass matrix and, where there are many, by articulated bodies."""
    mujoco = package("mujoco")
    run = simulate_system(_chain(links, 0.4), Course(0.2, 0.05, np.array([0.0, 0.0, -9.81])))
    _sound(run)
    bodies = (
        "".join(
            f'<body pos="{1 if k else 0} 0 0"><joint type="hinge" axis="{"0 0 1" if k % 3 == 2 else "0 1 0"}" '
            f'armature="{0.4 * (k + 1)}"/>'
            f'<inertial pos="0.4 0 0.05" mass="{1.0 + 0.1 * k}" diaginertia="0.02 0.1 0.09"/>'
            for k in range(links)
        )
        + "</body>" * links
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="1e-4" integrator="RK4"/><worldbody>{bodies}</worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    for _ in range(2000):
        mujoco.mj_step(model, data)
    np.testing.assert_allclose(run.joint_position[-1], data.qpos, atol=1e-9)


def test_mjcf_takes_inertia_and_friction_of_the_rotor(tmp_path):
    mujoco = package("mujoco")
    done = _run(tmp_path, f"voltage = 6\nrotor_inertia = {ROTOR}\nrotor_friction = {BRUSH}\nefficiency = 0.9")
    made = export(done.design, "mjcf")
    for name, data in made.files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(data)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "axis.xml"))
    np.testing.assert_allclose(model.dof_armature, [ROTOR * GEAR**2], rtol=1e-12)
    np.testing.assert_allclose(model.dof_frictionloss, [BRUSH * abs(GEAR)], rtol=1e-12)
    assert made.lost and export(done.design, "modelica").lost


def test_a_loop_of_speed_keeps_to_its_limit():
    """Position, speed and their limit, by other equations: the same until it settles."""
    gain, speed, integral, volts, goal, fastest = 8.0, 6.0, 30.0, 24.0, 2.0, 1.5
    pid = Controller(gain, integral, speed, volts, fastest)
    run = _one(1.0, brush=0.0, until=3.0, supply=lambda m: m.controller("loops", "motor", "axle", Constant(goal), pid))
    assert run.status == "done", run.reason
    inertia = LOAD + GEAR**2 * ROTOR

    def rates(t, y):
        q, v, s = y
        missing = np.clip(gain * (goal - q), -fastest, fastest) - v
        wanted = speed * missing + integral * s
        volt = np.clip(wanted, -volts, volts)
        current = (volt - K * GEAR * v) / R
        grows = 0.0 if abs(wanted) > volts and missing * wanted > 0.0 else missing
        grows = 0.0 if abs(current) > MOST and grows * K * GEAR * current > 0.0 else grows
        return [v, K * GEAR * np.clip(current, -MOST, MOST) / inertia, grows]

    exact = solve_ivp(rates, (0, 3), np.zeros(3), t_eval=run.time, method="RK45", rtol=1e-8, atol=1e-10, max_step=2e-3)
    np.testing.assert_allclose(run.joint_position[:, 0], exact.y[0], atol=2e-4)
    assert run.joint_position[-1, 0] == pytest.approx(goal, abs=1e-3)
    assert np.abs(run.joint_velocity).max() < 1.2 * fastest


def test_without_reaching_its_limit_it_is_the_controller_without(tmp_path):
    """kp = kv k + ki, kd = kv and, of the integral, ki k, which starts at ki times the way to go."""
    loops = Controller(8.0, 0.0, 6.0, 24.0, 1e6)
    assert loops.without_speed_limit == Controller(48.0, 0.0, 6.0, 24.0)
    one, two = (
        _one(1.0, brush=0.0, until=1.0, supply=lambda m, c=c: m.controller("c", "motor", "axle", Constant(0.3), c))
        for c in (loops, loops.without_speed_limit)
    )
    np.testing.assert_allclose(one.joint_position, two.joint_position, atol=1e-9)


MANIFEST = f"""
schema = 1
[assembly]
name = "axis"
units = "mm"
ground = "frame"
[[part]]
name = "frame"
[[part]]
name = "wheel"
mass = 1
centre_of_mass = [0, 0, 0]
inertia = [[1, 0, 0], [0, 1, 0], [0, 0, {LOAD}]]
[[function.joint]]
name = "axle"
between = ["frame", "wheel"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
[simulation]
duration = 0.5
step = 0.02
[[function.drive]]
joint = "axle"
"""
MOTOR = f'kind = "dc_motor"\nresistance = {R}\nconstant = {K}\ngear = {GEAR}\ncurrent_limit = {MOST}\n'


def _run(folder, keys, kind=MOTOR):
    path = folder / "axis.toml"
    path.write_text(MANIFEST + kind + keys)
    return kinform.run(path)


def test_a_manifest_states_all_of_it(tmp_path):
    keys = f"voltage = 48\nrotor_inertia = {ROTOR}\nrotor_friction = {BRUSH}\nefficiency = 0.8"
    run = _run(tmp_path, keys).simulation
    assert run.status == "done", run.reason
    rate = 0.8 * abs(GEAR) * (K * MOST - BRUSH) / (LOAD + 0.8 * GEAR**2 * ROTOR)
    assert np.abs(run.joint_velocity[-1]).max() == pytest.approx(rate * 0.5, rel=1e-8)
    keys = 'law = {type = "constant", value = 90}\nposition_gain = 8\nspeed_gain = 6\nspeed_integral = 30\n'
    run = _run(tmp_path, keys + "speed_limit = 60").simulation
    assert run.status == "done", run.reason
    assert np.radians(50.0) < np.abs(run.joint_velocity).max() < np.radians(75.0)
    servo = 'kind = "servo"\nlaw = {type = "constant", value = 90}\nposition_gain = 8\nspeed_gain = 6\n'
    done = _run(tmp_path, "speed_limit = 60", servo)
    assert np.abs(done.simulation.joint_velocity).max() == pytest.approx(np.radians(60.0), rel=1e-6)
    assert export(done.design, "modelica").lost


@pytest.mark.parametrize(
    ("keys", "key"),
    [
        ("kp = 3\nposition_gain = 2\nspeed_gain = 1\nspeed_limit = 2", "kp"),
        ("position_gain = 2\nspeed_gain = 1", "speed_limit"),
        ("position_gain = 2\nspeed_limit = 1", "speed_gain"),
        ("kp = 2\nspeed_limit = 1", "speed_limit"),
        ("", "gain"),
    ],
)
def test_keys_of_controllers_that_do_not_go_together_are_named(tmp_path, keys, key):
    servo = 'kind = "servo"\nlaw = {type = "constant", value = 90}\n'
    with pytest.raises(InputError, match=key):
        _run(tmp_path, keys, servo)


def test_a_controller_that_would_drive_its_joint_away_is_refused(tmp_path):
    keys = 'gear = -20\nlaw = {type = "constant", value = 90}\nkp = 3'
    with pytest.raises(InputError):
        _run(tmp_path, keys, f'kind = "dc_motor"\nresistance = {R}\nconstant = {K}\n')
