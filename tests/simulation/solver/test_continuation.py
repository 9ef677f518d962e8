"""A crank that cannot pass: where the driven joint has come as far as the loops let it, that is said."""

from __future__ import annotations

import numpy as np
import pytest
from support.devices import Z, device, drive, joint, rod

from kinform.model.function import Law
from kinform.simulation import simulate

START = np.radians(40.0)


def four_bar(crank, *, rate, duration, level):
    """A four-bar on a ground of 0.1 m, with a coupler of 0.05 and a rocker of 0.07 m, its crank at 40°."""
    tip = crank * np.array([np.cos(START), np.sin(START), 0.0])
    foot = np.array([0.1, 0.0, 0.0])
    across = foot - tip
    far = float(np.linalg.norm(across))
    along = (far**2 + 0.05**2 - 0.07**2) / (2.0 * far)
    side = np.sqrt(0.05**2 - along**2) * np.array([-across[1], across[0], 0.0]) / far
    knee = tip + along * across / far + side
    parts = [rod("crank", (0, 0, 0), tip, 0.1), rod("coupler", tip, knee, 0.1), rod("rocker", foot, knee, 0.1)]
    joints = [
        joint("base", "crank", "revolute", Z, (0, 0, 0)),
        joint("base", "rocker", "revolute", Z, tuple(foot)),
        joint("crank", "coupler", "revolute", Z, tuple(tip)),
        joint("coupler", "rocker", "revolute", Z, tuple(knee)),
    ]
    drives = (drive("base~crank", "motion", Law("ramp", rate=rate)),)
    return simulate(*device(parts, joints, drives=drives, duration=duration, step=0.01), level=level)


@pytest.mark.parametrize("level", ["kinematic", "dynamic"])
@pytest.mark.parametrize("rate", [90.0, -90.0])
def test_a_crank_that_cannot_pass_comes_to_a_limit_position(level, rate):
    """Coupler and rocker in one line are 0.12 m long: 0.06² + 0.1² − 2 · 0.06 · 0.1 cos θ = 0.12²."""
    run = four_bar(0.06, rate=rate, duration=3.0, level=level)
    assert run.status == "stopped"
    assert "base~crank" in run.reason
    end = np.arccos((0.06**2 + 0.1**2 - 0.12**2) / (2 * 0.06 * 0.1))
    way = end - START if rate > 0 else START + end  # the other way round it is the mirror image of that
    assert float(run.time[-1]) == pytest.approx(way / np.radians(90.0), abs=0.011)


@pytest.mark.parametrize("level", ["kinematic", "dynamic"])
def test_a_crank_that_passes_has_no_limit(level):
    run = four_bar(0.015, rate=360.0, duration=1.0, level=level)
    assert (run.status, run.reason) == ("done", "")
