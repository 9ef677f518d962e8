"""Initial velocities that nothing states, of joints that share one turn, and what a table's spline leaves."""

from __future__ import annotations

import numpy as np
import pytest

from kinform.behaviour import Constant, Model, Ramp
from kinform.simulation import Course, simulate_system

Z = (0.0, 0.0, 1.0)
RATE = 1.5


def pinned(signal):
    """An arm that is driven about z, and on the same axis a loose pin between the ground and the arm."""
    model = Model()
    model.ground("base")
    model.body("arm", 1.0, (0.3, 0, 0), (1e-2, 2e-2, 3e-2))
    model.body("pin", 0.1, (0, 0, 0), (1e-4, 1e-4, 1e-4))
    model.joint("swing", "base", "arm", axis=Z, point=(0, 0, 0))
    model.joint("below", "base", "pin", axis=Z, point=(0, 0, 0))
    model.joint("above", "arm", "pin", axis=Z, point=(0, 0, 0))
    model.motion("drive", "swing", signal)
    return model.system("pinned")


def ran(signal, **options):
    run = simulate_system(pinned(signal), Course(0.2, 0.02), **options)
    assert run.status == "done", run.failures
    return run


def told(run):
    """Notes about the joints of the pin."""
    return [text for text in run.assumptions if "below" in text or "above" in text]


def test_a_loose_pin_whose_turn_nothing_decides_is_named():
    run = ran(Ramp(0.0, RATE))
    (text,) = told(run)
    assert {name for name in ("below", "above", "swing") if name in text} == {"below", "above"}


@pytest.mark.parametrize(("stated", "rates"), [("below", (0.0, -RATE)), ("above", (RATE, 0.0))])
def test_a_loose_pin_that_is_stated_to_be_at_rest_is_at_rest(stated, rates):
    run = ran(Ramp(0.0, RATE), initial={stated: (0.0, 0.0)})
    names = run.joint_names
    found = [run.joint_velocity[:, names.index(name)] for name in ("below", "above")]
    for values, rate in zip(found, rates, strict=True):
        np.testing.assert_allclose(values, rate, atol=1e-9)
    assert not told(run)


def test_a_loose_pin_rests_where_nothing_moves():
    np.testing.assert_allclose(ran(Constant(0.0)).joint_velocity, 0.0, atol=1e-12)


def test_a_rest_that_the_loops_do_not_allow_gives_way_to_what_is_driven():
    """The arm's own joint is prescribed; both others at rest would hold it."""
    run = ran(Ramp(0.0, RATE), initial={"below": (0.0, 0.0), "above": (0.0, 0.0)})
    np.testing.assert_allclose(run.joint_velocity[:, run.joint_names.index("swing")], RATE, atol=1e-9)
