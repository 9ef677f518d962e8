"""The same design at other sizes, far from the origin, and in numbers of less precision."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.copies import Change, answers, axis_errors, checked, copy_of, derived
from support.diagonal import diagonal, first
from support.places import FIXTURES

from kinform import form
from kinform.contacts import find
from kinform.surfaces import recover

DESIGNS = ("pairs/revolute_collars", "pairs/general_ball_in_groove", "locators/fixed_loose_key", "mechanisms/drawer")
SIZE_ALONE = "KF110"
"""The one rule that knows absolute size."""


def manifest(name):
    return FIXTURES / name / f"{name.rpartition('/')[2]}.toml"


@cache
def original(name):
    return checked(manifest(name))


def told(design, originals):
    """What the design and its copies have in common, but for their size."""
    common = answers(design, originals)
    common["findings"].pop(SIZE_ALONE, None)
    return common


def check_copy(name, change, folder, axes=1e-6):
    """The copy under `change` says what the original says."""
    design = original(name)
    copy = copy_of(manifest(name), folder, change)
    other = checked(copy.path)
    assert told(other, copy.originals) == told(design, {name: name for name in copy.originals.values()})
    for tilt, far in axis_errors(design, other, copy, change).values():
        assert tilt < axes
        assert far < axes
    return other


@diagonal(name=DESIGNS, scale=[1e-3, 1e3])
def test_a_design_of_another_size_says_the_same(name, scale, tmp_path):
    check_copy(name, Change(scale=scale), tmp_path)


@pytest.mark.parametrize("power", [-10, 10])
def test_powers_of_two_change_no_bit(power):
    plain = form.load(manifest("pairs/cylindrical_gap_015"))
    scale = 2.0**power
    parts = []
    for part in plain.parts:
        mesh = replace(part.mesh, vertices=scale * part.mesh.vertices, resolution=scale * part.mesh.resolution)
        X = part.X_WP.copy()
        X[:3, 3] *= scale
        parts.append(replace(part, mesh=mesh, X_WP=X))

    def patches(assembly):
        surfaces = {part.mesh.digest: recover(part.mesh, assembly.tolerances) for part in assembly.parts}
        return find(assembly, surfaces).patches

    ours, theirs = patches(plain), patches(replace(plain, parts=tuple(parts)))
    assert [p.kind for p in theirs] == [p.kind for p in ours] != []
    for one, two in zip(ours, theirs, strict=True):
        assert (two.area, two.gap, two.tolerance) == (scale**2 * one.area, scale * one.gap, scale * one.tolerance)
        assert np.array_equal(two.points, scale * one.points)
        assert np.array_equal(two.normals, one.normals)


@diagonal(name=DESIGNS[::2], far=[1.0, 1e3, 1e5], baked=[True, False])
def test_a_design_far_from_the_origin_says_the_same(name, far, baked, tmp_path):
    change = Change(offset=(far, -0.7 * far, 0.4 * far), baked=baked)
    check_copy(name, change, tmp_path, axes=1e-6 if far < 1e5 else 1e-5)


@pytest.mark.parametrize("name", first(2, DESIGNS))
def test_single_precision_says_the_same_as_far_as_its_numbers_resolve(name, tmp_path):
    check_copy(name, Change(offset=(10.0, -7.0, 4.0), baked=True, files="stl"), tmp_path, axes=2e-4)


@pytest.mark.parametrize("name", first(1, [DESIGNS[0], DESIGNS[3]]))
def test_beyond_that_the_file_has_lost_the_shape_and_nothing_is_determined(name, tmp_path):
    change = Change(offset=(3000.0, -2000.0, 1000.0), baked=True, files="stl")
    design = checked(copy_of(manifest(name), tmp_path, change).path)
    assert {f.code for f in design.report.findings if f.severity == "error"} == {"KF111"}
    assert all(joint.status == "ambiguous" for joint in design.kinematics.joints)


def test_a_pin_of_a_metre_with_a_millimetre_of_play_is_in_its_bore():
    design = derived(manifest("wild/large_with_play"))
    (joint,) = design.kinematics.joints
    (bore,) = (p for p in design.contacts.patches if p.kind == "cylinder")
    assert (joint.type, joint.status) == ("revolute", "determined")
    assert bore.gap == pytest.approx(1e-3, rel=1e-3)
