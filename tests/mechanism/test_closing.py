"""Loops are closed near a configuration, with coordinates held, alone or many at once; what does not close says so."""

from __future__ import annotations

import numpy as np
import pytest
from support.devices import joint
from support.linkages import KNOWN, planar

from kinform.mechanism.closing import ACCEPTED, CLOSED, StepLimit, Task, Termination, close, close_each
from kinform.mechanism.frame import joint_frame
from kinform.mechanism.loop_system import loop_system


def system_of(mechanism):
    joints = [joint(a, b, kind, axis, point, axis2) for a, b, kind, axis, point, axis2 in mechanism]
    names = sorted({name for one in joints for name in one.bodies})
    edges = [(names.index(a), names.index(b)) for a, b in (one.bodies for one in joints)]
    return loop_system(edges, [one.twists for one in joints], joint_frame(joints, 5.0))


def four_bar():
    """Ground 4, crank 1, coupler 3.61, rocker 2.24: a crank that goes round."""
    return system_of(planar((0, 0), (0, 1), (3, 2), (4, 0)))


@pytest.mark.parametrize("name", ["four-bar", "Bennett", "Stewart platform", "rectangular Bricard"])
def test_loops_close_to_rounding_near_where_they_were_opened(name):
    system = system_of(KNOWN[name][0])
    q = 0.02 * np.random.default_rng(0).normal(size=(5, system.coordinates))
    found = close(system, q)
    assert found.closed.all() and found.residual.max() < CLOSED
    np.testing.assert_allclose(found.q - q, found.change, atol=1e-15)
    assert np.abs(found.change).max() < 0.2
    np.testing.assert_array_equal(found.jacobian, system.equations(found.q).jacobian)


def test_what_is_held_stays_and_the_rest_follows():
    system, held = four_bar(), np.array([True, False, False, False])
    q = np.array([[0.3, 0.0, 0.0, 0.0]])
    found = close(system, q, held)
    assert found.closed[0] and found.q[0, 0] == 0.3 and np.abs(found.q[0, 1:]).min() > 0.01


def test_a_pose_that_cannot_be_reached_is_open_by_what_is_missing():
    system, held = four_bar(), np.array([False, False, False, True])
    found = close(system, np.array([[0.0, 0.0, 0.0, 2.5]]), held)
    assert not found.closed[0] and found.one() is None and found.residual[0] > ACCEPTED


def test_many_are_closed_as_each_alone_is():
    rng, systems = np.random.default_rng(1), [four_bar(), system_of(planar((0, 0), (1, 2), (3, 1), (4, 0)))]
    tasks = [Task(system, 0.05 * rng.normal(size=(3, 4))) for system in systems for _ in range(2)]
    for task, found in zip(tasks, close_each(tasks), strict=True):
        np.testing.assert_array_equal(found.q, close(task.system, task.start).q)
        for q, alone in zip(task.start, found.q, strict=True):
            np.testing.assert_array_equal(close(task.system, q[None]).q[0], alone)


def test_no_step_is_longer_than_its_limit():
    found = close(four_bar(), np.full((1, 4), 0.2), limit=StepLimit(1e-3), until=Termination(iterations=1))
    assert np.linalg.norm(found.change) == pytest.approx(1e-3)
