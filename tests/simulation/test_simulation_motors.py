"""Motors with a limit of current, a rotor, friction of their own and position control: closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import kinform
from kinform import results
from kinform.behaviour import Constant, Controller, DcMotor, Model
from kinform.errors import InputError
from kinform.exports import export
from kinform.simulation import Course, simulate_system

R, K, GEAR, MOST = 1.5, 0.05, 20.0, 3.0
LOAD, ROTOR = 0.08, 3e-4
REFLECTED = LOAD + ROTOR * GEAR**2
NONE = np.zeros(3)
SPIN = (0.0, 0.0, 1.0)


def _flywheel(supply, inductance=0.0, friction=0.0):
    """A flywheel that a rotor turns by a gear: the motor acts on the rotor."""
    model = Model()
    model.ground("ground")
    model.body("wheel", 1.0, (0, 0, 0), (1.0, 1.0, LOAD))
    model.body("rotor", 1.0, (0.5, 0, 0), (1.0, 1.0, ROTOR))
    model.joint("axle", "ground", "wheel", "revolute", point=(0, 0, 0), axis=SPIN)
    model.joint("shaft", "ground", "rotor", "revolute", point=(0.5, 0, 0), axis=SPIN)
    model.gear("gearbox", "shaft", "axle", GEAR)
    model.motor("motor", "shaft", R, inductance, K, 1.0, MOST)
    if friction:
        model.friction("brush", "shaft", effort=friction)
    supply(model)
    return model.system()


def _stepped(step, friction=0.0):
    """From rest by a voltage that would give a hundred times the current."""
    system = _flywheel(lambda m: m.voltage("supply", "motor", Constant(48.0)), friction=friction)
    return simulate_system(system, Course(0.5, step, NONE))


@pytest.mark.parametrize("friction", [0.0, 0.01])
def test_a_flywheel_runs_up_linearly_at_the_limit_of_the_current(friction):
    run = _stepped(0.02, friction)
    wheel = run.joint_names.index("axle")
    constant = GEAR * (K * MOST - friction) / REFLECTED
    assert (48.0 - K * GEAR * constant * 0.5) / R > MOST  # the back EMF has not ended the limit
    np.testing.assert_allclose(run.joint_velocity[:, wheel], constant * run.time, atol=1e-9)
    use = next(use for use in run.drives if use.kind == "dc_motor")
    assert use.rms == pytest.approx(K * MOST, rel=1e-9)
    assert use.work == pytest.approx(0.5 * GEAR * K * MOST * constant * 0.5**2, rel=1e-9)


@pytest.mark.parametrize("inductance", [0.0, 0.004])
def test_a_controlled_motor_turns_within_its_current_and_settles(inductance):
    """PID with a limit of voltage and one of current, and anti-windup for both: the same equations elsewhere."""
    kp, ki, kd, volts, goal = 30.0, 20.0, 3.0, 24.0, 25.0
    pid = Controller(kp, ki, kd, volts)
    system = _flywheel(lambda m: m.controller("pid", "motor", "shaft", Constant(goal), pid), inductance)
    run = simulate_system(system, Course(4.0, 0.02, NONE))
    inertia = REFLECTED / GEAR**2

    def rates(t, y):
        q, v, i, s = y
        wanted = kp * (goal - q) + ki * s - kd * v
        volt = np.clip(wanted, -volts, volts)
        grows = 0.0 if abs(wanted) > volts and (goal - q) * wanted > 0.0 else goal - q
        if inductance:
            faster = (volt - R * i - K * v) / inductance
            limited = abs(i) >= MOST and faster * i > 0.0
        else:
            i, faster = (volt - K * v) / R, 0.0
            limited = abs(i) > MOST
        given = np.clip(i, -MOST, MOST)
        grows = 0.0 if limited and grows * given > 0.0 else grows
        return [v, K * given / inertia, 0.0 if limited else faster, grows]

    exact = solve_ivp(rates, (0, 4), np.zeros(4), t_eval=run.time, method="RK45", rtol=1e-8, atol=1e-10, max_step=4e-3)
    shaft = run.joint_names.index("shaft")
    np.testing.assert_allclose(run.joint_position[:, shaft], exact.y[0], atol=2e-4)
    (use,) = run.drives
    assert use.peak == pytest.approx(K * MOST, rel=1e-9)
    assert run.joint_position[-1, shaft] == pytest.approx(goal, abs=0.05)


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
[[part]]
name = "rotor"
mass = 1
centre_of_mass = [500, 0, 0]
inertia = [[1, 0, 0], [0, 1, 0], [0, 0, {ROTOR}]]
[[function.joint]]
name = "axle"
between = ["frame", "wheel"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
[[function.joint]]
name = "shaft"
between = ["frame", "rotor"]
type = "revolute"
axis = [0, 0, 1]
point = [500, 0, 0]
[[function.coupling]]
joints = ["shaft", "axle"]
ratio = {GEAR}
[simulation]
duration = 0.5
step = 0.02
[[function.drive]]
joint = "shaft"
kind = "dc_motor"
resistance = {R}
constant = {K}
current_limit = {MOST}
"""


