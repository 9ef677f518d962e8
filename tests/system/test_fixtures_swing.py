"""Mechanisms from meshes, left to themselves: their loops stay closed, or the run does not claim to be done."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.dynamics import moved
from support.places import FIXTURES

from kinform.model.function import SimulationRequest
from kinform.simulation import SolverSettings, simulate

GENERAL = {"ball_bearing", "geneva_driven"}
"""With contacts that are no joint of a port model."""
SINGULAR = {"parallelogram_flat", "shaky_truss"}
"""Written in a pose where their loops branch, or hold only to first order."""
PROPORTIONED = ("bennett", "bricard_rectangular")
"""Movable by proportions that the coordinates of a mesh file hold only to their rounding."""
NAMES = sorted(path.parent.name for path in FIXTURES.glob("mechanisms/*/truth.json"))


@pytest.fixture(scope="module")
def swung(derive_design):
    """A fixture under a slanted gravity, without drives."""
    known = {}

    def swing(name):
        if name not in known:
            found = derive_design(FIXTURES / "mechanisms" / name / f"{name}.toml")
            request = SimulationRequest(gravity=np.array([3.0, -2.0, -9.0]), duration=0.12, step=0.02)
            function = replace(found.assembly.function, drives=())
            assembly = replace(found.assembly, simulation=request, function=function)
            known[name] = moved(replace(found, assembly=assembly), "dynamic").simulation
        return known[name]

    return swing


@pytest.mark.parametrize("name", NAMES)
def test_no_run_is_done_whose_loops_open(name, swung):
    run = swung(name)
    if run.status == "done":
        assert run.residual.max() < 1e-10


@pytest.mark.parametrize("name", PROPORTIONED)
def test_loops_that_move_by_their_proportions_stay_closed_for_long(name, derive_design):
    """Roundings of 1e-8 open the Bennett linkage of the meshes by 2e-6 where its links fold."""
    found = derive_design(FIXTURES / "mechanisms" / name / f"{name}.toml")
    request = SimulationRequest(gravity=np.array([3.0, -2.0, -9.0]), duration=2.0, step=0.02)
    assembly = replace(found.assembly, simulation=request, function=replace(found.assembly.function, drives=()))
    run = simulate(assembly, found.kinematics, found.mass, level="dynamic")
    assert run.status == "done"
    assert run.residual.max() < 1e-10
    total = run.energy @ np.array([1.0, 1.0, -1.0])
    assert np.abs(total - total[0]).max() < 1e-7 * np.ptp(run.energy[:, 0])


@pytest.mark.parametrize("name", sorted(set(NAMES) - GENERAL - SINGULAR))
def test_sound_mechanisms_run_to_the_end(name, swung):
    """Also those whose loops are redundant: a misfit of their meshes does not stop them."""
    run = swung(name)
    assert run.status == "done", run.reason
    assert run.time[-1] == pytest.approx(0.12)


@pytest.mark.parametrize("name", sorted(SINGULAR))
def test_singular_starts_are_refused_with_their_joints(name, swung):
    run = swung(name)
    assert run.status == "refused"
    ((joints, _),) = run.failures
    assert joints.count("~") >= 3


@pytest.mark.parametrize("name", sorted(GENERAL))
def test_contacts_that_are_no_joint_are_refused_by_name(name, swung):
    run = swung(name)
    assert run.status == "refused"
    assert "~" in run.failures[0][0]


def test_a_falling_platform_is_not_held_up_by_the_roundings_of_its_light_legs(derive_design):
    """Rods of 10⁻⁷ kg·m² on a platform metres away: the tolerances cannot be kept to the last digit, and twenty
    thousand steps would not do it. Energy and loops are as good as ever."""
    found = derive_design(FIXTURES / "mechanisms" / "stewart_platform" / "stewart_platform.toml")
    request = SimulationRequest(gravity=np.array([0.0, 0.0, -9.81]), duration=1.0, step=0.1)
    function = replace(found.assembly.function, drives=())
    assembly = replace(found.assembly, simulation=request, function=function)
    run = simulate(assembly, found.kinematics, found.mass, level="dynamic", settings=SolverSettings(steps=2000))
    assert run.status == "done", run.reason
    total = run.energy @ np.array([1.0, 1.0, -1.0])
    assert np.abs(total - total[0]).max() < 1e-9 * np.ptp(run.energy[:, 0])
    assert run.residual.max() < 1e-10
