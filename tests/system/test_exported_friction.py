"""Friction of a given effort goes to formats that have a number for it, and brakes there as here; the rest is named."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from support.devices import Z, device, drive, initial, joint
from support.export_models import block, design
from support.other_programs import loaded

from kinform.exports import export


def _wheel(**friction):
    joints = [joint("base", "one", "revolute", Z, (0, 0, 0))]
    drives = [drive("base~one", "friction", **friction)]
    start = (initial("base~one", 0.0, 200.0),)
    return design(device([block("one", (0.1, 0, 0))], joints, drives=drives, initial=start, duration=0.4, step=0.1))


@pytest.mark.parametrize(
    ("format", "file", "path", "read"),
    [
        ("urdf", "device.urdf", "joint/dynamics", lambda node: node.get("friction")),
        ("sdf", "model.sdf", ".//dynamics/friction", lambda node: node.text),
        ("mjcf", "device.xml", ".//joint[@frictionloss]", lambda node: node.get("frictionloss")),
    ],
)
def test_an_effort_without_load_is_a_number_of_the_format(format, file, path, read):
    made = export(_wheel(effort=0.125), format)
    (text,) = (data for name, data in made.files.items() if name.endswith(file.rsplit(".", 1)[1]) and b"joint" in data)
    assert float(read(ElementTree.fromstring(text).find(path))) == 0.125
    wheel = made.lost
    greater = export(_wheel(effort=0.125, static_effort=0.25), format)
    assert len(greater.lost) == len(wheel) + 1 and any("0.25" in sentence for sentence in greater.lost)


@pytest.mark.parametrize("format", ["urdf", "sdf", "mjcf", "modelica", "vhdl-ams"])
def test_friction_by_load_is_named(format):
    made = export(_wheel(coefficient=0.1, radius=0.01), format)
    assert made.lost


@pytest.mark.parametrize("format", ["modelica", "vhdl-ams"])
def test_equations_name_what_they_are_without(format):
    assert any("0.125" in sentence for sentence in export(_wheel(effort=0.125), format).lost)


def test_mujoco_brakes_alike(tmp_path):
    found = _wheel(effort=0.125)
    mujoco, model, data = loaded(found, tmp_path)
    run = found.simulation
    while data.time < run.time[-1] - 1e-9:
        mujoco.mj_step(model, data)
    assert run.joint_velocity[-1, 0] > 0.5
    np.testing.assert_allclose(abs(data.qvel[0]), run.joint_velocity[-1, 0], rtol=2e-3)
