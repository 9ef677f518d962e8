"""Articulated bodies give what the mass matrix gives, in trees and loops, and keep their digits in long chains."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import DOP853
from support.port_models import DOWN, Model, bricard, chain, four_bars, hung_chain

from kinform.behaviour import MotionDrive, Sine, SpringDamper
from kinform.simulation import Course, SolverSettings, simulate_system
from kinform.simulation.kernel import layout, pivoting
from kinform.simulation.kernel.calls import Engine, by_articulated_bodies, engine, is_loaded
from kinform.simulation.mechanism import kernel_tables
from kinform.simulation.solver.run_state import Run

KINDS = ("revolute", "prismatic", "spherical", "cylindrical", "screw")


def tangle(seed, kinds=KINDS, held=None, led=False):
    """Ten bodies on each other by joints anywhere, with springs to the ground."""
    rng, model = np.random.default_rng(seed), Model()
    for k in range(10):
        root = rng.normal(size=(3, 3))
        second = 0.1 * root @ root.T
        model.body(f"b{k}", rng.uniform(0.5, 2.0), 3 * rng.normal(size=3), np.trace(second) * np.eye(3) - second)
        axis, kind = rng.normal(size=3), kinds[k % len(kinds)]
        before = "base" if k == 0 else f"b{rng.integers(max(0, k - 3), k)}"
        more = {"pitch": 0.1} if kind == "screw" else {}
        model.joint(f"j{k}", before, f"b{k}", kind, axis / np.linalg.norm(axis), 2 * rng.normal(size=3), **more)
        if led and kind == "revolute":
            model.on(f"j{k}", MotionDrive(f"d{k}", f"d{k}", Sine(0.3, 1.0, 0.1, 0.0)))
        elif k % 3 == 0:
            spring = SpringDamper(f"s{k}", f"s{k}", rng.normal(size=3), rng.normal(size=3), 3.0, 0.5, 0.2)
            model.add(spring, a="body base", b=f"body b{k}")
    if held:
        model.joint("held", "b9", "base", held, (0.0, 0.0, 1.0), 2 * rng.normal(size=3))
    return model


def both_ways(model, monkeypatch):
    """(slopes, efforts needed, state) at a pose and rates on closed loops, by the mass matrix and by articulated
    bodies."""
    out = []
    for wanted in (0, 1):
        decide, run_of = pivoting.choose_method, []

        def way(ints, nums, decide=decide, wanted=wanted):
            decide(ints, nums)
            ints[layout.MODE][layout.WAY][0] = wanted

        begin = Run.begin
        monkeypatch.setattr(pivoting, "choose_method", way)
        monkeypatch.setattr(Run, "begin", lambda run, run_of=run_of, begin=begin: run_of.append(run) or begin(run))
        assert simulate_system(model.system(), Course(1e-3, 1e-3, DOWN)).status == "done"
        run = run_of[0]
        tables = run.dynamics.tables
        q, v = tables.unpack(run.y)
        y = tables.pack(q, np.random.default_rng(5).normal(size=len(v)))
        run.project(0.0, y)
        slopes = np.zeros_like(y)
        assert run.derivative(0.01, y, slopes) > 0.0
        out.append((slopes, tables.work[layout.VECTORS][layout.NEED][: len(v)].copy(), y))
        monkeypatch.undo()
    return out


MECHANISMS = {
    **{kind: lambda kind=kind: tangle(1, (kind,)) for kind in KINDS},
    "all kinds": lambda: tangle(2),
    "led": lambda: tangle(3, led=True),
    "loop by a ball": lambda: tangle(4, ("revolute", "prismatic"), "spherical"),
    "loop by a hinge, led": lambda: tangle(5, held="revolute", led=True),
    "four-bars": lambda: four_bars(4),
    "Bricard": bricard,
    "hung chain": hung_chain,
}


@pytest.mark.parametrize("name", MECHANISMS)
def test_articulated_bodies_move_as_the_mass_matrix_has_it(name, monkeypatch):
    matrix, bodies = both_ways(MECHANISMS[name](), monkeypatch)
    for one, other in zip(matrix, bodies, strict=True):
        np.testing.assert_allclose(other, one, rtol=0, atol=1e-11 * max(1.0, np.abs(one).max()))


@pytest.mark.parametrize("held", [False, True])
def test_long_chains_are_solved_so_and_short_ones_are_not(held, monkeypatch):
    found, begin = [], Run.begin
    monkeypatch.setattr(Run, "begin", lambda run: found.append(run) or begin(run))
    for links in (3, 100):
        simulate_system(chain(links, held).system(), Course(1e-6, 1e-6, DOWN))
    assert [int(run.dynamics.tables.ints[layout.MODE][layout.WAY, 0]) for run in found] == [0, 1]


def test_a_chain_of_200_links_falls_as_its_recurrence_says(monkeypatch):
    # At rest and level, rods of mass and length 1, F_k the force up that holds the near end of rod k: Newton and Euler
    # of each rod, and that ends meet, give 4 F_0 + 2 F_1 = g and 2 F_(k-1) + 8 F_k + 2 F_(k+1) = 0.
    n, caught, begin = 200, [], Run.begin
    monkeypatch.setattr(Run, "begin", lambda run: caught.append(run) or begin(run))
    simulate_system(chain(n).system(), Course(1e-6, 1e-6, DOWN))
    run = caught[0]
    slopes = np.zeros_like(run.y)
    run.derivative(0.0, run.y.copy(), slopes)
    turning = np.cumsum(slopes[n : 2 * n])
    rows = np.diag(np.full(n, 8.0)) + np.diag(np.full(n - 1, 2.0), 1) + np.diag(np.full(n - 1, 2.0), -1)
    rows[0, 0], wanted = 4.0, np.zeros(n)
    wanted[0] = 9.81
    forces = np.append(np.linalg.solve(rows, wanted), 0.0)
    expected = -6.0 * (forces[:-1] + forces[1:])
    np.testing.assert_allclose(turning, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_compiled_articulated_bodies_give_the_same_bits():
    runs = {}
    for compiled in (False, True):
        caught, begin = [], Run.begin
        Run.begin = lambda run, caught=caught, begin=begin: caught.append(run) or begin(run)
        try:
            simulate_system(chain(60, held=True).system(), Course(1e-6, 1e-6, DOWN), settings=SolverSettings())
        finally:
            Run.begin = begin
        run = caught[0]
        run.engine = engine(compiled=compiled)
        y, slopes = run.y + 0.01 * np.sin(np.arange(len(run.y))), np.zeros_like(run.y)
        run.project(0.0, y)
        run.derivative(0.0, y, slopes)
        runs[compiled] = np.concatenate([y, slopes])
    assert runs[False].tobytes() == runs[True].tobytes()


def test_the_build_without_articulated_bodies_leaves_tables_that_want_them_to_the_other(monkeypatch):
    caught, begin = [], Run.begin
    monkeypatch.setattr(Run, "begin", lambda run: caught.append(run) or begin(run))
    monkeypatch.setattr(Engine, "loaded", set())
    small = engine(compiled=True)
    assert Engine.loaded == {False}
    slopes = []
    for links in (3, 60):
        simulate_system(chain(links, held=True).system(), Course(1e-6, 1e-6, DOWN), settings=SolverSettings())
        run = caught[-1]
        assert by_articulated_bodies(run.dynamics.tables) == (links == 60) == (not is_loaded(run.dynamics.tables))
        for run.engine in (engine(compiled=False), small):
            slopes.append(np.zeros_like(run.y))
            run.derivative(0.0, run.y.copy(), slopes[-1])
        assert slopes[-1].tobytes() == slopes[-2].tobytes()
    assert Engine.loaded == {False, True}


def test_the_method_has_the_numbers_of_scipy():
    table = kernel_tables._coefficients()
    assert np.array_equal(table[:12, :12], DOP853.A[:12, :12])
    assert np.array_equal(table[13:16], DOP853.A_EXTRA)
    assert np.array_equal(table[layout.B_ROW, :12], DOP853.B)
    assert np.array_equal(table[layout.C_ROW, :16], [*DOP853.C[:12], 1.0, *DOP853.C_EXTRA])
    assert np.array_equal(table[layout.E3_ROW, :13], DOP853.E3)
    assert np.array_equal(table[layout.E5_ROW, :13], DOP853.E5)
    assert np.array_equal(table[layout.D_ROW : layout.D_ROW + 4], DOP853.D)
    assert np.array_equal(table[12, :12], DOP853.B)
