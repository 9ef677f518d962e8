"""SDF in Drake: places at random joint values, masses, and what it cannot carry."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.export_models import ALL, known, model_of, written
from support.other_programs import posed
from support.validators import package

from kinform.exports import export


@pytest.mark.parametrize("name", sorted(ALL))
def test_drake_finds_our_places_and_masses(name, tmp_path):
    plants = package("pydrake.multibody.plant")
    from pydrake.multibody.parsing import Parser

    found = known(name)
    path, _ = written(found, "sdf", tmp_path)
    plant = plants.MultibodyPlant(0.0)
    Parser(plant).AddModels(str(path))
    plant.Finalize()
    context = plant.CreateDefaultContext()
    for seed in range(3):
        values, ours = posed(model_of(found), seed)
        plant.SetPositions(context, positions(plant, values))
        for body, X_WB in ours.items():
            theirs = plant.GetBodyByName(body).EvalPoseInWorld(context).GetAsMatrix4()
            np.testing.assert_allclose(theirs, X_WB, atol=1e-9, err_msg=body)
    for body in found.mass.bodies:
        if body.mass is not None:
            inertia = plant.GetBodyByName(body.name).default_spatial_inertia()
            assert inertia.get_mass() == pytest.approx(body.mass, abs=1e-9)
            at_centre = inertia.Shift(inertia.get_com()).CalcRotationalInertia().CopyToFullMatrix3()
            np.testing.assert_allclose(at_centre, body.inertia, atol=1e-9)


@pytest.mark.parametrize(("name", "driven"), [("seeker", {"base~outer", "inner~outer"}), ("gimbal", set())])
def test_drake_drives_the_joints_that_are_driven(name, driven, tmp_path):
    plants = package("pydrake.multibody.plant")
    from pydrake.multibody.parsing import Parser

    path, _ = written(known(name), "sdf", tmp_path)
    plant = plants.MultibodyPlant(0.0)
    Parser(plant).AddModels(str(path))
    plant.Finalize()
    assert {plant.get_joint_actuator(k).joint().name() for k in plant.GetJointActuatorIndices()} == driven


def positions(plant, values):
    """Drake's positions: balls by roll, pitch and yaw, universal joints by both angles, in the order of the tree."""
    out = np.zeros(plant.num_positions())
    for index in plant.GetJointIndices():
        joint = plant.get_joint(index)
        name, start = joint.name(), joint.position_start()
        if name in values:
            out[start] = values[name]
        elif joint.num_positions() == 3:
            angles = [values[f"{name}.{axis}"] for axis in "xyz"]
            out[start : start + 3] = Rotation.from_euler("XYZ", angles).as_euler("xyz")
        elif joint.num_positions() == 2:
            out[start : start + 2] = [value for key, value in values.items() if key.startswith(f"{name}.")]
    return out


@pytest.mark.parametrize("name", ALL)
def test_every_link_has_one_parent(name):
    root = ElementTree.fromstring(export(known(name), "sdf").files["device.sdf"])
    children = [node.findtext("child") for node in root.iter("joint")]
    assert len(children) == len(set(children)) == len(list(root.iter("link")))


def test_springs_and_dampers_are_carried_and_loops_named():
    made = export(known("passive_seeker"), "sdf")
    root = ElementTree.fromstring(made.files["device.sdf"])
    (dynamics,) = root.iter("dynamics")
    assert float(dynamics.findtext("spring_stiffness")) == 3.0
    assert float(dynamics.findtext("spring_reference")) == pytest.approx(np.radians(20.0), rel=1e-15)
    assert float(dynamics.findtext("damping")) == 0.1
    made = export(known("four_bar"), "sdf")
    assert "coupler~rocker" in [text.partition(":")[0] for text in made.lost]
    assert b"not carried: coupler~rocker" in made.files["device.sdf"]
