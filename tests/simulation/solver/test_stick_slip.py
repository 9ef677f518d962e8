"""Coulomb friction: against closed forms, piece by piece where it sticks and slips, and the refusals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

from kinform.behaviour import Constant, Model, Ramp, Rubs, Sine
from kinform.simulation import Course, simulate_system

G = 9.81
TURNED = Rotation.from_rotvec([0.4, -0.7, 1.1]).as_matrix()
MIRROR = np.diag([1.0, -1.0, 1.0])


def _block(course, *, kinetic, static=None, start=(0.0, 0.0), axis=(1.0, 0.0, 0.0), spring=0.0, push=None):
    """A block of 2 kg that slides on an axis."""
    model = Model()
    model.ground("base")
    model.body("block", 2.0, (0, 0, 0), inertia=1e-3 * np.eye(3))
    model.joint("slide", "base", "block", "prismatic", axis=axis)
    model.friction("friction", "slide", kinetic, static=static)
    if spring:
        model.spring("spring", "slide", spring)
    if push is not None:
        model.effort("push", "slide", push)
    return simulate_system(model.system(), course, initial={"slide": start})


def _down(angle):
    return np.array([np.cos(angle), 0.0, -np.sin(angle)])


def test_a_block_at_less_than_the_angle_of_friction_stays_where_it_is_to_the_last_bit():
    angle = 0.3
    run = _block(Course(1e6, 2e5), kinetic=0.2, static=np.tan(angle) * (1.0 + 1e-9), axis=_down(angle))
    assert run.status == "done"
    assert np.all(run.joint_position == 0.0) and np.all(run.friction_sticks)
    np.testing.assert_allclose(run.friction_effort, -2.0 * G * np.sin(angle), rtol=1e-12)


@pytest.mark.parametrize("turn", [np.eye(3), TURNED @ MIRROR])
def test_a_block_beyond_the_angle_of_friction_slides_as_newton_says_however_it_is_turned(turn):
    angle, mu = 0.3, 0.2
    course = Course(0.5, 0.1, turn @ (0.0, 0.0, -G))
    run = _block(course, kinetic=mu, static=np.tan(angle) * (1.0 - 1e-9), axis=turn @ _down(angle))
    falls = G * (np.sin(angle) - mu * np.cos(angle))
    np.testing.assert_allclose(run.joint_position[:, 0], 0.5 * falls * run.time**2, atol=1e-13)
    assert run.balance.max() < 1e-12
    (use,) = run.drives
    assert use.kind == "friction"
    kinetic, potential, work = run.energy.T
    np.testing.assert_allclose(kinetic + potential, work, atol=1e-12)
    np.testing.assert_allclose(work[-1], -mu * 2.0 * G * np.cos(angle) * run.joint_position[-1, 0], rtol=1e-10)


def test_a_block_that_was_pushed_stops_at_the_place_and_time_of_the_closed_form():
    run = _block(Course(1.0, 0.25), kinetic=0.5, start=(0.0, -2.0))
    stops = 2.0 / (0.5 * G)
    expected = np.where(run.time < stops, -2.0 * run.time + 0.25 * G * run.time**2, -2.0 * stops / 2.0)
    np.testing.assert_allclose(run.joint_position[:, 0], expected, atol=1e-12)
    assert np.all(run.joint_velocity[run.time > stops] == 0.0)


def test_a_spring_swings_ever_less_about_shifted_centres_until_friction_at_rest_holds_it():
    stiffness, kinetic, static, omega = 200.0, 0.3, 0.4, 10.0
    shift = kinetic * 2.0 * G / stiffness

    def place(t):
        x = 0.1
        while stiffness * abs(x) > static * 2.0 * G:
            centre = np.sign(x) * shift
            if t < np.pi / omega:
                return centre + (x - centre) * np.cos(omega * t)
            x, t = 2.0 * centre - x, t - np.pi / omega
        return x

    run = _block(Course(0.7, 0.1), kinetic=kinetic, static=static, start=(0.1, 0.0), spring=stiffness)
    np.testing.assert_allclose(run.joint_position[:, 0], [place(t) for t in run.time], atol=1e-9)
    assert run.friction_sticks[-1, 0] and not run.friction_sticks[1, 0]


def test_a_block_that_a_growing_force_pulls_starts_when_the_limit_is_reached():
    run = _block(Course(1.0, 0.1), kinetic=0.2, static=0.25, push=Ramp(0.0, 12.0))
    starts = 0.25 * 2.0 * G / 12.0
    after = np.maximum(run.time - starts, 0.0)
    less = 2.0 * G * 0.05
    np.testing.assert_allclose(run.joint_position[:, 0], after**3 + 0.25 * less * after**2, atol=1e-12)


def test_a_block_on_a_belt_sticks_and_slips_in_the_period_of_the_closed_form():
    """Slip: about the place where friction in motion balances the spring, from the limit at rest, at the belt's pace,
    until the pace is the belt's again (Den Hartog, Mechanical Vibrations, section 7.6)."""
    belt, stiffness, mass, kinetic, static = 0.1, 50.0, 2.0, 0.2, 0.3
    model = Model()
    model.ground("base")
    model.body("belt", 1.0, (0, 0, 0), inertia=1e-3 * np.eye(3))
    model.body("block", mass, (0, 0, 0), inertia=1e-3 * np.eye(3))
    model.joint("drive", "base", "belt", "prismatic", axis=(1, 0, 0))
    model.joint("slide", "belt", "block", "prismatic", axis=(1, 0, 0))
    model.motion("pace", "drive", Ramp(0.0, belt))
    model.spring_between("spring", "base", "block", ((-1, 0, 0), (0, 0, 0)), stiffness, rest=1.0)
    model.friction("friction", "slide", kinetic, static=static)
    run = simulate_system(model.system(), Course(2.5, 0.1))
    omega = np.sqrt(stiffness / mass)
    over = (static - kinetic) * mass * G / stiffness
    starts = static * mass * G / stiffness / belt
    assert starts < 2.5
    x = run.joint_position.sum(axis=1)
    slipping = 2.0 * (np.pi - np.arctan(over * omega / belt)) / omega
    inside = (run.time > starts) & (run.time < starts + slipping)
    t = run.time[inside] - starts
    centre = kinetic * mass * G / stiffness
    np.testing.assert_allclose(
        x[inside], centre + over * np.cos(omega * t) + belt / omega * np.sin(omega * t), atol=1e-9
    )
    assert not run.friction_sticks[inside].any() and run.friction_sticks[~inside].all()


