"""A joint of a real arm: its contacts against an independent survey and the published axis."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from kinform.contacts import find
from kinform.form import load_meshes
from kinform.surfaces import recover

FOLDER = Path(__file__).parents[3] / "shared" / "data" / "so100"
PARTS = ("base", "base_motor", "rotation_pitch")


@pytest.fixture(scope="module")
def shoulder():
    """Patches between the base (two parts) and the shoulder's bracket, and the true joint."""
    if not FOLDER.is_dir():
        pytest.skip(f"the arm's meshes are not there: {FOLDER}")
    design = load_meshes([FOLDER / "parts" / f"{name}.stl" for name in PARTS], units="m")
    surfaces = {p.mesh.digest: recover(p.mesh, design.tolerances) for p in design.parts}
    found = find(design, surfaces)
    (joint,) = (j for j in json.loads((FOLDER / "truth.json").read_text())["joints"] if j["name"] == "shoulder_pan")
    return [p for p in found.patches if "rotation_pitch" in p.parts], joint


def test_areas_and_kinds_agree_with_an_independent_survey(shoulder):
    patches, _ = shoulder
    survey = json.loads((FOLDER / "survey.json").read_text())["joints"]
    (expected,) = (joint for joint in survey if joint["name"] == "shoulder_pan")
    for band in ("0.05", "0.2"):
        within = [p for p in patches if abs(p.gap) <= float(band) * 1e-3 + 1e-6]
        assert sum(p.area for p in within) * 1e6 == pytest.approx(expected[band]["area"], rel=0.1)
    shafts = [p for p in patches if p.kind == "cylinder" and not p.one_sided]
    assert len(shafts) == 2
    for shaft in shafts:
        assert shaft.radii == pytest.approx((0.010, 0.010), abs=0.2e-3)
        assert 0.0 <= shaft.gap <= 0.15e-3


def test_no_patch_forbids_the_rotation_that_the_joint_has(shoulder):
    patches, joint = shoulder
    axis = np.array(joint["axis"]) / np.linalg.norm(joint["axis"])
    for patch in patches:
        speed = np.cross(axis, patch.points - np.array(joint["origin"]))
        along = np.abs(np.einsum("ij,ij->i", patch.normals, speed))
        assert along.max() < 1e-3 * np.linalg.norm(speed, axis=1).max()
