"""Drives on one of several freedoms of a joint, against equations integrated elsewhere and closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.dynamics import moved
from support.places import shared
from support.solids import rod, save

import kinform
from kinform import stages
from kinform.behaviour import Constant, Controller, Model, Ramp, Sine
from kinform.consistency import check
from kinform.form import load
from kinform.function import acted_freedom
from kinform.kinematics import functional
from kinform.simulation import Course, simulate_system

CRANK, ROD, START = 0.03, 0.1, 0.7
INERTIA, MASS = 2e-4, 0.3


def _written(folder, text):
    path = folder / "device.toml"
    path.write_text(text)
    return path


def _slide(theta):
    """x, dx/dθ, d²x/dθ² of the piston of a slider-crank."""
    s, c = CRANK * np.sin(theta), CRANK * np.cos(theta)
    root = np.sqrt(ROD**2 - s**2)
    first = -s - s * c / root
    second = -c - (c * c - s * s) / root - (s * c) ** 2 / root**3
    return c + root, first, second


def _engine(drive, duration=0.5, bore="cylindrical"):
    """A manifest of a slider-crank of sticks whose piston may turn in its bore as far as the bore knows."""
    x = float(_slide(START)[0])
    pin = [float(CRANK * np.cos(START)), float(CRANK * np.sin(START)), 0.0]
    zero = "[[0, 0, 0], [0, 0, 0], [0, 0, 0]]"
    return f"""
