"""Gears from meshes in models for other tools: solved there, they turn as in our run."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.other_programs import analysed, solved
from support.places import FIXTURES

from kinform import stages
from kinform.exports import export
from kinform.exports.port_model import read, write
from kinform.model.function import SimulationRequest


@pytest.fixture(scope="module", params=["gear_pair", "rack_and_pinion"])
def geared(request, derive_design):
    name = request.param
    found = derive_design(FIXTURES / "mechanisms" / name / f"{name}.toml")
    asked = SimulationRequest(gravity=np.array([-9.81, 1.0, 0.0]), duration=0.1, step=0.02)
    return stages.simulate(replace(found, assembly=replace(found.assembly, simulation=asked)), level="dynamic")


def test_rumoca_turns_them_as_we_do(geared, tmp_path):
    p, q = solved(geared, tmp_path)
    run = geared.simulation
    np.testing.assert_allclose(p, run.p_WB, atol=1e-8)
    assert np.abs(np.abs(np.einsum("tbi,tbi->tb", q, run.q_WB)) - 1.0).max() < 1e-8


def test_ghdl_reads_them(geared, tmp_path):
    ran = analysed(export(geared, "vhdl-ams"), tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")


def test_the_teeth_survive_in_the_port_model(geared):
    (data,) = export(geared, "json").files.values()
    system = read(data)
    (gear,), (own,) = system.gears, geared.behaviour.system.gears
    assert (gear.ratio, gear.lower, gear.upper) == (own.ratio, own.lower, own.upper)
    for field in ("pitch_point", "flank", "back"):
        np.testing.assert_array_equal(getattr(gear, field), getattr(own, field))
    assert read(write(system, "again")).gears[0].ratio == gear.ratio


@pytest.mark.parametrize("format", ["vhdl-ams", "modelica", "mjcf", "urdf", "sdf"])
def test_what_the_teeth_push_is_said_to_be_left_out(geared, format):
    said = [text for text in export(geared, format).remarks if "what its teeth push on the bearings" in text]
    assert len(said) == 1
