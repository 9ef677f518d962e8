"""Loops in the kernel: least corrections by mass, whichever rows are eliminated in whichever order."""

from __future__ import annotations

import numpy as np
import pytest
from support.port_models import DOWN, bricard, four_bars, hung_chain, squeezer

from kinform.simulation import Course, SolverSettings, simulate_system, system_simulation
from kinform.simulation.kernel import layout
from kinform.simulation.kernel.calls import engine
from kinform.simulation.kernel.loops import eliminate
from kinform.simulation.kernel.tables import address, addresses
from kinform.simulation.solver.run_state import Run


def begun(model, monkeypatch):
    """(dynamics, start) with which the system would be simulated."""
    caught, run = [], system_simulation.run_dynamic

    def caught_run(dynamics, start, *rest):
        caught.append((dynamics, start))
        return run(dynamics, start, *rest)

    monkeypatch.setattr(system_simulation, "run_dynamic", caught_run)
    assert simulate_system(model.system(), Course(1e-3, 1e-3, DOWN)).status == "done"
    return caught[0]


MECHANISMS = {
    "four-bars": lambda: four_bars(4),
    "Bricard": bricard,
    "squeezer": lambda: squeezer()[0],
}


@pytest.mark.parametrize("name", MECHANISMS)
def test_rates_are_corrected_least_by_mass_in_any_pose(name, monkeypatch):
    dynamics, start = begun(MECHANISMS[name](), monkeypatch)
    mechanism, rng = dynamics.mechanism, np.random.default_rng(3)
    q = start.q
    for _ in range(6):
        # Rows change places from pose to pose, and stay so.
        q, _ = dynamics.project(0.0, q + 0.02 * rng.normal(size=len(q)), np.zeros(mechanism.rates), 1e-14)
        v = rng.normal(size=mechanism.rates)
        _, got = dynamics.project(0.0, q, v, 1e-14)
        rows = mechanism.closure(mechanism.screws(mechanism.poses(q)))
        matrix = dynamics.mass_matrix(q)
        whole = np.block([[matrix, rows.T], [rows, np.zeros((len(rows), len(rows)))]])
        expected = np.linalg.lstsq(whole, np.concatenate([matrix @ v, np.zeros(len(rows))]), rcond=1e-12)[0]
        np.testing.assert_allclose(got, expected[: len(v)], atol=1e-9 * np.abs(v).max())


@pytest.mark.parametrize("number", [np.nan, 0.0])
def test_rows_that_are_no_numbers_have_no_pivots(number, monkeypatch):
    """As after a trial step of a stiff spring: a division by zero would end the run."""
    dynamics, start = begun(four_bars(1), monkeypatch)
    Run(dynamics, start, np.array([0.0, 1.0]), SolverSettings()).open_stretch(0.0, 1.0)
    tables = dynamics.tables
    tables.work[layout.ROWS][:] = number
    assert eliminate(tables.ints, tables.nums, tables.work) == 0.0
    assert tables.work[layout.VECTORS][layout.KEPT][0] == 0.0


@pytest.mark.parametrize("make", [lambda: four_bars(4), hung_chain])
def test_units_give_the_same_by_addresses_as_from_arrays(make, monkeypatch):
    dynamics, start = begun(make(), monkeypatch)
    run = Run(dynamics, start, np.array([0.0, 1.0]), SolverSettings())
    run.open_stretch(0.0, 1.0)
    rng = np.random.default_rng(5)
    plain, compiled = engine(compiled=False), engine(compiled=True)
    for _ in range(4):
        y = run.y + 0.03 * rng.normal(size=len(run.y))
        found = []
        for run.engine in (plain, compiled):
            at, dy, out = y.copy(), np.zeros_like(y), np.zeros_like(run.out[0])
            gap, kept = run.project(0.3, at)
            margin = run.derivative(0.3, at, dy)
            run.sample(0.3, at, out)
            found.append(np.concatenate([[gap < 1e-13, kept, margin], at, dy, out]))
        np.testing.assert_allclose(found[1], found[0], rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("array", [np.zeros((3, 4))[:, 1], np.zeros(3, dtype=np.float32), np.zeros((2, 3)).T])
def test_an_array_that_the_kernel_cannot_read_is_refused(array):
    with pytest.raises(TypeError):
        address(array)


def test_addresses_tell_where_each_table_is_and_how_large():
    tables = (np.zeros((2, 3)), np.zeros((0, 4), dtype=np.int64))
    assert addresses(tables).tolist() == [tables[0].ctypes.data, 2, 3, tables[1].ctypes.data, 0, 4]
