"""Modelica compiled and solved by rumoca, an independent compiler and solver: its trajectory is ours."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from support.diagonal import first
from support.export_models import ALL, design, driven_four_bar, known, swinging
from support.other_programs import controlled_by_voltage, solved
from support.places import FIXTURES
from support.validators import package

from kinform.exports import export, write
from kinform.exports.equations import equations_of
from kinform.exports.model import export_model
from kinform.exports.modelica import writer as modelica
from kinform.simulation import Course, simulate_system


@pytest.mark.parametrize("name", ALL)
def test_rumoca_finds_our_trajectory(name, tmp_path):
    found = known(name)
    p, q = solved(found, tmp_path)
    run = found.simulation
    assert np.ptp(run.p_WB, axis=0).max() + np.ptp(run.q_WB, axis=0).max() > 0.05
    np.testing.assert_allclose(p, run.p_WB, atol=1e-6)
    sign = np.sign(np.einsum("tbi,tbi->tb", q, run.q_WB))
    np.testing.assert_allclose(q * sign[..., None], run.q_WB, atol=1e-6)


@pytest.mark.parametrize("name", first(2, ["four_bar", "stick_four_bar", "seeker_2dof", "slider_crank"]))
def test_rumoca_finds_the_trajectory_of_a_fixture(name, tmp_path, derive_design):
    (manifest,) = FIXTURES.glob(f"*/{name}/{name}.toml")
    found = derive_design(manifest)
    assert found.simulation.status == "done"
    p, q = solved(found, tmp_path)
    np.testing.assert_allclose(p, found.simulation.p_WB, atol=1e-6)
    sign = np.sign(np.einsum("tbi,tbi->tb", q, found.simulation.q_WB))
    np.testing.assert_allclose(q * sign[..., None], found.simulation.q_WB, atol=1e-6)


@pytest.mark.parametrize("name", first(2, ["screw_right", "four_bar", "spherical_open", "slider_crank", "bennett"]))
def test_rumoca_finds_how_a_fixture_swings(name, tmp_path, derive_design):
    """Dynamics of bodies whose masses are those of their meshes, without drives."""
    (manifest,) = FIXTURES.glob(f"*/{name}/{name}.toml")
    found = swinging(derive_design(manifest))
    assert found.simulation.status == "done"
    p, q = solved(found, tmp_path)
    np.testing.assert_allclose(p, found.simulation.p_WB, atol=1e-6)
    sign = np.sign(np.einsum("tbi,tbi->tb", q, found.simulation.q_WB))
    np.testing.assert_allclose(q * sign[..., None], found.simulation.q_WB, atol=1e-6)
    assert np.ptp(q, axis=0).max() > 0.02


def test_what_moves_in_a_run_without_forces_though_nothing_prescribes_it_is_named(derive_design):
    (manifest,) = FIXTURES.glob("broken/four_bar_missing_pin/four_bar_missing_pin.toml")
    found = derive_design(manifest)
    assert found.simulation.level == "kinematic"
    for format in ("modelica", "vhdl-ams"):
        lost = [text.partition(":")[0] for text in export(found, format).lost]
        assert lost.count("base~rocker_unit") == lost.count("coupler~crank_unit") == 1


@pytest.mark.parametrize(
    ("name", "told", "format"),
    [
        ("shaky_truss", True, "modelica"),
        ("four_bar", False, "vhdl-ams"),
        pytest.param("parallelogram_flat", True, "vhdl-ams", marks=pytest.mark.sweep),
        pytest.param("bennett", False, "modelica", marks=pytest.mark.sweep),
    ],
)
def test_a_start_in_a_singular_pose_is_named(format, name, told, derive_design):
    (manifest,) = FIXTURES.glob(f"mechanisms/{name}/{name}.toml")
    lost = export(swinging(derive_design(manifest)), format).lost
    assert bool(lost) == told


def test_rumoca_controls_the_voltage_of_a_motor_as_we_do(tmp_path):
    model = controlled_by_voltage()
    made = modelica.export(model)
    assert made.lost == ()
    write(made, tmp_path)
    solver = package("rumoca")
    loaded = solver.Session().load(str(tmp_path / "device.mo"), model="device.System")
    config = solver.SimConfig(solver="rk-like", rtol=1e-10, atol=1e-11)
    result = loaded.simulate((0, 0.2), dt=0.05, config=config)
    values = result.to_dict()
    values = values.get("data", values)
    ours = simulate_system(model.system, Course(0.2, 0.05, model.gravity))
    picked = [np.flatnonzero(np.isclose(result.time, t, rtol=0.0, atol=1e-9))[-1] for t in ours.time]
    theirs = np.asarray(values["joint_inner_outer.value"])[picked]
    np.testing.assert_allclose(theirs, ours.joint_position[:, ours.joint_names.index("inner~outer")], atol=1e-6)
    assert np.ptp(theirs) > 0.1


def test_a_run_without_forces_is_the_same_motion(tmp_path):
    found = design(driven_four_bar(level="kinematic"))
    assert found.simulation.level == "kinematic"
    p, _ = solved(found, tmp_path)
    np.testing.assert_allclose(p, found.simulation.p_WB, atol=1e-6)


def test_a_twin_with_another_mass_moves_otherwise(tmp_path):
    """The comparison can fail: the same export with one number changed."""
    found = known("passive_seeker")
    other = found.simulation
    bodies = tuple(replace(b, mass=1.1 * b.mass) if b.name == "inner" else b for b in found.mass.bodies)
    p, q = solved(replace(found, mass=replace(found.mass, bodies=bodies)), tmp_path)
    assert np.abs(p - other.p_WB).max() + np.abs(q - other.q_WB).max() > 1e-3


@pytest.mark.parametrize(("name", "rows"), [("four_bar", 3), ("slider_crank", 3), ("spatial_loop", 6)])
def test_as_many_rows_are_held_as_are_independent(name, rows):
    """A planar loop of journals has six conditions, three of them independent; a spatial one is not redundant."""
    model = export_model(known(name))
    found = equations_of(model)
    (closure,) = found.closures
    assert sum(closure.place) + sum(closure.turn) == rows
    assert len(found.free) == 1


def test_the_text_states_each_start_once(tmp_path):
    text = next(iter(export(known("gimbal"), "modelica").files.values())).decode()
    assert len(re.findall(r"Revolute \w+\(.*value\(start=.*fixed=true\)", text)) == 3
    start = re.search(r"joint_base_outer\(.*?value\(start=([^,]+),.*?rate\(start=([^,]+),", text)
    np.testing.assert_allclose([float(x) for x in start.groups()], np.radians([10, 40]), rtol=1e-15)
