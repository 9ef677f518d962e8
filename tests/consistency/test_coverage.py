"""Coverage: what geometry leaves open, in any pose and size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.solids import box, derived, random_pose, save

from kinform import stages
from kinform.consistency import verdict, verdict_of

POSES = [np.eye(4), random_pose(np.random.default_rng(3))]
CORNER = box(-5, 30, -5, 30, -5, 30) - box(0, 40, 0, 40, 0, 40)
"""Three walls."""
POCKET = box(-5, 35, -5, 35, -5, 20) - box(0, 30, 0, 30, 0, 40)
"""A pocket, open at its top."""
BLOCK = box(0, 20, 0, 20, 0, 20)


def turning(X, **solids):
    kinematics, _ = derived(X, **solids)
    return {pair for body in kinematics.bodies for pair in body.turning}, len(kinematics.bodies)


@pytest.mark.parametrize("X", POSES)
def test_a_block_that_lies_in_a_corner_is_one_with_it_at_rest_alone(X):
    assert turning(X, corner=CORNER, block=BLOCK) == ({"block~corner"}, 1)


@pytest.mark.parametrize("X", POSES)
def test_a_block_that_fills_its_pocket_only_comes_out_straight(X):
    assert turning(X, pocket=POCKET, block=box(0, 30, 0, 30, 0, 25)) == (set(), 1)


def design_of(tmp_path, text="", **solids):
    names = []
    for name, solid in solids.items():
        save(solid, tmp_path / f"{name}.stl")
        names.append(f'[[part]]\nname = "{name}"\nmesh = "{name}.stl"\ndensity = 1000\n')
    head = 'schema = 1\n[assembly]\nname = "m"\nunits = "mm"\n'
    (tmp_path / "m.toml").write_text(head + "".join(names) + text)
    design = stages.joints(stages.contacts(stages.import_(tmp_path / "m.toml")))
    return stages.check(stages.simulate(stages.mass(design)))


def test_what_is_fused_at_rest_is_said_and_fails_the_strict(tmp_path):
    report = design_of(tmp_path, corner=CORNER, block=BLOCK).report
    assert report.coverage.fused == ("block~corner",)
    assert "block~corner" in verdict_of(report).coverage
    assert (verdict(report), verdict(replace(report, strict=True))) == (0, 2)


def test_two_solids_in_one_mesh_may_be_two_parts_and_a_cavity_may_not(tmp_path):
    two = box(0, 10, 0, 10, 0, 10) + box(20, 30, 0, 10, 0, 10)
    hollow = box(0, 10, 0, 10, 40, 50) - box(2, 8, 2, 8, 42, 48)
    report = design_of(tmp_path, two=two, hollow=hollow).report
    assert report.coverage.several == ("two",)
    accepted = '[[check.ignore]]\ncode = "KF107"\nsubject = "two"\nreason = "welded"\n'
    report = design_of(tmp_path, accepted, two=two, hollow=hollow).report
    assert report.coverage.several == ()


def test_rules_that_settings_make_notes_are_named(tmp_path):
    report = design_of(tmp_path, '[check.severity]\nKF201 = "note"\nKF203 = "error"\n', block=BLOCK).report
    assert report.coverage.lowered == ("KF201",)
    assert "KF201" in verdict_of(report).coverage
