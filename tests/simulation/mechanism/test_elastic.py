"""Springs, gas springs and bushings between bodies, and loads over time, against scipy and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import kinform
from kinform import results
from kinform.behaviour import Model, Sine, Table
from kinform.errors import InputError
from kinform.exports import export
from kinform.form import load
from kinform.simulation import Course, simulate_system

MASS, FORCE, EXTENDED, COLUMN, EXPONENT = 2.0, 300.0, 0.4, 0.25, 1.3
NONE = np.zeros(3)


def _ram(build):
    """A block of MASS on a slide along x, and what `build` adds."""
    model = Model()
    model.ground("ground")
    model.body("block", MASS, (EXTENDED, 0, 0), (0.01, 0.01, 0.01))
    model.joint("slide", "ground", "block", "prismatic", axis=(1, 0, 0))
    build(model)
    return model.system()


def _exactly(slope, times, start):
    found = solve_ivp(slope, (0.0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-13)
    return found.y


def _drift(run):
    total = run.energy @ np.array([1.0, 1.0, -1.0])
    return float(np.abs(total - total[0]).max())


def test_a_gas_spring_throws_a_block_as_its_law_says():
    ends = np.zeros(3), np.array([EXTENDED, 0.0, 0.0])
    system = _ram(lambda m: m.gas_spring("gas", "ground", "block", ends, FORCE, EXTENDED, COLUMN, EXPONENT, 12.0))
    run = simulate_system(system, Course(0.4, 0.02, NONE), initial={"slide": (-0.1, -3.0)})

    def slope(t, y):
        push = FORCE * (COLUMN / (COLUMN + y[0])) ** EXPONENT
        return [y[1], (push - 12.0 * y[1]) / MASS]

    x, v = _exactly(slope, run.time, [-0.1, -3.0])
    np.testing.assert_allclose(run.joint_position[:, 0], x, atol=1e-8)
    np.testing.assert_allclose(run.joint_velocity[:, 0], v, atol=1e-6)
    assert _drift(run) < 1e-6
    assert run.balance.max() < 1e-9


def test_a_load_follows_its_law():
    """A sine and a table as factors: the velocity is the integral of the force over the mass."""
    law = Table((0.0, 0.2, 0.5, 1.0), (0.0, 3.0, -1.0, 0.5))

    def build(model):
        model.load("wave", "block", (EXTENDED, 0, 0), (4.0, 0, 0), signal=Sine(0.5, 1.0, 7.0, 0.3))
        model.load("steps", "block", (EXTENDED, 0, 0), (2.0, 0, 0), signal=law)

    run = simulate_system(_ram(build), Course(1.0, 0.1, NONE))
    t = run.time
    wave = 4.0 * (0.5 * t - (np.cos(7.0 * t + 0.3) - np.cos(0.3)) / 7.0)
    fine = np.unique(np.concatenate([t, law.knots]))
    level = np.interp(fine, law.knots, law.levels)
    area = np.concatenate([[0.0], np.cumsum(np.diff(fine) * 0.5 * (level[1:] + level[:-1]))])
    expected = (wave + 2.0 * np.interp(t, fine, area)) / MASS
    np.testing.assert_allclose(run.joint_velocity[:, 0], expected, atol=1e-9)
    np.testing.assert_allclose(run.energy[:, 2], 0.5 * MASS * expected**2, atol=1e-8)
    assert run.balance.max() < 1e-9


STIFFNESS, TORSION = np.array([900.0, 400.0, 650.0]), np.array([3.0, 1.2, 2.1])
DAMPING, TORSION_DAMPING = np.array([1.0, 2.0, 3.0]), np.array([0.02, 0.01, 0.03])
INERTIA = np.diag([0.02, 0.03, 0.015])
TRIAD = Rotation.from_rotvec([0.3, -0.5, 0.8]).as_matrix()


def _cushioned(point, damped):
    """A body that six freedoms (three slides and a ball) leave free, held by a bushing at a point alone."""
    model = Model()
    model.ground("ground")
    for name, axis, before in (("x", (1, 0, 0), "ground"), ("y", (0, 1, 0), "x"), ("z", (0, 0, 1), "y")):
        model.body(name, 0.0, (0, 0, 0), (0, 0, 0))
        model.joint(f"along {name}", before, name, "prismatic", axis=axis)
    model.body("block", MASS, (0, 0, 0), INERTIA)
    model.joint("ball", "z", "block", "spherical", point=(0, 0, 0))
    more = (DAMPING, TORSION_DAMPING) if damped else (NONE, NONE)
    model.bushing("rubber", "ground", "block", point, STIFFNESS, TORSION, *more, axes=TRIAD)
    model.load("push", "block", (0.1, 0.2, 0.0), (30.0, -20.0, 10.0), (0.5, 0.3, -0.7))
    return model.system()


@pytest.mark.parametrize("damped", [False, True])
def test_a_body_on_a_bushing_moves_as_newton_and_euler_have_it(damped):
    point = np.array([0.05, -0.04, 0.03])
    run = simulate_system(_cushioned(point, damped), Course(0.6, 0.05, NONE))
    assert run.status == "done"

    def slope(t, y):
        p, q, v, w = y[:3], y[3:7], y[7:10], y[10:]
        R = Rotation.from_quat(q).as_matrix()
        arm = R @ point
        shift, speed = TRIAD.T @ (p + arm - point), TRIAD.T @ (v + np.cross(w, arm))
        theta = Rotation.from_matrix(TRIAD.T @ R @ TRIAD).as_rotvec()
        # The torque is the slope of the energy by a small turn, taken numerically: by no Jacobian.
        turn = np.zeros(3)
        for k in range(3):
            small = np.zeros(3)
            small[k] = 1e-5
            there, back = (
                0.5 * TORSION @ (Rotation.from_rotvec(s * small) * Rotation.from_rotvec(theta)).as_rotvec() ** 2
                for s in (1.0, -1.0)
            )
            turn[k] = (there - back) / 2e-5
        force, moment = STIFFNESS * shift, turn
        if damped:
            force, moment = force + DAMPING * speed, moment + TORSION_DAMPING * (TRIAD.T @ w)
        f, push = -TRIAD @ force, np.array([30.0, -20.0, 10.0])
        torque = np.cross(arm, f) - TRIAD @ moment + np.cross(R @ [0.1, 0.2, 0.0], push) + [0.5, 0.3, -0.7]
        J = R @ INERTIA @ R.T
        dw = np.linalg.solve(J, torque - np.cross(w, J @ w))
        x, y_, z, s = q
        dq = 0.5 * np.array([
            w[0] * s + w[1] * z - w[2] * y_, -w[0] * z + w[1] * s + w[2] * x, w[0] * y_ - w[1] * x + w[2] * s,
            -w[0] * x - w[1] * y_ - w[2] * z,
        ])  # fmt: skip
        return np.concatenate([v, dq, (f + push) / MASS, dw])

    start = np.concatenate([NONE, [0, 0, 0, 1.0], NONE, NONE])
    found = solve_ivp(slope, (0.0, 0.6), start, "DOP853", run.time, rtol=1e-9, atol=1e-11).y.T
    block = run.body_names.index("block")
    np.testing.assert_allclose(run.p_WB[:, block], found[:, :3], atol=2e-7)
    q = run.q_WB[:, block][:, [1, 2, 3, 0]]
    turned = (Rotation.from_quat(q) * Rotation.from_quat(found[:, 3:7]).inv()).magnitude()
    assert turned.max() < 1e-6
    assert _drift(run) < 1e-6
    assert run.balance.max() < 1e-8


MANIFEST = """
schema = 1
[assembly]
name = "lid"
units = "mm"
ground = "box"
[[part]]
name = "box"
[[part]]
name = "lid"
mass = 2.0
centre_of_mass = [200, 0, 0]
inertia = [[0.01, 0, 0], [0, 0.03, 0], [0, 0, 0.03]]
[[function.joint]]
name = "hinge"
between = ["box", "lid"]
type = "revolute"
axis = [0, -1, 0]
point = [0, 0, 0]
[simulation]
duration = 0.5
step = 0.05
"""
GAS = """
[[function.gas_spring]]
name = "lifter"
between = ["box", "lid"]
points = [[0, 0, -200], [150, 0, 0]]
lengths = [300, 200]
forces = [100, 150]
exponent = 1.2
damping = 40
"""


def _written(folder, text):
    path = folder / "lid.toml"
    path.write_text(MANIFEST + text)
    return path


@pytest.mark.parametrize("exponent", [1.2, 0.0])
def test_a_gas_spring_of_a_manifest_opens_a_lid(tmp_path, exponent):
    done = kinform.run(_written(tmp_path, GAS.replace("exponent = 1.2", f"exponent = {exponent}")))
    run = done.simulation
    assert run.status == "done"
    inertia = 0.03 + 2.0 * 0.2**2

    def slope(t, y):
        s, c = np.sin(y[0]), np.cos(y[0])
        line = np.array([0.15 * c, 0.15 * s + 0.2])
        length = np.hypot(*line)
        if exponent:
            column = 0.1 * 1.5 ** (1 / exponent) / (1.5 ** (1 / exponent) - 1.0)
            push = 100.0 * (column / (column - (0.3 - length))) ** exponent
        else:
            push = 100.0 + 500.0 * (0.3 - length)
        arm = 0.15 * (c * line[1] - s * line[0]) / length
        torque = push * arm - 40.0 * (arm * y[1]) * arm - 2.0 * 9.81 * 0.2 * c
        return [y[1], torque / inertia]

    angle = _exactly(slope, run.time, [0.0, 0.0])[0]
    np.testing.assert_allclose(np.abs(run.joint_position[:, 0]), np.abs(angle), atol=1e-8)
    assert abs(angle[-1]) > 0.3
    results.write(done.design, tmp_path / "r.h5")
    again = results.read(tmp_path / "r.h5")
    assert again.assembly.function.springs[0].parameters == done.design.assembly.function.springs[0].parameters
    assert [type(c) for c in again.behaviour.system.springs] == [type(c) for c in done.design.behaviour.system.springs]


def test_springs_bushings_and_loads_of_a_manifest_are_those_of_the_model(tmp_path):
    text = """