# --- what loads press on ---


def _screw(torque, *, mu=0.15, collar=0.0, inertia=1e-3, weight=1000.0, flank=0.0, lead=0.004):
    """A vertical screw of 20 mm that lifts a nut of 10 kg with a load."""
    model = Model()
    model.ground("frame")
    model.body("screw", 1.0, (0, 0, 0), inertia=inertia * np.eye(3))
    model.body("nut", 10.0, (0, 0, 0.1), inertia=0.01 * np.eye(3))
    model.joint("spin", "frame", "screw", "revolute", axis=(0, 0, 1), point=(0, 0, 0))
    model.joint("thread", "screw", "nut", "screw", axis=(0, 0, 1), point=(0, 0, 0), pitch=lead)
    model.joint("lift", "frame", "nut", "prismatic", axis=(0, 0, 1))
    model.load("load", "nut", (0, 0, 0.1), force=(0, 0, -weight))
    model.effort("torque", "spin", Constant(torque))
    model.friction("on thread", "thread", mu, surfaces=Rubs(radius=0.01, flank=flank))
    if collar:
        model.friction("on collar", "spin", collar, surfaces=Rubs(thrust=0.02))
    return simulate_system(model.system(), Course(1e-3, 1e-3))


def _shigley(mu, raising, *, flank=0.0, lead=0.004, force=1000.0 + 10.0 * G):
    """Torque of a power screw of 20 mm (Shigley's Mechanical Engineering Design, equations 8-1 and 8-2), with the angle
    of the flanks across the thread."""
    slope = lead / (np.pi * 0.02)
    secant = np.sqrt(1.0 + np.tan(flank) ** 2 / (1.0 + slope**2))
    if raising:
        return force * 0.01 * (slope + mu * secant) / (1.0 - mu * slope * secant)
    return force * 0.01 * (mu * secant - slope) / (1.0 + mu * slope * secant)


@pytest.mark.parametrize(("flank", "collar"), [(0.0, 0.0), (np.radians(14.5), 0.1)])
def test_a_power_screw_raises_and_lowers_at_the_torques_of_the_handbook_and_locks_without(flank, collar):
    ring = collar * 0.02 * (1000.0 + 11.0 * G)
    up, down = (_shigley(0.15, raising, flank=flank) + ring for raising in (True, False))
    assert down > 0.0
    for torque, moves in ((-up, 1), (down, -1)):  # a right-handed screw lifts the nut as it turns backwards
        held = _screw(torque * (1.0 - 1e-9), collar=collar, flank=flank)
        assert np.all(held.joint_position == 0.0), held.reason
        assert np.sign(_screw(torque * (1.0 + 1e-6), collar=collar, flank=flank).joint_position[-1, 2]) == moves
    assert np.all(_screw(0.0, collar=collar, flank=flank).joint_position == 0.0)


def test_a_screw_that_locks_itself_and_has_no_inertia_of_its_own_has_no_unique_motion():
    run = _screw(-10.0, inertia=1e-8)
    assert run.status == "stopped" and "thread" in run.reason


