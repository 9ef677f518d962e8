"""Which level a simulation runs at, what it refuses, and what it says that it assumed."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.devices import (
    Z,
    assembly,
    body,
    device,
    drive,
    initial,
    intended,
    joint,
    kinematics,
    rod,
    sine,
    without_mass,
)

from kinform.kinematics import functional
from kinform.mass import compile_mass
from kinform.model.assembly import Mesh, MeshHealth
from kinform.model.function import Coupling, Function, Law, Load, SimulationRequest
from kinform.model.kinematics import Body
from kinform.simulation import simulate

HEALTH = MeshHealth(1, 3, True, True, "NoError", 1.0, 0, 0, 0, 0, 1, 0.0)


@cache
def mesh_of_one_facet():
    return Mesh(np.eye(3), np.array([[0, 1, 2]]), HEALTH, "m.stl", None, "mesh")


def hinge(**request):
    """One rod on one hinge."""
    arm = rod("arm", (0, 0, 0), (1, 0, 0))
    return device([arm], [joint("arm", "base", "revolute", Z, (0, 0, 0))], **request)


def meshed(made, chain, mass):
    """The same device with a mesh on every part."""
    return replace(made, parts=tuple(replace(p, mesh=mesh_of_one_facet()) for p in made.parts)), chain, mass


def massless(made, chain, mass):
    bare = without_mass(made)
    return bare, chain, compile_mass(bare, chain)


def test_without_simulation_and_drives_nothing_is_requested():
    made, chain, mass = hinge()
    made = replace(made, simulation=None)
    run = simulate(made, chain, mass)
    assert (run.status, run.level) == ("not requested", "")
    assert run.time.shape == (0,)
    assert simulate(made, chain, mass, level="dynamic").status == "done"


def test_a_drive_alone_requests_a_simulation_and_the_defaults_are_listed():
    made, chain, mass = hinge(drives=[drive("arm~base", "motion", sine(10, 1))])
    run = simulate(replace(made, simulation=None), chain, mass)
    assert run.status == "done"
    assert run.time[-1] == 1.0
    assert run.assumptions


def test_with_all_masses_known_the_level_is_dynamic():
    assert simulate(*meshed(*hinge(duration=0.1))).level == "dynamic"


def test_without_masses_it_is_kinematic_and_says_why():
    run = simulate(*meshed(*massless(*hinge(duration=0.1))))
    assert (run.status, run.level) == ("done", "kinematic")
    assert [subject for subject, _ in run.not_dynamic] == ["arm"]
    assert np.isnan(run.joint_effort).all()
    assert np.isnan(run.energy).all()


def test_without_meshes_and_masses_it_is_functional():
    assert simulate(*massless(*hinge(duration=0.1))).level == "functional"


@pytest.mark.parametrize("level", ["functional", "kinematic", "dynamic"])
def test_a_level_can_be_forced_by_argument_and_by_manifest(level):
    wanted = [intended("swing", "arm", "base", "revolute", Z, (0, 0, 0))]
    made = meshed(*hinge(duration=0.1, intended=wanted))
    assert simulate(*made, level=level).level == level
    assert simulate(*meshed(*hinge(duration=0.1, intended=wanted, level=level))).level == level
    assert simulate(*massless(*made), level="kinematic").not_dynamic == ()


def test_an_unknown_level_is_an_error():
    with pytest.raises(ValueError, match='"quantum"'):
        simulate(*hinge(), level="quantum")


def test_forcing_dynamics_without_mass_is_refused_with_the_body():
    run = simulate(*massless(*hinge(duration=0.1)), level="dynamic")
    assert run.status == "refused"
    assert [subject for subject, _ in run.failures] == ["arm"]


def test_the_mass_of_what_is_fixed_to_the_ground_does_not_matter():
    parts = [rod("arm", (0, 0, 0), (1, 0, 0)), body("stand", mass=None)]
    joints = [joint("arm", "stand", "revolute", Z, (0, 0, 0)), joint("base", "stand", "fixed")]
    run = simulate(*device(parts, joints, duration=0.1), level="dynamic")
    assert run.status == "done"


@pytest.mark.parametrize(
    "bad",
    [
        joint("arm", "base", "revolute", Z, (0, 0, 0), status="ambiguous"),
        joint("arm", "base", "general", freedoms=2),
        joint("arm", "base", "revolute", Z, None),
        joint("arm", "base", "screw", Z, (0, 0, 0)),
    ],
)
def test_joints_that_are_not_settled_are_refused_by_name(bad):
    made, _, mass = hinge(duration=0.1)
    run = simulate(made, kinematics(made.parts, [bad]), mass)
    assert run.status == "refused"
    assert run.failures[0][0] == "arm~base"


def test_a_pair_that_constrains_nothing_is_left_out():
    parts = [rod("arm", (0, 0, 0), (1, 0, 0)), rod("tip", (1, 0, 0), (2, 0, 0))]
    joints = [
        joint("arm", "base", "revolute", Z, (0, 0, 0)),
        joint("arm", "tip", "revolute", Z, (1, 0, 0)),
        joint("base", "tip", "general", freedoms=6),
    ]
    run = simulate(*device(parts, joints, duration=0.1))
    assert run.status == "done"
    assert run.joint_names == ("arm~base", "arm~tip")


@pytest.mark.parametrize("status", ["blocked", "inferred"])
def test_joints_taken_for_granted_are_listed(status):
    made, _, mass = hinge(duration=0.1)
    settled = joint("arm", "base", "revolute", Z, (0, 0, 0), status=status)
    run = simulate(made, kinematics(made.parts, [settled]), mass)
    assert run.status == "done"
    assert any("arm~base" in note for note in run.assumptions)


def test_a_body_that_nothing_connects_stays_in_kinematics_and_is_refused_in_dynamics():
    parts = [rod("arm", (0, 0, 0), (1, 0, 0)), body("loose")]
    joints = [joint("arm", "base", "revolute", Z, (0, 0, 0))]
    made = meshed(*device(parts, joints, duration=0.1))
    free = simulate(*made)
    assert (free.status, free.level) == ("done", "kinematic")
    assert any("loose" in note for note in free.assumptions)
    assert np.all(free.p_WB[:, free.body_names.index("loose")] == 0.0)
    forced = simulate(*made, level="dynamic")
    assert forced.status == "refused"
    assert forced.failures[0][0] == "loose"


@pytest.mark.parametrize(
    ("acting", "subject"),
    [
        (drive("elbow", "motion", sine(1, 1)), "elbow"),
        (drive("ball~base", "motion", sine(1, 1)), "ball~base"),
        (drive("arm~base", "motion"), "arm~base"),
        (drive("arm~base", "motion", sine(np.nan, 1)), "arm~base"),
        (drive("arm~base", "motion", Law("table", times=(1.0, 1.0), values=(0.0, 1.0))), "arm~base"),
    ],
)
def test_drives_that_cannot_be_are_failures_not_crashes(acting, subject):
    parts = [rod("arm", (0, 0, 0), (1, 0, 0)), body("ball", 1.0, (0, 0, 1), [1, 1, 1])]
    joints = [joint("arm", "base", "revolute", Z, (0, 0, 0)), joint("ball", "base", "spherical", None, (0, 0, 1))]
    run = simulate(*device(parts, joints, drives=[acting], duration=0.1))
    assert run.status == "refused"
    assert run.failures[0][0] == subject


def test_two_motions_of_one_joint_are_a_failure():
    drives = [drive("arm~base", "motion", sine(1, 1)), drive("arm~base", "motion", sine(2, 1))]
    run = simulate(*hinge(drives=drives))
    assert [subject for subject, _ in run.failures] == ["arm~base"]


@pytest.mark.parametrize("kind", ["servo", "dc_motor"])
def test_drives_that_are_not_modelled_keep_a_run_from_being_dynamic(kind):
    made = meshed(*hinge(drives=[drive("arm~base", kind, sine(1, 1))], duration=0.1))
    assert simulate(*made, level="dynamic").status == "refused"
    run = simulate(*made)
    assert run.level == "kinematic"
    assert any(kind in why for _, why in run.not_dynamic)


def test_forces_play_no_part_below_dynamics_and_the_run_says_so():
    push = Load("arm", np.array([0, 1.0, 0]), None, None, "world", "device.toml", 1)
    made = hinge(drives=[drive("arm~base", "effort", Law("constant", value=1.0))], loads=[push], duration=0.1)
    run = simulate(*meshed(*made), level="kinematic")
    assert any("effort on arm~base" in note and "load on arm" in note for note in run.assumptions)
    assert np.all(run.joint_position == 0.0)


@pytest.mark.parametrize(("joint_name", "value"), [("elbow", 1), ("arm~base", np.inf)])
def test_initial_values_without_a_freedom_are_failures(joint_name, value):
    run = simulate(*hinge(initial=(initial(joint_name, value),)))
    assert run.status == "refused"
    assert run.failures[0][0] == joint_name


def test_initial_values_follow_the_designers_order_and_sense():
    wanted = [intended("swing", "base", "arm", "revolute", (0, 0, 1), (0, 0, 0))]
    start = (initial("swing", 20.0, 30.0),)
    run = simulate(*hinge(intended=wanted, initial=start, duration=0.01, gravity=np.zeros(3)))
    # kinform counts base relative to arm: both values change their sign.
    assert run.joint_position[0, 0] == pytest.approx(-np.radians(20.0), abs=1e-15)
    assert run.joint_velocity[0, 0] == pytest.approx(-np.radians(30.0), abs=1e-15)
    half = np.radians(10.0)
    arm = run.q_WB[0, run.body_names.index("arm")]
    np.testing.assert_allclose(arm, [np.cos(half), 0, 0, np.sin(half)], atol=1e-15)


def test_a_motion_law_goes_before_an_initial_value_and_the_run_says_so():
    drives = [drive("arm~base", "motion", sine(10, 1, offset=5))]
    run = simulate(*hinge(drives=drives, initial=(initial("arm~base", 20.0),), duration=0.1))
    assert run.joint_position[0, 0] == pytest.approx(np.radians(5.0))


def test_the_grid_ends_at_the_duration_also_when_the_step_does_not_divide_it():
    even = simulate(*hinge(duration=0.1, step=0.025)).time
    np.testing.assert_allclose(even, [0.0, 0.025, 0.05, 0.075, 0.1], rtol=1e-15)
    assert even[-1] == 0.1
    np.testing.assert_allclose(simulate(*hinge(duration=0.1, step=0.04)).time, [0.0, 0.04, 0.08, 0.1])


def test_undriven_joints_rest_where_they_start_in_kinematics():
    parts = [rod("arm", (0, 0, 0), (1, 0, 0)), rod("tip", (1, 0, 0), (2, 0, 0))]
    joints = [joint("arm", "base", "revolute", Z, (0, 0, 0)), joint("arm", "tip", "revolute", Z, (1, 0, 0))]
    drives = [drive("arm~base", "motion", Law("ramp", rate=90.0))]
    made = device(parts, joints, drives=drives, initial=(initial("arm~tip", 30.0),), duration=1.0, step=0.5)
    run = simulate(*made, level="kinematic")
    np.testing.assert_allclose(np.degrees(run.joint_position), [[0, 30], [45, 30], [90, 30]], atol=1e-12)
    np.testing.assert_allclose(np.degrees(run.joint_velocity), [[90, 0]] * 3, atol=1e-12)
    assert any("arm~tip" in note for note in run.assumptions)


def test_the_progress_counts_output_times():
    calls = []
    simulate(*hinge(duration=0.1, step=0.02), progress=lambda done, total: calls.append((done, total)))
    assert calls[-1] == (6, 6)


def test_a_free_motion_without_mass_is_refused_by_the_joint():
    point = body("bob", 1.0, (1, 0, 0))
    run = simulate(*device([point], [joint("base", "bob", "spherical", None, (0, 0, 0))], duration=0.1))
    assert run.status == "refused"
    assert run.failures[0][0] == "base~bob"


def test_a_stiff_model_ends_with_a_reason_instead_of_running_for_ever():
    from kinform.simulation import SolverSettings

    drives = [drive("arm~base", "damper", damping=1e7)]
    made = hinge(drives=drives, initial=(initial("arm~base", 0, 10),), duration=1.0)
    run = simulate(*made, settings=SolverSettings(steps=50))
    assert run.status == "stopped"
    assert len(run.time) < 101


def test_no_ground_is_refused():
    made, chain, mass = hinge()
    bodies = tuple(Body(b.name, b.parts, False) for b in chain.bodies)
    assert simulate(made, replace(chain, bodies=bodies), mass).status == "refused"


def functional_device(**request):
    """Two wheels on a base, geared to each other: nothing but function."""
    joints = (
        intended("in", "base", "pinion", "revolute", Z, (0, 0, 0)),
        intended("out", "wheel", "base", "revolute", Z, (1, 0, 0)),
    )
    couplings = (Coupling(("out", "in"), -0.5, "device.toml", 1),)
    drives = (drive("in", "motion", Law("ramp", rate=90.0)),)
    parts = [body(name, mass=None) for name in ("base", "pinion", "wheel")]
    function = Function(joints=joints, couplings=couplings, drives=drives)
    made = assembly(parts, function, SimulationRequest(duration=1.0, step=0.5, **request))
    chain = functional(made)
    return made, chain, compile_mass(made, chain)


def test_the_function_alone_is_simulated_with_its_couplings():
    run = simulate(*functional_device())
    assert (run.status, run.level) == ("done", "functional")
    # The designer's value of `out` counts the base relative to the wheel, as `in` the pinion to the base.
    names = dict(zip(run.joint_names, run.joint_position[-1], strict=True))
    assert names["base~pinion"] == pytest.approx(np.pi / 2)
    assert names["base~wheel"] == pytest.approx(np.pi / 4)


def test_couplings_are_imposed_where_geometry_gives_no_ratio_and_the_run_says_so():
    made, chain, mass = functional_device()
    run = simulate(*meshed(made, chain, mass), level="kinematic")
    assert run.joint_position[-1, run.joint_names.index("base~wheel")] == pytest.approx(np.pi / 4)
    assert any("out and in" in note for note in run.assumptions)


def test_without_joints_and_meshes_there_is_nothing_to_simulate():
    made = assembly([body("base", mass=None), body("part", mass=None)])
    chain = kinematics(made.parts, [])
    assert simulate(made, chain, compile_mass(made, chain)).status == "refused"


def test_importing_the_simulation_imports_neither_numba_nor_scipy():
    code = "import sys, kinform.simulation as s; print(sorted({'numba', 'scipy'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_running_twice_gives_the_same_bits():
    first, second = (simulate(*hinge(duration=0.5)) for _ in range(2))
    for name in ("p_WB", "q_WB", "joint_position", "joint_velocity", "joint_effort", "energy"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes()
