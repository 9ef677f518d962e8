"""The kernel gives the same whether compiled or not, and short runs need no compiler."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.diagonal import diagonal
from support.places import FIXTURES
from support.port_models import DOWN, Model, bricard, four_bars, governor, hung_chain

from kinform.behaviour import (
    Bushing,
    Constant,
    Controller,
    DcMotor,
    EffortDrive,
    EndStop,
    GasSpring,
    Gear,
    LoadComponent,
    Sine,
    SpringDamper,
    Table,
    VoltageController,
    flat,
)
from kinform.model.function import SimulationRequest
from kinform.simulation import Course, SolverSettings, simulate, simulate_system
from kinform.simulation.kernel import layout
from kinform.simulation.kernel.calls import Engine, engine, plainly
from kinform.simulation.mechanism.actuation import Actuation
from kinform.simulation.mechanism.construction import assemble
from kinform.simulation.mechanism.dynamics import Dynamics
from kinform.simulation.solver import dynamic

SHORT = """
import sys
sys.path.insert(0, {tests!r})
from support.port_models import DOWN, pendulum
from kinform.behaviour import Constant, EffortDrive, SpringDamper
from kinform.simulation import Course, simulate_system
print(simulate_system(pendulum().system(), Course(0.2, 0.1, DOWN)).status, "numba" in sys.modules)
"""


def test_a_short_run_does_not_import_numba():
    code = SHORT.format(tests=str(Path(__file__).parents[2]))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["done", "False"]


def geared():
    """A weight that winds up a wheel through a gear and falls on an end stop; a motor with a controller besides."""
    model = Model()
    model.rod("arm", (0, 0, 0), (1, 0, 0))
    model.body("wheel", 1.0, (0, 0, 0), (0.02, 0.02, 0.02))
    model.body("fan", 0.2, (0, 0, 1), (0.01, 0.01, 0.01))
    for name in ("arm", "wheel", "fan"):
        model.joint(f"hinge {name}", "base", name)
    model.add(Gear("gear", "gear", 3.0), a="shaft hinge arm", b="shaft hinge wheel")
    model.on("hinge arm", EndStop("stop", "stop", lower=-0.5))
    motor = DcMotor("motor", "motor", resistance=2.0, inductance=0.05, constant=0.04, gear=5.0)
    model.on("hinge fan", motor, terminals="supply")
    pid = VoltageController("pid", "pid", Sine(0.0, 0.6, 4.0, 0.3), Controller(kp=8.0, ki=3.0, kd=0.4, limit=6.0))
    model.on("hinge fan", pid, terminals="supply")
    return model


def elastic():
    """An arm on a ball that a bushing, a gas spring and a load over time hold and move."""
    model = Model()
    model.body("arm", 1.0, (0.5, 0, 0.1), (0.02, 0.08, 0.09))
    model.joint("ball", "base", "arm", kind="spherical")
    of_axes = np.array([[90.0, 40, 60], [20, 30, 25], [1, 2, 3], [0.1, 0.2, 0.3]])
    at = np.array([0.3, 0.1, 0.0])
    model.add(Bushing("rubber", "rubber", at, at, np.eye(3), *of_axes), a="body base", b="body arm")
    gas = GasSpring("gas", "gas", np.array([0, 0, -0.5]), np.array([0.8, 0, 0.1]), 30.0, 1.1, 0.6, 1.3, 2.0)
    model.add(gas, a="body base", b="body arm")
    push, turn, law = np.array([1.0, 2, 3]), np.zeros(3), Sine(0.5, 2.0, 9.0, 0.1)
    model.add(LoadComponent("push", "push", push, turn, np.array([1, 0, 0.2]), True, law), frame="body arm")
    return model


MODELS = {
    "elastic": (elastic, SolverSettings(), 0.3),
    "Bricard": (bricard, SolverSettings(), 0.3),
    "four-bars": (lambda: four_bars(2), SolverSettings(), 0.3),
    "chain": (lambda: hung_chain(Table(np.array([0.0, 0.15, 1.0]), np.array([2.0, -1.0, 0.5]))), SolverSettings(), 0.3),
    "gears and end stop": (geared, SolverSettings(), 0.6),
    "governor, implicit": (governor, SolverSettings(method="implicit"), 0.02),
}


@pytest.mark.parametrize("name", MODELS)
def test_compiled_and_plain_functions_give_the_same_bits(name, monkeypatch):
    make, settings, duration = MODELS[name]
    runs = []
    for plain, loaded in ((10**9, set()), (0, {False})):
        monkeypatch.setattr(dynamic, "PLAIN", plain)
        monkeypatch.setattr(Engine, "loaded", loaded)
        runs.append(simulate_system(make().system(), Course(duration, 0.02, DOWN), settings=settings))
    assert runs[0].status == runs[1].status == "done"
    for part in ("time", "p_WB", "q_WB", "joint_velocity", "joint_effort", "F_B", "energy", "residual"):
        np.testing.assert_array_equal(getattr(runs[1], part), getattr(runs[0], part))
    assert runs[0].assumptions == runs[1].assumptions


@pytest.fixture
def compilations(monkeypatch):
    """How often the driver of runs asks for the compiled functions, which it does not get."""
    asked = []

    def made(*, compiled, articulated_bodies=False):
        asked.extend([True] * compiled)
        return engine(compiled=False)

    monkeypatch.setattr(dynamic, "engine", made)
    monkeypatch.setattr(Engine, "loaded", set())
    return asked


@diagonal(ready=[False, True], drives=[False, True])
def test_ten_seconds_of_the_seeker_need_no_compiler(ready, drives, compilations, derive_design, monkeypatch):
    monkeypatch.setattr(dynamic, "ready", lambda tables: ready)
    found = derive_design(FIXTURES / "seekers" / "seeker_2dof" / "seeker_2dof.toml")
    function = found.assembly.function if drives else replace(found.assembly.function, drives=())
    assembly = replace(found.assembly, simulation=SimulationRequest(duration=10.0, step=0.01), function=function)
    run = simulate(assembly, found.kinematics, found.mass, level="dynamic")
    assert (run.status, run.time[-1]) == ("done", 10.0)
    assert not compilations


def test_a_run_of_few_steps_and_many_outputs_is_compiled(compilations, monkeypatch):
    monkeypatch.setattr(dynamic, "ready", lambda tables: True)
    monkeypatch.setattr(dynamic, "PLAIN", 3000)
    for step, wanted in ((0.01, False), (0.0002, True)):
        assert simulate_system(hung().system(), Course(0.5, step, DOWN)).status == "done"
        assert bool(compilations) == wanted


def test_where_python_refuses_to_divide_by_zero_plain_functions_go_on_as_compiled_ones():
    system = flat(hung().system())
    mechanism, _ = assemble(system)
    tables = Dynamics(mechanism, system, DOWN, Actuation(mechanism, system, with_mass=True), 0).tables
    y = np.array([0.0, 2.0])

    def unit(ints, nums, work, y):
        work[layout.STATE][1][0] = 3.0
        y[1] = y[1] / y[0]
        return y[1]

    assert plainly(unit, tables, y) == np.inf
    assert (y[1], tables.work[layout.STATE][1, 0]) == (np.inf, 3.0)


def test_an_impossible_run_ends_within_its_budget_and_says_when():
    run = simulate_system(
        four_bars(2).system(), Course(10.0, 0.5, DOWN), initial={"foot 0": (0.0, -1.0)},
        settings=SolverSettings(steps=40),
    )  # fmt: skip
    assert run.status == "stopped"
    assert len(run.time) == len(run.F_B) == len(run.balance)


def folded():
    """A parallelogram that starts in line, where it may go on as an antiparallelogram."""
    model = Model()
    for name, start in (("a", 0), ("s", 1), ("b", 1)):
        model.rod(name, (start, 0, 0), (start + 1, 0, 0))
    model.joint("f0", "base", "a")
    model.joint("f1", "base", "b", point=(1, 0, 0))
    model.joint("left", "a", "s", point=(1, 0, 0))
    model.joint("right", "s", "b", point=(2, 0, 0))
    return model


def locked():
    """Two bars in line between fixed hinges: they cannot move, though no rate is blocked."""
    model = Model()
    model.rod("a", (0, 0, 0), (1, 0, 0))
    model.rod("b", (1, 0, 0), (2, 0, 0))
    for name, a, b, x in (("j0", "base", "a", 0), ("j1", "a", "b", 1), ("j2", "base", "b", 2)):
        model.joint(name, a, b, point=(x, 0, 0))
    return model


@pytest.mark.parametrize("make", [folded, locked])
def test_a_start_in_a_singular_pose_is_refused_with_its_joints(make):
    run = simulate_system(make().system(), Course(1.0, 0.1, DOWN))
    assert run.status == "refused"
    ((named, _),) = run.failures
    assert all(joint.name in named for joint in make().system().joints)


def test_a_rigid_structure_that_is_to_move_is_said_to_leave_no_freedom():
    """Two bars and the base make a triangle, which nothing moves."""
    model = Model()
    model.rod("a", (0, 0, 0), (1, 1, 0))
    model.rod("b", (1, 1, 0), (3, 0, 0))
    for name, a, b, point in (
        ("j0", "base", "a", (0, 0, 0)),
        ("j1", "a", "b", (1, 1, 0)),
        ("j2", "base", "b", (3, 0, 0)),
    ):
        model.joint(name, a, b, point=point)
    for initial in ({"j0": (0.0, 1.0)}, {"j0": (0.3, 0.0)}):
        run = simulate_system(model.system(), Course(1.0, 0.1, DOWN), initial=initial)
        assert run.status == "refused"
        assert len(run.failures) == 1


def hung(*drives):
    model = Model()
    model.rod("a", (0, 0, 0), (1, 0, 0))
    model.joint("hinge", "base", "a")
    for drive in drives:
        model.on("hinge", drive)
    return model


def test_a_law_that_is_not_a_number_is_refused_by_name():
    run = simulate_system(hung(EffortDrive("d", "d", Constant(np.nan))).system(), Course(1.0, 0.1, DOWN))
    assert run.status == "refused"
    assert [subject for subject, _ in run.failures] == ["d"]


def test_an_effort_that_overflows_ends_the_run_and_is_said_to_be_the_cause():
    run = simulate_system(hung(EffortDrive("d", "d", Constant(1e308))).system(), Course(1.0, 0.1, DOWN))
    assert run.status in ("refused", "stopped")
    assert run.reason


def test_an_undamped_spring_too_stiff_to_follow_ends_the_run_within_its_budget():
    model = hung()
    model.add(SpringDamper("s", "s", (0, 0.5, 0), (1, 0, 0), 1e14, 0.0, 0.1), a="body base", b="body a")
    run = simulate_system(model.system(), Course(10.0, 1.0, DOWN), settings=SolverSettings(steps=3000))
    assert run.status == "stopped"