def test_a_journal_brakes_by_its_radius_and_its_load_and_the_ends_of_one_that_tilts_by_both():
    def wheel(z, ends):
        model = Model()
        model.ground("base")
        model.body("wheel", 2.0, (0, 0, z), inertia=0.05 * np.eye(3))
        model.joint("hinge", "base", "wheel", "revolute", axis=(0, 0, 1), point=(0, 0, 0))
        rubs = Rubs(radius=0.01, lower=ends[0], upper=ends[1])
        model.friction("bearing", "hinge", 0.1, surfaces=rubs)
        course = Course(0.1, 0.1, np.array([G, 0.0, 0.0]))
        return simulate_system(model.system(), course, initial={"hinge": (0.0, 3.0)})

    load = 2.0 * G
    for z, ends, grip in (
        (0.0, (0.0, 0.0), load),
        (0.3, (0.0, 0.0), load),
        (0.01, (-0.02, 0.02), load),
        (0.05, (-0.02, 0.02), load * 2.0 * 0.05 / 0.04),
    ):
        np.testing.assert_allclose(wheel(z, ends).friction_effort[:, 0], -0.1 * 0.01 * grip, rtol=1e-12)


PLACES = {"O": (0.0, 0.0), "A": (0.07, 0.07), "B": (0.35, 0.2), "C": (0.3, 0.0)}


def _four_bar(friction):
    """A crank and rocker in the vertical plane with friction in all of its bearings."""
    places = PLACES
    model = Model()
    model.ground("frame")
    for name, first, second in (("crank", "O", "A"), ("rod", "A", "B"), ("rocker", "B", "C")):
        middle = 0.5 * (np.array(places[first]) + np.array(places[second]))
        model.body(name, 1.0, (middle[0], 0.0, middle[1]), inertia=2e-3 * np.eye(3))
    order = ("frame", "crank", "rod", "rocker", "frame")
    for name, first, second in zip("OABC", order[:-1], order[1:], strict=True):
        x, z = places[name]
        model.joint(name, first, second, "revolute", axis=(0, 1, 0), point=(x, 0, z))
        if friction:
            model.friction(f"in {name}", name, friction, surfaces=Rubs(radius=0.01))
    return model


def test_the_bearings_of_a_four_bar_take_the_energy_that_it_loses():
    run = simulate_system(_four_bar(0.3).system(), Course(0.05, 0.025))
    assert run.status == "done", run.reason
    total = run.energy @ (1.0, 1.0, -1.0)
    np.testing.assert_allclose(total, total[0], atol=1e-9)
    power = np.einsum("tm,tm->t", run.friction_effort, run.joint_velocity)
    assert power.max() <= 1e-12 and run.energy[-1, 2] < -1e-4
    assert run.balance.max() < 1e-9


def test_four_bars_stick_together_where_all_bearings_at_their_limits_hold_them():
    """The least coefficient at which it stays, from the balance of the three bars in the plane with all pins at their
    limits against the motion that begins."""
    moving = simulate_system(_four_bar(0.0).system(), Course(1e-4, 1e-4)).joint_velocity[-1]
    points = [np.array(PLACES[name]) for name in "OABC"]

    def rest(unknown):
        forces, mu = unknown[:8].reshape(4, 2), unknown[8]  # on the second body of each pin
        torques = -np.sign(moving) * mu * 0.01 * np.linalg.norm(forces, axis=1)
        out = []
        for k in range(3):
            middle = 0.5 * (points[k] + points[k + 1])
            out += list(forces[k] - forces[k + 1] - (0.0, G))
            # about y: z × x is y, so that the moment of (fx, fz) at (x, z) is z fx − x fz
            for end, sense in ((k, 1.0), (k + 1, -1.0)):
                x, z = points[end] - middle
                out.append(sense * (z * forces[end, 0] - x * forces[end, 1] + torques[end]))
            out[-2:] = [out[-2] + out[-1]]
        return np.array(out)

    answer = fsolve(rest, np.concatenate([np.tile([1.0, G], 4), [3.0]]), full_output=True, xtol=1e-13)
    assert answer[2] == 1 and answer[0][8] > 0.0
    least = float(answer[0][8])
    held = simulate_system(_four_bar(least * (1.0 + 1e-8)).system(), Course(10.0, 10.0))
    assert np.all(held.joint_position == 0.0) and held.friction_sticks.all()
    assert np.any(simulate_system(_four_bar(least * (1.0 - 1e-6)).system(), Course(1e-2, 1e-2)).joint_position[-1])