def _run(folder, keys):
    path = folder / "axis.toml"
    path.write_text(MANIFEST + keys)
    return kinform.run(path)


def test_a_manifest_limits_the_current_and_gives_the_rotor_as_a_part(tmp_path):
    done = _run(tmp_path, "voltage = 48")
    speed = GEAR * K * MOST / REFLECTED * 0.5
    run = done.simulation
    assert run.status == "done"
    assert np.abs(run.joint_velocity[-1]).max() == pytest.approx(GEAR * speed, rel=1e-8)
    assert export(done.design, "mjcf").lost
    assert export(done.design, "modelica").lost


def test_a_manifest_controls_the_position_of_a_motor(tmp_path):
    """Target in degrees, as the joint's values; beside the model by hand."""
    keys = 'law = {type = "constant", value = 90}\nkp = 30\nki = 20\nkd = 3\nlimit = 24'
    run = _run(tmp_path, keys).simulation
    pid = Controller(30.0, 20.0, 3.0, 24.0)
    system = _flywheel(lambda m: m.controller("pid", "motor", "shaft", Constant(np.pi / 2), pid))
    other = simulate_system(system, Course(0.5, 0.02, NONE))
    mine, its = (np.abs(one.joint_position).max(axis=1) for one in (run, other))
    np.testing.assert_allclose(mine, its, atol=1e-9)
    assert mine.max() > 1.0


@pytest.mark.parametrize(
    ("keys", "key"),
    [
        ("kp = 3\nvoltage = 2", "voltage"),
        ("voltage = 2\nki = 3", "ki"),
        ("kp = 3", "law"),
        ("", "voltage"),
    ],
)
def test_keys_of_a_motor_that_do_not_go_together_are_refused_with_one_of_them(tmp_path, keys, key):
    with pytest.raises(InputError, match=key):
        _run(tmp_path, keys)


def test_a_cascade_is_a_pid():
    """The position's error sets a speed, a PI of the speed's error the effort: kp = kv k + ki', kd = kv, ki = ki' k."""
    outer, inner, sums, goal = 6.0, 0.4, 0.9, 0.3
    pid = Controller(inner * outer + sums, sums * outer, inner)
    model = Model()
    model.ground("ground")
    model.body("wheel", 1.0, (0, 0, 0), (1.0, 1.0, LOAD))
    model.joint("axle", "ground", "wheel", "revolute", point=(0, 0, 0), axis=SPIN)
    model.servo("drive", "axle", Constant(goal), pid)
    run = simulate_system(model.system(), Course(2.0, 0.05, NONE))

    def rates(t, y):
        q, v, s = y
        slip = outer * (goal - q) - v
        return [v, (inner * slip + sums * s) / LOAD, slip]

    # The integral of the speed's error begins at the position's: ∫(k e − v) = k ∫e + e − e(0).
    exact = solve_ivp(rates, (0, 2), [0.0, 0.0, goal], t_eval=run.time, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(run.joint_position[:, 0], exact.y[0], atol=1e-8)


@pytest.mark.parametrize("limit", ["", "current_limit = 3"])
def test_results_keep_a_limit_and_that_there_is_none(tmp_path, limit):
    path = tmp_path / "axis.toml"
    path.write_text(MANIFEST.replace(f"current_limit = {MOST}", limit) + "voltage = 48")
    done = kinform.run(path)
    results.write(done.design, tmp_path / "r.h5")
    again = results.read(tmp_path / "r.h5")
    (motor,) = (c for c in again.behaviour.system.components if isinstance(c, DcMotor))
    assert motor.current_limit == (3.0 if limit else np.inf)
    assert again.simulation.drives == done.simulation.drives
