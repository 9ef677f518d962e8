"""The kernel gives the same whether compiled or not, and short runs need no compiler."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from portmodels import DOWN, Model, bricard, four_bars

from kinform.behaviour import Constant, EffortDrive, SpringDamper
from kinform.simulation import Course, SolverSettings, integrate, simulate_system
from kinform.simulation.engine import Engine

SHORT = """
import sys
sys.path.insert(0, {tests!r})
from portmodels import DOWN, pendulum
from kinform.behaviour import Constant, EffortDrive, SpringDamper
from kinform.simulation import Course, simulate_system
print(simulate_system(pendulum().system(), Course(0.2, 0.1, DOWN)).status, "numba" in sys.modules)
"""


def test_a_short_run_does_not_import_numba():
    code = SHORT.format(tests=str(Path(__file__).parents[1]))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["done", "False"]


@pytest.mark.parametrize("make", [bricard, lambda: four_bars(1)])
def test_compiled_and_plain_functions_agree(make, monkeypatch):
    runs = []
    for plain, loaded in ((10**9, False), (0, True)):
        monkeypatch.setattr(integrate, "PLAIN", plain)
        monkeypatch.setattr(Engine, "loaded", loaded)
        runs.append(simulate_system(make().system(), Course(0.3, 0.1, DOWN)))
    for name in ("p_WB", "joint_velocity", "F_B"):
        np.testing.assert_allclose(getattr(runs[1], name), getattr(runs[0], name), atol=1e-11)


def test_an_impossible_run_ends_within_its_budget_and_says_when():
    run = simulate_system(
        four_bars(2).system(), Course(10.0, 0.5, DOWN), initial={"foot 0": (0.0, -1.0)},
        settings=SolverSettings(steps=40),
    )  # fmt: skip
    assert run.status == "stopped"
    assert "t = " in run.reason
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
    assert "singular" in run.reason
    assert all(joint.name in run.reason for joint in make().system().joints)


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
    assert "d: its law: level is not a finite number" in run.reason


def test_an_effort_that_overflows_ends_the_run_and_is_said_to_be_the_cause():
    run = simulate_system(hung(EffortDrive("d", "d", Constant(1e308))).system(), Course(1.0, 0.1, DOWN))
    assert run.status in ("refused", "stopped")
    assert "not a number" in run.reason or "not numbers" in run.reason


def test_an_undamped_spring_too_stiff_to_follow_ends_the_run_within_its_budget():
    model = hung()
    model.add(SpringDamper("s", "s", (0, 0.5, 0), (1, 0, 0), 1e14, 0.0, 0.1), a="body base", b="body a")
    run = simulate_system(model.system(), Course(10.0, 1.0, DOWN), settings=SolverSettings(steps=3000))
    assert run.status == "stopped"
    assert "t = " in run.reason
    assert "no mass" not in run.reason