@pytest.mark.parametrize("led", [False, True])
def test_a_slider_that_rubs_turns_its_friction_at_both_dead_centres(led):
    """At a dead centre the slider stands still and the crank does not: nothing sticks."""
    crank, rod, start, pace = 0.03, 0.1, 2.5, 20.0
    pin = np.array([crank * np.cos(start), crank * np.sin(start), 0.0])
    eye = np.array([pin[0] + np.sqrt(rod**2 - pin[1] ** 2), 0.0, 0.0])
    model = Model()
    model.ground("frame")
    model.body("crank", 1.0, (0, 0, 0), inertia=2e-3 * np.eye(3))
    model.body("rod", 0.1, 0.5 * (pin + eye), inertia=1e-4 * np.eye(3))
    model.body("piston", 0.3, eye, inertia=1e-4 * np.eye(3))
    hinges = ("O", "frame", "crank", (0, 0, 0)), ("A", "crank", "rod", pin), ("S", "rod", "piston", eye)
    for name, first, second, at in hinges:
        model.joint(name, first, second, "revolute", axis=(0, 0, 1), point=at)
    model.joint("B", "frame", "piston", "prismatic", axis=(1, 0, 0))
    model.friction("ring", "B", 0.2, least=True)
    if led:
        model.motion("motor", "O", Ramp(0.0, pace))
    initial = {} if led else {"O": (0.0, pace)}
    run = simulate_system(model.system(), Course(0.1, 0.02, np.array([0.0, -G, 0.0])), initial=initial)
    assert run.status == "done", run.reason
    slide = run.joint_velocity[:, run.joint_names.index("B")]
    assert slide.min() < -0.1 < 0.1 < slide.max()
    assert np.all(run.friction_effort[:, 0] * slide < 0.0) and not run.friction_sticks.any()
    total = run.energy @ (1.0, 1.0, -1.0)
    np.testing.assert_allclose(total, total[0], atol=1e-9)
    assert run.balance.max() < 1e-9


def test_what_redundant_constraints_share_is_refused_and_named():
    model = Model()
    model.ground("frame")
    model.body("shaft", 1.0, (0, 0, 0.1), inertia=1e-3 * np.eye(3))
    for k in range(2):
        model.joint(f"bearing {k}", "frame", "shaft", "revolute", axis=(0, 0, 1), point=(0, 0, 0.2 * k))
        model.friction(f"in {k}", f"bearing {k}", 0.1, surfaces=Rubs(radius=0.01))
    run = simulate_system(model.system(), Course(1.0, 0.1))
    assert run.status == "refused" and "bearing 0" in {subject for subject, _ in run.failures}


def test_friction_without_load_holds_a_pendulum_up_to_its_effort_and_brakes_it_beyond():
    def pendulum(effort, angle):
        model = Model()
        model.ground("base")
        model.body("bob", 1.0, (0, 0, -1), inertia=np.zeros((3, 3)))
        model.joint("hinge", "base", "bob", "revolute", axis=(0, 1, 0), point=(0, 0, 0))
        model.friction("seal", "hinge", effort=effort)
        return simulate_system(model.system(), Course(2.6, 0.2), initial={"hinge": (angle, 0.0)})

    held = pendulum(2.0, np.arcsin(2.0 / G) * 0.999)
    assert np.ptp(held.joint_position) == 0.0
    swings = pendulum(2.0, 1.0)
    turned = np.abs(np.diff(swings.joint_position[:, 0]))
    assert swings.friction_sticks[-1, 0] and turned[-1] == 0.0
    total = swings.energy @ (1.0, 1.0, -1.0)
    np.testing.assert_allclose(total, total[0], atol=1e-8)
    first = int(np.argmax(np.diff(swings.joint_position[:, 0]) > 0.0))
    assert first > 1


def test_a_swinging_force_below_the_limit_moves_nothing_and_above_it_for_a_while():
    still = _block(Course(0.2, 0.05), kinetic=0.2, push=Sine(0.0, 0.2 * 2.0 * G * 0.999, 20.0, 0.0))
    assert np.all(still.joint_position == 0.0)
    run = _block(Course(0.16, 0.02), kinetic=0.2, push=Sine(0.0, 0.2 * 2.0 * G * 1.5, 40.0, 0.0))
    assert run.friction_sticks.any() and not run.friction_sticks.all()
    assert run.joint_position.max() > 2e-4


def test_friction_that_is_not_possible_is_named():
    model = Model()
    model.ground("base")
    model.body("ball", 1.0, (0, 0, 0), inertia=np.eye(3))
    model.joint("socket", "base", "ball", "spherical", point=(0, 0, 0))
    with pytest.raises(ValueError, match="spherical"):
        model.friction("friction", "socket", 0.1, freedom=0)
    model.joint("hinge", "base", "ball", "revolute", axis=(0, 0, 1), point=(0, 0, 0))
    with pytest.raises(ValueError, match="radius"):
        model.friction("friction", "hinge", 0.1)