[[function.spring]]
between = ["box", "lid"]
points = [[0, 0, 100], [200, 0, 0]]
stiffness = 60
[[function.bushing]]
between = ["box", "lid"]
point = [0, 0, 0]
stiffness = [1000, 1000, 1000]
torsion = [0, 4, 0]
torsion_damping = [0, 0.2, 0]
[[function.load]]
part = "lid"
point = [200, 0, 0]
force = [0, 0, 10]
law = {type = "table", times = [0, 0.25, 0.5], values = [0, 1, -1]}
"""
    done = kinform.run(_written(tmp_path, text))
    run = done.simulation
    inertia, rest = 0.03 + 2.0 * 0.2**2, float(np.hypot(0.2, 0.1))

    def slope(t, y):
        s, c = np.sin(y[0]), np.cos(y[0])
        line = np.array([0.2 * c, 0.2 * s - 0.1])
        length = np.hypot(*line)
        pull = 60.0 * (length - rest)
        arm = 0.2 * (c * line[1] - s * line[0]) / length
        factor = np.interp(t, [0, 0.25, 0.5], [0, 1, -1])
        torque = -pull * arm - 4.0 * y[0] - 0.2 * y[1] + (10.0 * factor - 2.0 * 9.81) * 0.2 * c
        return [y[1], torque / inertia]

    # From knot to knot: the table has a corner there.
    first = solve_ivp(slope, (0, 0.25), [0, 0], "DOP853", run.time[:6], rtol=1e-12, atol=1e-13).y
    second = solve_ivp(slope, (0.25, 0.5), first[:, -1], "DOP853", run.time[5:], rtol=1e-12, atol=1e-13).y
    angle = np.concatenate([first[0], second[0, 1:]])
    np.testing.assert_allclose(np.abs(run.joint_position[:, 0]), np.abs(angle), atol=1e-8)
    assert run.balance.max() < 1e-8
    results.write(done.design, tmp_path / "r.h5")
    again = results.read(tmp_path / "r.h5")
    assert again.assembly.function.loads[0].law.values == (0.0, 1.0, -1.0)
    assert again.behaviour.system.loads[0].signal == done.design.behaviour.system.loads[0].signal
    exported = export(done.design, "modelica")
    assert len(exported.lost) >= 2


@pytest.mark.parametrize(
    ("text", "place"),
    [
        (GAS.replace("[300, 200]", "[200, 300]"), "length"),
        (GAS.replace("[100, 150]", "[150, 100]"), "force"),
        (
            '[[function.spring]]\nbetween = ["box", "lid"]\npoints = [[0, 0, 1], [1, 0, 0]]',
            "stiffness",
        ),
        (
            '[[function.load]]\npart = "lid"\nforce = [0, 0, 1]\n'
            'law = {type = "table", times = [0, 1], values = [1, 2, 3]}',
            "times",
        ),
        (
            '[[function.load]]\npart = "lid"\nforce = [0, 0, 1]\nlaw = {type = "table"}',
            "times",
        ),
    ],
)
def test_what_is_stated_wrongly_is_refused_with_its_key(tmp_path, text, place):
    with pytest.raises(InputError, match=place):
        load(_written(tmp_path, text))
