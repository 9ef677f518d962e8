"""A driven parallelogram stays one through its flat poses, whatever its files' precision, size and place; where lengths
do not tell which way it goes, the run ends and says so."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.diagonal import first_rows
from support.places import FIXTURES

from kinform import form, stages

WILD = FIXTURES / "wild"


def values(design, name):
    run = design.simulation
    return run.joint_position[:, run.joint_offset[run.joint_names.index(name)]]


def test_single_and_double_precision_give_one_motion(derive_design):
    single, double = (
        derive_design(WILD / name / f"{name}.toml") for name in ("parallelogram_single", "parallelogram_double")
    )
    assert single.simulation.status == double.simulation.status == "done"
    assert single.simulation.joint_names == double.simulation.joint_names
    np.testing.assert_allclose(single.simulation.joint_position, double.simulation.joint_position, atol=1e-6)
    np.testing.assert_allclose(values(single, "base~rocker"), values(single, "base~crank"), atol=1e-9)
    assert values(single, "base~crank")[-1] == pytest.approx(2.0 * np.pi)


def test_what_was_moved_to_make_bars_equal_is_told(derive_design):
    name = "parallelogram_single"
    kinematics = derive_design(WILD / name / f"{name}.toml").kinematics
    assert {move.joint for move in kinematics.moves} == {joint.name for joint in kinematics.joints}
    assert 1e-13 < kinematics.misfit.distance < 1e-8
    place = {joint.name: joint.point[:2] for joint in kinematics.joints}
    crank = place["coupler~crank"] - place["base~crank"]
    rocker = place["coupler~rocker"] - place["base~rocker"]
    np.testing.assert_allclose(crank, rocker, rtol=0.0, atol=1e-16)


def test_four_bars_whose_branches_part_within_their_uncertainty_stop_there_and_say_so(derive_design):
    design = derive_design(WILD / "change_point" / "change_point.toml")
    assert design.simulation.status == "stopped"
    # the crank starts at 55° and folds flat at 180°
    assert float(re.search(r"t = ([\d.]+) s", design.simulation.reason)[1]) == pytest.approx(125.0 / 180.0, abs=1e-3)


@pytest.mark.slow
def test_a_coupler_longer_by_more_than_that_takes_its_true_branch(derive_design):
    """Crossed from the first flat pose on, to the end of its reach: the bars make a triangle of 100, 40 and 60.1 mm."""
    design = derive_design(WILD / "parallelogram_unequal" / "parallelogram_unequal.toml")
    assert design.kinematics.misfit.distance == 0.0
    assert values(design, "base~crank")[-1] > np.pi > 0.0 > values(design, "base~rocker")[-1]
    corner = np.degrees(np.arccos((100.0**2 + 40.0**2 - 60.1**2) / (2 * 100.0 * 40.0)))
    end = float(re.search(r"t = ([\d.]+) s", design.simulation.reason)[1])
    assert 180.0 * end == pytest.approx(360.0 - 55.0 - corner, abs=0.02)


def copy(folder, scale, rotation, single):
    """The parallelogram at another size and turned, in single or double precision."""
    source = WILD / "parallelogram_double"
    text = (source / "parallelogram_double.toml").read_text(encoding="utf-8")
    for mesh in sorted(source.glob("*.obj")):
        lines = []
        for line in mesh.read_text(encoding="utf-8").splitlines():
            if line.startswith("v "):
                place = scale * (rotation @ np.array([float(x) for x in line.split()[1:4]]))
                place = place.astype(np.float32).astype(float) if single else place
                line = "v " + " ".join(repr(float(x)) for x in place)
            lines.append(line)
        (folder / mesh.name).write_text("\n".join(lines) + "\n", encoding="utf-8")

    def row(match):
        key, numbers = match[1], np.array([float(x) for x in match[2].split(",")])
        turned = rotation @ numbers * (scale if key == "point" else 1.0)
        return f"{key} = {[float(x) for x in turned]}"

    text = re.sub(r"^(axis|point|gravity) = \[(.*)\]$", row, text, flags=re.MULTILINE)
    text += f"\n[tolerances]\ncontact = {0.3 * scale!r}\n"
    manifest = folder / "copy.toml"
    manifest.write_text(text, encoding="utf-8")
    return manifest


@pytest.mark.parametrize(
    ("scale", "single"),
    first_rows(2, [(1e-3, True), (1e3, False), (1.0, True), (1.0, False), (1e-3, False), (1e3, True)]),
)
def test_size_place_and_precision_leave_the_motion_as_it_is(tmp_path, scale, single):
    rotation = Rotation.from_rotvec([0.3, -0.5, 0.8]).as_matrix()
    manifest = copy(tmp_path, scale, rotation, single)
    design = stages.simulate(stages.mass(stages.joints(stages.contacts(stages.import_(manifest)))), ranges=False)
    run = design.simulation
    assert form.load(manifest).simulation.duration == 2.0
    crank, rocker = values(design, "base~crank"), values(design, "base~rocker")
    np.testing.assert_allclose(rocker, crank, atol=1e-9)
    np.testing.assert_allclose(np.abs(crank), np.pi * run.time, atol=1e-9)
    assert run.status in ("done", "stopped")
    assert run.time[-1] > 125.0 / 180.0 - 0.03
