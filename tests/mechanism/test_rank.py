"""Many closed loops: beside each other they are what each is alone, and a long row of them keeps its rank."""

from __future__ import annotations

import numpy as np
import pytest
from support.port_models import DOWN, Model, four_bars

from kinform.mechanism.rank import EVEN, FALLEN, counted
from kinform.simulation import Course, simulate_system
from kinform.simulation.mechanism.construction import assemble
from kinform.simulation.mechanism.loop_systems import loop_values

COURSE = Course(0.1, 0.02, DOWN)


def separate(count, *, rise=lambda k: 1.2 + 0.05 * k):
    """Four-bars on one ground, apart from each other, each of another shape."""
    model = Model()
    for k in range(count):
        feet, heads = [(3.0 * k + x, 0, 0) for x in (0, 1)], [(3.0 * k, 1, 0), (3.0 * k + 1, rise(k), 0)]
        model.rod(f"a{k}", feet[0], heads[0])
        model.rod(f"b{k}", heads[0], heads[1])
        model.rod(f"c{k}", feet[1], heads[1])
        model.joint(f"p{k}", "base", f"a{k}", point=feet[0])
        model.joint(f"q{k}", f"a{k}", f"b{k}", point=heads[0])
        model.joint(f"r{k}", f"b{k}", f"c{k}", point=heads[1])
        model.joint(f"s{k}", "base", f"c{k}", point=feet[1])
    return model.system()


def test_loops_apart_carry_what_each_carries_alone():
    together = simulate_system(separate(3), COURSE)
    assert together.status == "done"
    for k in range(3):
        alone = simulate_system(separate(1, rise=lambda _, k=k: 1.2 + 0.05 * k), COURSE)
        mine = slice(4 * k, 4 * k + 4)
        assert np.allclose(together.F_B[:, mine], alone.F_B, rtol=0, atol=1e-7)
        assert np.array_equal(together.undetermined[mine], alone.undetermined)
    assert together.undetermined.any() and not together.undetermined.all()


@pytest.mark.slow
def test_a_long_row_of_loops_has_the_rank_of_a_short_one():
    """Of 160 four-bars in a row the least singular value is below 1e-4 of the largest."""
    for many in (2, 160):
        run = simulate_system(four_bars(many).system(), Course(0.02, 0.01, DOWN))
        assert run.status == "done"
        assert np.all(run.rank == 3 * many)


@pytest.mark.parametrize(
    "values, expected",
    [
        ([1.0, 0.5, 1e-5], 2),  # a misfit
        ([1.0, 0.5, 2e-4, 9e-5, 3e-5, 1e-15], 5),  # going on, and then nothing
        ([1.0, 0.5, 2e-4, 9e-5, 3e-5, 1e-6, 1e-7], 3),  # going on, and never nothing
        ([1.0, 0.5, 2e-4, 9e-5], 3),  # going on to the end
        ([0.0, 0.0], 0),
        ([1.0, 0.3], 2),
    ],
)
def test_singular_values_count_by_their_share_or_as_they_go_on(values, expected):
    assert counted(np.array(values), 1e-4) == expected
    stacked = counted(np.array([values, values]), 1e-4)
    assert stacked.tolist() == [expected, expected]
    assert FALLEN < EVEN


@pytest.mark.parametrize("system", [separate(3), four_bars(5).system(), separate(1)], ids=["apart", "row", "one"])
def test_singular_values_of_loops_are_those_of_all_their_conditions(system):
    mechanism = assemble(system)[0]
    q = mechanism.start + 0.1 * np.random.default_rng(0).normal(size=(3, len(mechanism.start)))
    screws = np.array([mechanism.screws(mechanism.poses(one)) for one in q])
    expected = np.linalg.svd(mechanism.closure(screws) * mechanism.scale, compute_uv=False)
    got = loop_values(mechanism, screws)
    assert got.shape == expected.shape
    assert np.allclose(got, expected, rtol=0, atol=1e-13 * expected.max())
