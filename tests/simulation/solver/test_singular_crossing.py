"""Singular poses are crossed to the same motion, whatever steps came before them."""

import numpy as np
import pytest
from support.crossings import WITHIN, pendulum, perturbed_run
from support.port_models import DOWN, four_bars

from kinform.simulation import Course, SolverSettings, simulate_system
from kinform.simulation.kernel import layout
from kinform.simulation.kernel.calls import engine
from kinform.simulation.solver import dynamic
from kinform.simulation.solver.collocation import _integrals, places_of
from kinform.simulation.solver.singular_crossing import cross_singular_pose

FLAT = {2: 0.714263, 10: 0.720236}
"""s: when so many four-bars, let go upright with −1 rad/s, lie flat first."""


@pytest.mark.parametrize("count", FLAT)
@pytest.mark.parametrize("distance", [3e-3, 1e-4, 3e-6])
def test_a_run_that_came_as_near_as_that_leaps_to_the_motion_of_a_pendulum(count, distance, monkeypatch):
    landed = []
    advance = dynamic._Driver._advance

    def short_of_the_pose(driver):
        run = driver.run
        if landed:
            return advance(driver)
        goal = run.clock[layout.END]
        run.clock[layout.END] = FLAT[count] - distance
        while run.clock[layout.NOW] < run.clock[layout.END]:
            # as steps shrink that are laid towards the pose from too near
            run.clock[layout.STEP] = min(run.clock[layout.STEP], 0.03)
            advance(driver)
        run.clock[layout.END] = goal
        outcome = cross_singular_pose(run)
        q, v = run.dynamics.tables.unpack(run.y)
        landed.append((outcome, float(run.clock[layout.NOW]), q.copy(), v.copy(), run.dynamics.mechanism.slots))
        return advance(driver)

    monkeypatch.setattr(dynamic._Driver, "_advance", short_of_the_pose)
    run = simulate_system(four_bars(count).system(), Course(1.0, 0.1, DOWN), initial={"foot 0": (0.0, -1.0)})
    assert run.status == "done"
    (outcome, now, q, v, slots), *_ = landed
    assert outcome is None
    assert now > FLAT[count]
    wanted = pendulum(count, (0.0, -1.0), [now])[0]
    feet = [slot for slot in slots if slot.name.startswith("foot")]
    assert len(feet) == count + 1
    assert [q[slot.q][0] for slot in feet] == pytest.approx([wanted[0]] * len(feet), abs=1e-9)
    assert [v[slot.v][0] for slot in feet] == pytest.approx([wanted[1]] * len(feet), abs=1e-8)
    exact = pendulum(count, (0.0, -1.0), run.time)
    column = run.joint_offset[run.joint_names.index("foot 0")]
    # outputs on the way too: 0.7 s and 0.8 s lie on either side
    np.testing.assert_allclose(run.joint_position[:, column], exact[:, 0], atol=1e-9)


@pytest.mark.parametrize("stages", [6, 8])
def test_the_step_is_exact_for_polynomials_of_twice_its_stages_and_keeps_clear_of_its_middle(stages):
    nodes = np.array(places_of(stages))
    assert np.abs(nodes - 0.5).min() > 0.09
    for degree in range(2 * stages):
        assert np.dot(_integrals(1.0, stages), nodes**degree) == pytest.approx(1 / (degree + 1), rel=1e-13)
    for degree in range(stages):
        way = np.dot(_integrals(0.3, stages), nodes**degree)
        assert way == pytest.approx(0.3 ** (degree + 1) / (degree + 1), abs=1e-14)


def same_motion(count, seeds):
    engine(compiled=True)
    for seed in range(seeds):
        run, angle, rate = perturbed_run(count, seed)
        assert (run.status, run.reason) == ("done", ""), seed
        assert (angle < WITHIN[0], rate < WITHIN[1]) == (True, True), (seed, angle, rate)


@pytest.mark.parametrize(("count", "seeds"), [(2, 8), (10, 3)])
def test_four_bars_with_other_last_bits_move_alike(count, seeds):
    same_motion(count, seeds)


@pytest.mark.slow
@pytest.mark.parametrize(("count", "seeds"), [(2, 100), (10, 60), (40, 10)])
def test_many_four_bars_with_other_last_bits_move_alike(count, seeds):
    same_motion(count, seeds)


@pytest.mark.parametrize("rtol", [1e-11, 3e-10, 1e-9])
def test_other_steps_across_singular_poses_give_the_same_motion(rtol):
    settings = SolverSettings(rtol=rtol, atol=rtol / 100)
    course = Course(10.0, 1.0, DOWN)
    run = simulate_system(four_bars(2).system(), course, initial={"foot 0": (0.0, -1.0)}, settings=settings)
    exact = pendulum(2, (0.0, -1.0), run.time)
    column = run.joint_offset[run.joint_names.index("foot 0")]
    np.testing.assert_allclose(run.joint_position[:, column], exact[:, 0], atol=1e3 * rtol)
