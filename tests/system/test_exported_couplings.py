"""Couplings of a design without geometry: each format that has them carries them."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import replace

import numpy as np
import pytest
from support.devices import HERE, Z, device, drive, intended, sine
from support.export_models import X, block, design, written
from support.other_programs import analysed, forward, numbers, opened, solved
from support.validators import package

from kinform.exports import export
from kinform.model.assembly import Subassembly
from kinform.model.function import Coupling


@pytest.fixture(scope="module")
def geared():
    """A rack that a pinion moves: value of the rack = 0.02 times that of the pinion, the designer's order mixed."""
    wanted = [
        intended("pinion", "base", "wheel", "revolute", Z, (0, 0, 0)),
        intended("rack", "slide", "base", "prismatic", X, (0, 0.1, 0)),
    ]
    parts = [block("wheel", (0.1, 0, 0)), block("slide", (0.3, 0.1, 0))]
    made = device(
        parts, [], intended=wanted, couplings=[Coupling(("rack", "pinion"), 0.02, "device.toml", 1)],
        drives=[drive("pinion", "motion", sine(90, 1))], level="functional", duration=0.5, step=0.05,
    )  # fmt: skip
    found = design(made)
    assert (found.simulation.status, found.simulation.level) == ("done", "functional")
    assert {name.split("~")[0] for name in found.simulation.joint_names} == {"base"}
    return found


def ratio(found):
    """Value of the rack over that of the pinion in our run."""
    q = found.simulation.joint_position
    columns = dict(zip(found.simulation.joint_names, q.T, strict=True))
    k = int(np.abs(columns["base~wheel"]).argmax())
    return columns["base~slide"][k] / columns["base~wheel"][k]


def test_our_own_run_obeys_the_coupling(geared):
    assert ratio(geared) == pytest.approx(-0.02, rel=1e-9)


def test_urdf_mimics(geared):
    text = export(geared, "urdf").files["device.urdf"].decode()
    places = forward(text, {"base~wheel": 0.7})
    np.testing.assert_allclose(
        places["slide"][:3, 3] - forward(text, {})["slide"][:3, 3], 0.7 * ratio(geared) * np.array(X)
    )


def test_sdf_mimics(geared):
    (mimic,) = ElementTree.fromstring(export(geared, "sdf").files["device.sdf"]).iter("mimic")
    assert mimic.get("joint") == "base~wheel"
    assert float(mimic.findtext("multiplier")) == pytest.approx(ratio(geared))


def test_mjcf_couples(geared):
    (row,) = ElementTree.fromstring(export(geared, "mjcf").files["device.xml"]).iterfind("equality/joint")
    assert (row.get("joint1"), row.get("joint2")) == ("base~slide", "base~wheel")
    np.testing.assert_allclose(numbers(row.get("polycoef")), [0, ratio(geared), 0, 0, 0])


def test_mujoco_reads_the_coupling(geared, tmp_path):
    mujoco = package("mujoco")
    path, _ = written(geared, "mjcf", tmp_path)
    assert mujoco.MjModel.from_xml_path(str(path)).neq == 1


def test_rumoca_moves_the_rack_as_we_do(geared, tmp_path):
    p, _ = solved(geared, tmp_path)
    np.testing.assert_allclose(p, geared.simulation.p_WB, atol=1e-6)
    assert np.ptp(p, axis=0).max() > 0.01


def test_ghdl_reads_the_gear(geared, tmp_path):
    made = export(geared, "vhdl-ams")
    assert b"entity work.gear" in made.files["3_device.vhd"]
    ran = analysed(made, tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")


def test_a_gear_between_joints_of_different_sub_assemblies_is_in_the_one_around_both(tmp_path):
    """The value of the joint inside comes out of its entity, and the gear's effort goes in."""
    wanted = [
        intended("carry", "base", "arm/one", "revolute", Z, (0, 0, 0)),
        intended("inner", "arm/one", "arm/two", "revolute", Z, (0.1, 0, 0)),
        intended("rack", "slide", "base", "prismatic", X, (0, 0.1, 0)),
    ]
    parts = [block("arm/one", (0.1, 0, 0)), block("arm/two", (0.2, 0, 0)), block("slide", (0.3, 0.1, 0))]
    assembly, chain, mass = device(
        parts, [], intended=wanted, couplings=[Coupling(("rack", "inner"), 0.02, "device.toml", 1)],
        drives=[drive("inner", "motion", sine(90, 1))], level="functional", duration=0.5, step=0.05,
    )  # fmt: skip
    found = design((replace(assembly, subassemblies=(Subassembly("arm", "arm.toml", None, HERE),)), chain, mass))
    assert found.simulation.status == "done"
    made = export(found, "vhdl-ams")
    entities, flat, top = opened(made)
    assert "gear" in {kind for _, kind, _, _ in entities[top].parts}
    assert "gear" not in {kind for _, kind, _, _ in entities["arm"].parts}
    ((_, _, _, ports),) = (leaf for leaf in flat.leaves if leaf[1].name == "gear")
    joints = {path: own for path, entity, _, own in flat.leaves if entity.name in ("revolute_joint", "prismatic_joint")}
    values = {own.get("angle", own.get("distance")) for own in joints.values()}
    assert {ports["a_value"], ports["b_value"]} <= values
    ran = analysed(made, tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")


@pytest.fixture(scope="module")
def summed():
    """A differential: the crown has the mean of what its two half shafts have."""
    parts = [block(name, (x, 0.0, 0.0)) for name, x in (("crown", 0.0), ("left", -0.3), ("right", 0.3))]
    wanted = [intended(part.name, "base", part.name, "revolute", X, (0, 0, 0)) for part in parts]
    made = device(
        parts, [], intended=wanted, couplings=[Coupling(("crown", "left"), 0.5, "device.toml", 1, {"right": 0.5})],
        drives=[drive("left", "motion", sine(90, 1)), drive("right", "motion", sine(40, 2))],
        level="functional", duration=0.5, step=0.05,
    )  # fmt: skip
    found = design(made)
    assert (found.simulation.status, found.simulation.level) == ("done", "functional")
    q = dict(zip(found.simulation.joint_names, found.simulation.joint_position.T, strict=True))
    np.testing.assert_allclose(q["base~crown"], 0.5 * (q["base~left"] + q["base~right"]), atol=1e-9)
    return found


def test_rumoca_turns_the_crown_as_we_do(summed, tmp_path):
    _, q = solved(summed, tmp_path)
    np.testing.assert_allclose(q, summed.simulation.q_WB, atol=1e-6)


def test_ghdl_reads_the_train(summed, tmp_path):
    made = export(summed, "vhdl-ams")
    assert b"entity work.gear_3" in made.files["3_device.vhd"]
    ran = analysed(made, tmp_path)
    assert (ran.returncode, ran.stderr) == (0, "")