schema = 1
[assembly]
name = "engine"
units = "m"
ground = "frame"
[[part]]
name = "frame"
[[part]]
name = "crank"
mass = 1.0
centre_of_mass = [0, 0, 0]
inertia = [[{INERTIA}, 0, 0], [0, {INERTIA}, 0], [0, 0, {INERTIA}]]
[[part]]
name = "rod"
mass = {0.25 * MASS}
centre_of_mass = [{x!r}, 0, 0]
inertia = {zero}
[[part]]
name = "piston"
mass = {0.75 * MASS}
centre_of_mass = [{x!r}, 0, 0]
inertia = {zero}
[function]
[[function.joint]]
name = "O"
between = ["frame", "crank"]
type = "revolute"
axis = [0, 0, 1]
point = [0, 0, 0]
[[function.joint]]
name = "A"
between = ["crank", "rod"]
type = "revolute"
axis = [0, 0, 1]
point = {pin}
[[function.joint]]
name = "S"
between = ["rod", "piston"]
type = "revolute"
axis = [0, 0, 1]
point = [{x!r}, 0, 0]
[[function.joint]]
name = "bore"
between = ["piston", "frame"]
type = "{bore}"
axis = [1, 0, 0]
point = [0, 0, 0]
[[function.drive]]
joint = "bore"
{drive}
[simulation]
duration = {duration}
step = 0.01
gravity = [0, 0, 0]
"""


def _turned(force, duration=0.5, rate=0.0):
    """Crank angle over time under a force(x − x₀, dx/dt, t) on the piston."""
    x0 = _slide(START)[0]

    def slope(t, state):
        theta, omega = state
        x, first, second = _slide(theta)
        pushed = force(x - x0, first * omega, t) * first
        return [omega, (pushed - MASS * first * second * omega**2) / (INERTIA + MASS * first**2)]

    times = np.arange(0.0, duration + 0.005, 0.01)
    return solve_ivp(slope, (0.0, duration), [START, rate], "DOP853", times, rtol=1e-11, atol=1e-12).y[0]


# The designer lists the piston first: his values are those of the frame relative to it, −x.
DRIVES = {
    "effort": (
        'kind = "effort"\nlaw = {type = "sine", amplitude = 20.0, frequency = 4.0}',
        lambda x, v, t: -20.0 * np.sin(8.0 * np.pi * t),
    ),
    "spring": ('kind = "spring"\nstiffness = 800.0\nrest = 0.01', lambda x, v, t: 800.0 * (-0.01 - x)),
    "servo": (
        'kind = "servo"\nkp = 900.0\nkd = 5.0\nlaw = {type = "constant", value = 0.005}',
        lambda x, v, t: 900.0 * (-0.005 - x) - 5.0 * v,
    ),
}


@pytest.mark.parametrize("kind", DRIVES)
def test_drives_act_on_the_slide_of_a_round_ram_whose_spin_the_rest_holds(kind, tmp_path):
    drive, force = DRIVES[kind]
    run = kinform.run(_written(tmp_path, _engine(drive))).simulation
    assert run.status == "done", run.reason
    crank = run.joint_names.index("crank~frame")
    angle = -run.joint_position[:, run.joint_offset[crank]]
    np.testing.assert_allclose(START + angle, _turned(force), atol=3e-8)
    (use,) = run.drives
    assert (use.freedom, use.slides) == (1, True)


def test_a_motion_on_the_slide_of_a_round_ram_leads_the_crank(tmp_path):
    text = _engine('kind = "motion"\nlaw = {type = "sine", amplitude = 0.008, frequency = 2.0}')
    run = kinform.run(_written(tmp_path, text)).simulation
    crank = run.joint_names.index("crank~frame")
    angle = START - run.joint_position[:, run.joint_offset[crank]]
    x = _slide(START)[0] - 0.008 * np.sin(4.0 * np.pi * run.time)
    np.testing.assert_allclose(_slide(angle)[0], x, atol=1e-12)


def test_an_initial_value_is_that_of_the_slide(tmp_path):
    text = _engine('kind = "damper"\ndamping = 1.0') + "\n[simulation.initial.bore]\nvelocity = 0.1\n"
    run = kinform.run(_written(tmp_path, text)).simulation
    angle = START - run.joint_position[:, run.joint_offset[run.joint_names.index("crank~frame")]]
    rate = -0.1 / _slide(START)[1]
    np.testing.assert_allclose(angle, _turned(lambda x, v, t: -v, rate=rate), atol=3e-8)


def test_the_type_of_the_intended_joint_or_a_name_chooses_among_freedoms(tmp_path):
    assembly = load(_written(tmp_path, _engine('kind = "effort"\nlaw = {type = "constant", value = 1.0}')))
    kinematics = functional(assembly)
    assert acted_freedom(assembly, kinematics, "bore").freedom == 1
    named = acted_freedom(assembly, kinematics, "bore", "turn")
    assert (named.freedom, named.sign, named.because) == (0, -1, "")
    wrong = acted_freedom(assembly, kinematics, "bore", "u")
    assert wrong.freedom is None and wrong.reason


STATED = """
[[function.joint]]
name = "bore~ram"
between = ["bore", "ram"]
type = "cylindrical"
axis = [0, 0, 1]
point = [0, 0, 0]
"""


def _loose(folder, stated, drive):
    """A ram in a bore that nothing else holds, as meshes."""
    save(rod(20.0, 0.0, 60.0) - rod(10.0, -1.0, 61.0), folder / "bore.stl")
    save(rod(10.0, -20.0, 80.0), folder / "ram.stl")
    parts = "".join(f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\ndensity = 7850.0\n' for name in ("bore", "ram"))
    law = 'law = {type = "constant", value = 2.0}'
    return kinform.run(
        _written(
            folder,
            f'schema = 1\n[assembly]\nname = "ram"\nunits = "mm"\nground = "bore"\n{parts}{stated}\n'
            f'[[function.drive]]\njoint = "bore~ram"\nkind = "effort"\n{drive}\n{law}\n'
            "[simulation]\nduration = 0.1\ngravity = [0, 0, 0]\n",
        )
    )


def test_an_idle_spin_leaves_the_slide_and_one_that_is_meant_leaves_a_finding(tmp_path):
    done = _loose(tmp_path, "", "")
    run, mass = done.simulation, done.design.mass.bodies[-1].mass
    np.testing.assert_allclose(run.joint_position[-1, 1], 0.5 * 2.0 / mass * 0.1**2, rtol=1e-9)
    assert [f.code for f in _loose(tmp_path, STATED, "").findings].count("KF409") == 1
    done = _loose(tmp_path, STATED, 'freedom = "turn"')
    assert not [f for f in done.findings if f.code == "KF409"]
    assert done.simulation.joint_position[-1, 0] > 1.0 > 1e12 * abs(done.simulation.joint_position[-1, 1])


@pytest.mark.parametrize("case", ["engine_piston", "damper_on_ram"])
def test_the_cases_of_round_rams_run(case):
    """What their parts meet on the way, which takes longest, is not asked."""
    design = stages.joints(stages.contacts(stages.import_(shared("cases/motion") / case / "design.toml")))
    asked = replace(design.assembly.simulation, duration=0.1, step=0.05)
    design = moved(stages.mass(replace(design, assembly=replace(design.assembly, simulation=asked))))
    assert (design.simulation.status, design.simulation.level) == ("done", "dynamic")
    assert "KF409" not in {finding.code for finding in check(design).findings}


def _free_body(kind, **geometry):
    model = Model()
    model.ground("base")
    model.body("ball", 2.0, (0, 0, 0), (0.5, 0.5, 0.5))
    model.joint("at", "base", "ball", kind, point=(0, 0, 0), **geometry)
    return model


def _run(model):
    return simulate_system(model.system(), Course(1.0, 0.05, np.zeros(3)))


def test_freedoms_of_a_planar_joint_swing_alone():
    model = _free_body("planar", axis=(0, 0, 1))
    model.spring("u", "at", 50.0, 0.1, freedom=1)
    model.effort("v", "at", Constant(3.0), freedom=2)
    model.damper("turn", "at", 0.2, freedom=0)
    run = _run(model)
    np.testing.assert_allclose(run.joint_position[:, 1], 0.1 * (1.0 - np.cos(5.0 * run.time)), atol=1e-9)
    np.testing.assert_allclose(run.joint_position[:, 2], 0.75 * run.time**2, atol=1e-12)
    assert not run.joint_position[:, 0].any()
    assert [(use.freedom, use.slides) for use in run.drives] == [(1, True), (2, True), (0, False)]


def test_either_turn_of_a_universal_joint_is_led_or_held():
    model = _free_body("universal", axis=(1, 0, 0), axis2=(0, 1, 0))
    model.motion("first", "at", Ramp(0.0, 2.0), freedom=0)
    model.servo("second", "at", Constant(0.3), Controller(8.0), freedom=1)
    run = _run(model)
    np.testing.assert_allclose(run.joint_position[:, 0], 2.0 * run.time, atol=1e-12)
    # About two orthogonal axes of a sphere the second turn does not feel the first.
    np.testing.assert_allclose(run.joint_position[:, 1], 0.3 * (1.0 - np.cos(4.0 * run.time)), atol=1e-9)


def test_a_ball_takes_efforts_and_dampers_about_axes_and_nothing_that_needs_a_value():
    model = _free_body("spherical")
    model.effort("push", "at", Constant(1.0), freedom=2)
    model.damper("oil", "at", 0.5, freedom=2)
    run = _run(model)
    np.testing.assert_allclose(run.joint_velocity[:, 3], 2.0 * (1.0 - np.exp(-run.time)), atol=1e-10)
    model.motion("led", "at", Sine(0.0, 1.0, 1.0, 0.0), freedom=0)
    refused = _run(model)
    assert refused.status == "refused" and [subject for subject, _ in refused.failures] == ["at"]


def test_a_freedom_that_a_joint_does_not_have_is_refused():
    with pytest.raises(ValueError, match="freedom 2"):
        _free_body("cylindrical", axis=(0, 0, 1)).damper("oil", "at", 1.0, freedom=2)
