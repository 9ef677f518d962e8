"""Four-bars that pass their flat pose, or pass it by a hair: which branch they take, by the closed form of their
angles, and what a run says of it."""

import re

import numpy as np
import pytest

from kinform.behaviour import Model, Ramp
from kinform.simulation import Course, simulate_system

CRANK = 0.3


def four_bar(coupler, start):
    """Crank and rocker of one length on a base of 1 m; at first the rocker is on the left of crank pin to base pin."""
    foot, pin = np.array([1.0, 0.0, 0.0]), CRANK * np.array([np.cos(start), np.sin(start), 0.0])
    elbow = np.array([*joint_at(coupler, start), 0.0])
    model = Model()
    model.ground("base")
    for name, first, second in (("crank", np.zeros(3), pin), ("coupler", pin, elbow), ("rocker", foot, elbow)):
        turning = np.linalg.norm(second - first) ** 2 / 12
        model.body(name, 1.0, (first + second) / 2, (1e-4, 1e-4, turning))
    pins = (("a", "base", "crank", np.zeros(3)), ("b", "crank", "coupler", pin), ("c", "coupler", "rocker", elbow))
    for name, one, other, point in (*pins, ("d", "base", "rocker", foot)):
        model.joint(name, one, other, "revolute", axis=(0, 0, 1), point=point)
    return model


def joint_at(coupler, angle):
    """(2,) the joint of coupler and rocker, on the left of the line from crank pin to base pin."""
    pin, foot = CRANK * np.array([np.cos(angle), np.sin(angle)]), np.array([1.0, 0.0])
    line = foot - pin
    reach = np.linalg.norm(line)
    along = (coupler**2 - CRANK**2 + reach**2) / (2 * reach)
    across = np.sqrt(max(coupler**2 - along**2, 0.0))
    return pin + (along * line + across * np.array([-line[1], line[0]])) / reach


def rocker(coupler, angles):
    ends = np.array([joint_at(coupler, angle) for angle in angles]) - [1.0, 0.0]
    return np.unwrap(np.arctan2(ends[:, 1], ends[:, 0]))


@pytest.mark.parametrize("more", [1e-3, 1e-6])
@pytest.mark.parametrize("driven", [True, False])
def test_a_coupler_longer_by_a_hair_keeps_the_rocker_on_its_side(more, driven):
    model = four_bar(1.0 + more, 1.0)
    if driven:
        model.motion("drive", "a", Ramp(0.0, 2.0))
    start = {} if driven else {"a": (0.0, 2.0)}
    run = simulate_system(model.system("four-bar"), Course(2.0, 0.01, (0, 0, 0)), initial=start)
    assert run.status == "done"
    crank, follower = (run.joint_position[:, run.joint_names.index(name)] for name in "ad")
    assert crank[-1] + 1.0 > np.pi + 0.5
    wanted = rocker(1.0 + more, crank + 1.0)
    np.testing.assert_allclose(follower, wanted - wanted[0], atol=1e-9)


@pytest.mark.parametrize("driven", [True, False])
def test_a_parallelogram_that_passes_its_flat_pose_or_stops_there_says_so(driven):
    """Its steps are laid across that pose, far from it on either side."""
    model = four_bar(1.0, 1.0)
    if driven:
        model.motion("drive", "a", Ramp(0.0, 2.0))
    start = {} if driven else {"a": (0.0, 2.0)}
    run = simulate_system(model.system("parallelogram"), Course(2.0, 0.01, (0, 0, 0)), initial=start)
    (said,) = [text for text in (run.reason, *run.assumptions) if "t = " in text]
    assert float(re.search(r"t = ([\d.]+) s", said)[1]) == pytest.approx((np.pi - 1.0) / 2.0, abs=0.01)


def test_energy_that_bodies_exchange_among_each_other_alone_raises_no_doubt():
    """Without gravity, springs and drives the sum stays: its rounding is not to be taken for a lost balance."""
    run = simulate_system(
        four_bar(1.001, 1.0).system("four-bar"), Course(2.0, 0.01, (0, 0, 0)), initial={"a": (0.0, 2.0)}
    )
    assert np.ptp(run.energy[:, 0]) < 1e-9 * run.energy[0, 0]
    assert run.status == "done"


@pytest.mark.parametrize("speed", [-9.0, 0.7, 5.0])
@pytest.mark.parametrize("crank", [0.4, 2.78 / 2.01])
def test_a_parallelogram_turns_as_one_through_many_flat_poses_or_says_that_it_may_not(crank, speed):
    """Steps that come too near to such a pose are given up, and the motion is continued across it."""
    model = parallelogram(crank, 0.535)
    model.motion("drive", "a", Ramp(0.0, speed))
    run = simulate_system(model.system("parallelogram"), Course(8.0 * np.pi / abs(speed), 0.05, (0, -9.81, 0)))
    driver, follower = (run.joint_position[:, run.joint_names.index(name)] for name in "ad")
    np.testing.assert_allclose(follower, driver, atol=1e-8)
    assert run.status in ("done", "stopped")
    # the first flat pose is passed in any case
    assert abs(driver[-1]) > np.pi


def parallelogram(crank, start):
    """On a base of 1 m."""
    foot, pin = np.array([1.0, 0.0, 0.0]), crank * np.array([np.cos(start), np.sin(start), 0.0])
    model = Model()
    model.ground("base")
    for name, first, second in (("crank", 0 * pin, pin), ("coupler", pin, foot + pin), ("rocker", foot, foot + pin)):
        turning = np.linalg.norm(second - first) ** 2 / 12
        model.body(name, 1.0, (first + second) / 2, (1e-4, 1e-4, turning))
    pins = (("a", "base", "crank", 0 * pin), ("b", "crank", "coupler", pin), ("c", "coupler", "rocker", foot + pin))
    for name, one, other, point in (*pins, ("d", "base", "rocker", foot)):
        model.joint(name, one, other, "revolute", axis=(0, 0, 1), point=point)
    return model
