"""Gears with an efficiency: closed forms both ways, self-locking, sticking and slipping, and what is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from support.diagonal import diagonal
from support.dynamics import moved
from support.places import FIXTURES

import kinform
from kinform.behaviour import Constant, Model, Sine, build
from kinform.errors import InputError
from kinform.exports import export
from kinform.model.function import Coupling, Drive, Function, Law, SimulationRequest
from kinform.simulation import Course, simulate_system

A, B, RATIO = 0.3, 0.5, -3.0
"""kg·m² of the wheels at a and b; value at a over value at b."""
NONE, SPIN = np.zeros(3), (0.0, 0.0, 1.0)
TEETH = {
    "pitch_point": (0.125, 0.0, 0.0),
    "flanks": ((np.sin(0.35), np.cos(0.35), 0.0), (np.sin(0.35), -np.cos(0.35), 0.0)),
}


def _pair(efficiency, back, at_a, at_b, *, swapped=False, until=0.5, step=0.05, **teeth):
    """Two wheels on a lossy gear under efforts; swapped: stated from b to a."""
    model = Model()
    model.ground("ground")
    model.body("A", 1.0, (0, 0, 0), (1, 1, A))
    model.body("B", 1.0, (0.5, 0, 0), (1, 1, B))
    model.joint("a", "ground", "A", "revolute", point=(0, 0, 0), axis=SPIN)
    model.joint("b", "ground", "B", "revolute", point=(0.5, 0, 0), axis=SPIN)
    if swapped:
        model.gear("gear", "b", "a", 1.0 / RATIO, efficiency=back, efficiency_back=efficiency)
    else:
        model.gear("gear", "a", "b", RATIO, efficiency=efficiency, efficiency_back=back, **teeth)
    for joint, effort in (("a", at_a), ("b", at_b)):
        if effort is not None:
            model.effort(f"effort {joint}", joint, effort)
    return simulate_system(model.system(), Course(until, step, NONE))


def _sound(run):
    assert run.status == "done", run.reason
    assert np.ptp(run.energy @ [1.0, 1.0, -1.0]) < 1e-9
    assert run.balance.max() < 1e-9


@diagonal(torque=[1.0, -2.0], teeth=[{}, TEETH])
def test_the_driven_side_gets_its_share(torque, teeth):
    """α (I_a + I_b / (η r²)) = T driven at a; α_b (I_b + r² I_a / η′) = T driven at b."""
    forth = _pair(0.9, 0.7, Constant(torque), None, until=0.2, **teeth)
    back = _pair(0.9, 0.7, None, Constant(torque), until=0.2, **teeth)
    _sound(forth)
    _sound(back)
    np.testing.assert_allclose(forth.joint_velocity[:, 0], torque / (A + B / (0.9 * RATIO**2)) * forth.time, rtol=1e-9)
    np.testing.assert_allclose(back.joint_velocity[:, 1], torque / (B + A * RATIO**2 / 0.7) * back.time, rtol=1e-9)


def test_the_same_gear_stated_from_the_other_side_moves_the_same():
    for efficiency, back, at_a, at_b in ((0.9, 0.7, 1.0, 0.4), (0.45, -0.5, -0.2, 2.0)):
        efforts = Constant(at_a), Constant(at_b)
        one, other = (_pair(efficiency, back, *efforts, swapped=swapped, until=0.2) for swapped in (False, True))
        _sound(other)
        np.testing.assert_allclose(one.joint_position, other.joint_position, atol=1e-10)


def test_without_another_number_the_teeth_rub_alike_both_ways():
    one = _pair(0.8, None, None, Constant(1.0), until=0.2)
    other = _pair(0.8, 2.0 - 1.0 / 0.8, None, Constant(1.0), until=0.2)
    np.testing.assert_array_equal(one.joint_position, other.joint_position)


def test_a_self_locking_gear_holds_any_load_and_can_be_driven_both_ways():
    """Under 50 % with teeth that rub alike; lowering the load takes effort too."""
    locked = _pair(0.3, None, None, Constant(5.0))
    _sound(locked)
    assert np.all(locked.joint_position == 0.0)
    assert np.all(locked.friction_sticks)
    load, rubbing = 0.9, 1.0 / 0.3 - 1.0
    carried = -load / RATIO  # at a, without friction
    for limit, way in ((carried * (1.0 + rubbing), 1.0), (carried * (1.0 - rubbing), -1.0)):
        assert np.all(_pair(0.3, None, Constant(0.999999 * limit), Constant(load), until=0.1).joint_position == 0.0)
        run = _pair(0.3, None, Constant(1.000001 * limit), Constant(load), until=0.1)
        _sound(run)
        assert way * run.joint_position[-1, 0] > 0.0


def test_a_prescribed_motion_needs_what_the_gear_loses():
    """Inverse dynamics, as the load drives and is driven."""
    law, load = Sine(0.0, 1.0, 3.0, 0.0), 6.0
    model = Model()
    model.ground("ground")
    for name, joint, inertia in (("A", "a", A), ("B", "b", B)):
        model.body(name, 1.0, (0, 0, 0), (1, 1, inertia))
        model.joint(joint, "ground", name, "revolute", point=(0, 0, 0), axis=SPIN)
    model.gear("gear", "a", "b", RATIO, efficiency=0.8, efficiency_back=0.6)
    model.motion("drive", "a", law)
    model.effort("load", "b", Constant(load))
    run = simulate_system(model.system(), Course(1.2, 0.1, NONE))
    _sound(run)
    v, a = (np.array([of(t) for t in run.time]) for of in (law.rate, law.acceleration))
    passed = (load - B * a / RATIO) / RATIO
    loss = -np.sign(v) * np.abs(passed) * np.where(passed * v > 0.0, 1.0 - 0.6, 1.0 / 0.8 - 1.0)
    kinds = [use.kind for use in run.drives]
    assert kinds == ["motion", "effort", "gear_loss"]
    np.testing.assert_allclose(run.drive_effort[:, 0], A * a - passed - loss, atol=1e-12)
    np.testing.assert_allclose(run.drive_effort[:, 2], loss, atol=1e-12)


def _exact(efficiency, back, drive, load, times):
    """Value at a: the same gear by hand, each stretch of slipping or sticking on its own."""
    driving, driven = 1.0 / efficiency - 1.0, 1.0 - back

    def friction(y, way):
        return abs(y) * (driven if y * way > 0.0 else driving)

    def acceleration(t, way):
        for share in (driven, -driving):  # friction against the motion is share · y · way
            # A α = T + y − share · y,  B α / r = load − r y
            α = (drive(t) + (1.0 - share) * load / RATIO) / (A + (1.0 - share) * B / RATIO**2)
            y = load / RATIO - B * α / RATIO**2
            if share * y * way >= 0.0:
                return α
        raise AssertionError

    def left(t, way):
        return friction(load / RATIO, way) - way * (drive(t) + load / RATIO)

    t, q, v, out = times[0], 0.0, 0.0, np.zeros(len(times))
    while t < times[-1]:
        if v == 0.0:
            grid = np.linspace(t, times[-1], 4001)
            for way in (1, -1):
                if left(t + 1e-9, way) < 0.0:
                    break
            else:
                begins = []
                for way in (1, -1):
                    below = [k for k in range(1, len(grid)) if left(grid[k], way) < 0.0]
                    if below:
                        begins.append((brentq(left, grid[below[0] - 1], grid[below[0]], args=(way,), xtol=1e-14), way))
                start, way = min(begins, default=(times[-1], 1))
                out[(times >= t) & (times <= start)] = q
                t = start
                if t >= times[-1]:
                    break
        else:
            way = int(np.sign(v))

        def stops(s, y, way=way, first=t):
            return way * y[1] if s > first + 1e-6 else 1.0

        stops.terminal, stops.direction = True, -1
        here = times[times >= t]
        run = solve_ivp(
            lambda s, y, way=way: [y[1], acceleration(s, way)], (t, times[-1]), [q, v], events=stops,
            rtol=1e-11, atol=1e-13, dense_output=True,
        )  # fmt: skip
        end = run.t[-1]
        out[(times >= t) & (times <= end)] = run.sol(here[here <= end])[0]
        t, q, v = end, run.y[0, -1], 0.0
    return out


@pytest.mark.parametrize(("efficiency", "back"), [(0.7, 0.5), pytest.param(0.45, -0.2, marks=pytest.mark.sweep)])
def test_it_sticks_and_slips_as_by_hand(efficiency, back):
    """A drive that swings, against a load: lifted, lowered, held."""
    load = 2.0
    run = _pair(efficiency, back, Sine(0.4, 1.6, 5.0, 0.3), Constant(load), until=1.2, step=0.02)
    _sound(run)
    exact = _exact(efficiency, back, lambda t: 0.4 + 1.6 * np.sin(5.0 * t + 0.3), load, run.time)
    assert run.friction_sticks.any() and not run.friction_sticks.all()
    assert np.ptp(exact) > 0.1
    np.testing.assert_allclose(run.joint_position[:, 0], exact, atol=1e-7)


def test_redundant_gears_do_not_tell_what_each_loses():
    model = Model()
    model.ground("ground")
    for name in ("A", "B"):
        model.body(name, 1.0, (0, 0, 0), (1, 1, A))
        model.joint(name.lower(), "ground", name, "revolute", point=(0, 0, 0), axis=SPIN)
    model.gear("first", "a", "b", 2.0, efficiency=0.9)
    model.gear("second", "a", "b", 2.0)
    model.effort("drive", "a", Constant(1.0))
    run = simulate_system(model.system(), Course(0.1, 0.05, NONE))
    assert run.status == "refused"
    assert [subject for subject, _ in run.failures] == ["a"]


def test_what_cannot_be_an_efficiency_is_refused():
    for efficiency, back in ((1.2, 1.0), (-0.1, -0.2), (0.9, 1.1)):
        run = _pair(efficiency, back, Constant(1.0), None)
        assert run.status == "refused" and [subject for subject, _ in run.failures] == ["gear"]


def _driven(joint, value):
    return Drive(joint, "effort", Law("constant", value=value), {}, 1.0, "device.toml", 1)


@pytest.mark.parametrize("names", [("pinion_bearing", "wheel_bearing"), ("wheel_bearing", "pinion_bearing")])
def test_teeth_of_meshes_lose_what_is_stated_of_their_joints(derive_design, names):
    """α (I₁ + n² I₂ / η) = T; in whichever order the coupling names them."""
    found = derive_design(FIXTURES / "mechanisms/gear_pair/gear_pair.toml")
    n = 18 / 24
    pinion_first = names[0] == "pinion_bearing"
    shares = (0.8, 0.6) if pinion_first else (0.6, 0.8)
    stated = Coupling(names, -1.0 / n if pinion_first else -n, "device.toml", 9, {}, *shares)
    asked = SimulationRequest(gravity=NONE, duration=0.2, step=0.1)
    function = Function(joints=found.assembly.function.joints, drives=(_driven("pinion_bearing", 0.01),))
    function = replace(function, couplings=(stated,))
    design = replace(found, assembly=replace(found.assembly, simulation=asked, function=function))
    done = moved(design, "dynamic")
    run = done.simulation
    assert run.status == "done", run.reason
    bodies = {body.name: body for body in design.mass.bodies}
    first, second = (bodies[name].inertia[2, 2] for name in ("pinion", "wheel"))
    rate = 0.01 / (first + n * n * second / 0.8)
    k = run.joint_names.index("frame~pinion")
    np.testing.assert_allclose(run.joint_position[:, k], 0.5 * rate * run.time**2, rtol=1e-9, atol=1e-13)
    assert export(done, "mjcf").lost


def test_an_efficiency_that_belongs_to_no_pair_of_teeth_stops_the_dynamics(derive_design):
    found = derive_design(FIXTURES / "mechanisms/gear_pair/gear_pair.toml")
    stated = Coupling(("wheel_bearing", "wheel_bearing"), 1.0, "device.toml", 9, {}, 0.8, 0.75)
    function = replace(found.assembly.function, couplings=(stated,))
    made = build(replace(found.assembly, function=function), found.kinematics, found.mass, contacts=found.contacts)
    ((subject, _),) = made.forces_missing
    assert "wheel_bearing" in subject


def test_keys_that_say_nothing_together_are_named(tmp_path):
    path = tmp_path / "train.toml"
    path.write_text(
        """
schema = 1
[assembly]
name = "train"
units = "mm"
[[part]]
name = "frame"
[[function.coupling]]
joints = ["a", "b", "c"]
ratio = [1, 2]
efficiency = 0.9
"""
    )
    with pytest.raises(InputError) as error:
        kinform.run(path)
    assert [problem.line for problem in error.value.problems][-1:] == [
        path.read_text().splitlines().index("efficiency = 0.9") + 1
    ]
