"""The kernel gives the same whether compiled or not, and short runs need no compiler."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from portmodels import DOWN, bricard, four_bars

from kinform.simulation import Course, SolverSettings, integrate, simulate_system
from kinform.simulation.engine import Engine

SHORT = """
import sys
sys.path.insert(0, {tests!r})
from portmodels import DOWN, pendulum
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
