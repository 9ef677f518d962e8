"""Root mean squares and work of drives: integrals of the motion, whatever the output times."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from support.diagonal import diagonal

from kinform.behaviour import Constant, Controller, Model, Sine
from kinform.simulation import Course, SolverSettings, simulate_system

MASS, ARM, MOMENT, G = 1.4, 0.6, 0.05, 9.81
DURATION = 2.3
NONE = np.zeros(3)


def _pendulum(build):
    """A body on a hinge along y whose centre lies on x at the pose of the meshes; gravity along −z."""
    model = Model()
    model.ground("ground")
    model.body("bob", MASS, (ARM, 0, 0), (0.02, MOMENT, 0.02))
    model.joint("hinge", "ground", "bob", "revolute", point=(0, 0, 0), axis=(0, 1, 0))
    build(model)
    return model.system()


def _used(build, step, gravity=(0.0, 0.0, -G), **more):
    run = simulate_system(_pendulum(build), Course(DURATION, step, np.array(gravity)), **more)
    assert run.status == "done"
    return run


def _root(function):
    """Root of the mean square over the run."""
    return np.sqrt(quad(lambda t: function(t) ** 2, 0.0, DURATION, epsabs=1e-12, epsrel=1e-12, limit=500)[0] / DURATION)


@pytest.mark.parametrize("step", [DURATION, 0.31, 0.02])
def test_what_a_prescribed_motion_takes_is_its_closed_form(step):
    size, speed = 0.7, 5.0
    (use,) = _used(lambda m: m.motion("lead", "hinge", Sine(0.0, size, speed, 0.0)), step).drives

    def torque(t):
        angle = size * np.sin(speed * t)
        return -(MOMENT + MASS * ARM**2) * size * speed**2 * np.sin(speed * t) - MASS * G * ARM * np.cos(angle)

    def power(t):
        return torque(t) * size * speed * np.cos(speed * t)

    work = quad(power, 0.0, DURATION, epsabs=1e-12, epsrel=1e-12, limit=500)[0]
    assert use.kind == "motion"
    assert use.rms == pytest.approx(_root(torque), rel=1e-8)
    assert use.rms_power == pytest.approx(_root(power), rel=1e-8)
    assert use.work == pytest.approx(work, rel=1e-8)


DRIVES = {
    "effort": lambda m: m.effort("push", "hinge", Sine(0.5, 4.0, 9.0, 0.3)),
    "damper": lambda m: m.damper("brake", "hinge", 0.4),
    "servo": lambda m: m.servo("hold", "hinge", Constant(0.4), Controller(40.0, 25.0, 2.0, 9.0)),
    "spring": lambda m: m.spring("coil", "hinge", 35.0, 0.2),
    "dc_motor": lambda m: (
        m.motor("motor", "hinge", 1.1, 0.004, 0.05, 20.0),
        m.voltage("supply", "motor", Constant(6.0)),
    ),
}


@diagonal(kind=sorted(DRIVES), method=["explicit", "implicit"])
def test_coarse_outputs_tell_the_same_as_fine_ones(kind, method):
    settings = SolverSettings(method=method)
    fine, coarse = (_used(DRIVES[kind], step, settings=settings) for step in (0.001, 0.5 * DURATION))
    (exact,), (use,) = fine.drives, coarse.drives
    assert use.kind == kind
    # The fine run's own outputs, summed: what both have to be.
    effort, power = fine.drive_effort[:, 0], fine.drive_effort[:, 0] * fine.drive_speed[:, 0]
    assert exact.rms == pytest.approx(np.sqrt(np.trapezoid(effort**2, fine.time) / DURATION), rel=2e-5)
    assert exact.work == pytest.approx(np.trapezoid(power, fine.time), rel=1e-4, abs=1e-5)
    within = 1e-8 if method == "explicit" else 1e-5
    assert (use.rms, use.work, use.rms_power) == pytest.approx((exact.rms, exact.work, exact.rms_power), rel=within)


def test_the_work_of_a_stop_is_what_its_impacts_take():
    """A block without gravity meets its stop once and leaves with half its speed."""
    model = Model()
    model.ground("ground")
    model.body("block", 2.0, (0, 0, 0), (0.01, 0.01, 0.01))
    model.joint("slide", "ground", "block", "prismatic", axis=(1, 0, 0))
    model.stop("stop", "slide", upper=0.3, restitution=0.5)
    run = simulate_system(model.system(), Course(1.0, 0.1, NONE), initial={"slide": (0.0, 1.2)})
    (use,) = run.drives
    assert use.kind == "stop" and use.work == pytest.approx(-0.5 * 2.0 * 1.2**2 * (1 - 0.25), rel=1e-9)


def test_meters_do_not_change_the_motion():
    """The same motion with an idle damper beside, which adds three meters."""
    bare = _used(DRIVES["effort"], 0.01)
    beside = _used(lambda m: (DRIVES["effort"](m), m.damper("idle", "hinge", 0.0)), 0.01)
    np.testing.assert_array_equal(bare.joint_position, beside.joint_position)
    assert beside.drives[1].rms == 0.0 and beside.drives[1].work == 0.0
