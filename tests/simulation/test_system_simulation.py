"""The output of a run is counted before it is begun, and refused above a limit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from support.devices import Z, device, drive, joint, rod, sine
from support.port_models import pendulum

from kinform.simulation import Course, simulate, simulate_system, system_simulation


def numbers_of(run):
    """Numbers that a run has at its output times."""
    values = (getattr(run, field.name) for field in dataclasses.fields(run))
    return sum(value.size for value in values if isinstance(value, np.ndarray) and len(value) == len(run.time))


@pytest.mark.parametrize("level", ["kinematic", "dynamic"])
def test_what_is_counted_is_what_comes(monkeypatch, level):
    parts = [rod("a_first", (0, 0, 0), (1, 0, 0)), rod("b_second", (1, 0, 0), (1, 1, 0))]
    joints = [
        joint("a_first", "base", "revolute", Z, (0, 0, 0)),
        joint("a_first", "b_second", "revolute", Z, (1, 0, 0)),
    ]
    drives = [drive("a_first~base", "motion", sine(10, 1))]
    made = device(parts, joints, drives=drives, duration=0.2, step=0.001)
    whole = simulate(*made, level=level)
    assert whole.status == "done"
    count = numbers_of(whole)
    monkeypatch.setattr(system_simulation, "OUTPUT_NUMBERS", 1.25 * count)
    assert simulate(*made, level=level).status == "done"
    monkeypatch.setattr(system_simulation, "OUTPUT_NUMBERS", 0.95 * count)
    refused = simulate(*made, level=level)
    assert refused.status == "refused"
    assert [subject for subject, _ in refused.failures] == ["[simulation]"]
    assert len(refused.time) == 0


@pytest.mark.parametrize("duration, step", [(1e300, 1e-300), (1e9, 1e-3), (1.0, 5e-324)])
def test_times_without_end_are_refused_at_once(duration, step):
    run = simulate_system(pendulum().system(), Course(duration, step))
    assert run.status == "refused"
    assert [subject for subject, _ in run.failures] == ["[simulation]"]
