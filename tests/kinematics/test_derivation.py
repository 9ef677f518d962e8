"""From contacts to bodies, joints and mobility: small assemblies with known behaviour."""

from __future__ import annotations

import numpy as np
import pytest
from support.assemblies import assembly, assume, between, contacts, intended, part
from support.four_bar import four_bar, hinge
from support.patches import Z, cylinder, plane, ring

from kinform.kinematics import derive, functional


def weld(a, b, at=(0, 0, 0)):
    at = np.asarray(at, float)
    return [
        between(plane(at + d, n, (0.01, 0.01)), a, b) for d, n in ((0.01 * e, s * e) for e in np.eye(3) for s in (1.0,))
    ]


def test_a_four_bar_has_one_freedom_and_three_redundant_rows():
    found = derive(four_bar()[0], {}, four_bar()[1])
    assert [j.type for j in found.joints] == ["revolute"] * 4
    mobility = found.mobility
    assert (mobility.instantaneous, mobility.idle, mobility.effective, mobility.redundant) == (1, 0, 1, 3)


@pytest.mark.parametrize("ground", ["base", "crank", "link", "rocker"])
def test_the_ground_does_not_change_the_mobility(ground):
    assert derive(four_bar(ground)[0], {}, four_bar()[1]).mobility.instantaneous == 1


def test_axes_within_their_uncertainty_are_made_parallel_and_the_misfit_is_kept():
    from dataclasses import replace

    tilt = np.array([1e-6, 0, 1.0]) / np.linalg.norm([1e-6, 0, 1.0])
    model, exact = four_bar()
    noisy = [
        replace(p, axis=tilt, uncertainty=(1e-6, 1e-9))
        if p.parts == ("crank", "link")
        else replace(p, uncertainty=(1e-6, 1e-9))
        for p in exact.patches
    ]
    found = derive(model, {}, contacts(*noisy))
    assert found.mobility.instantaneous == 1
    assert 1e-7 < found.misfit.angle < 1e-6
    axes = np.array([j.axis for j in found.joints])
    assert np.abs(axes - axes[0]).max() == 0.0


def test_a_real_misalignment_is_not_snapped_away():
    model, exact = four_bar()
    tilted = [p for p in exact.patches if p.parts != ("crank", "link")]
    tilted += hinge("crank", "link", (0, 0.1, 0), np.array([0.01, 0, 1]) / np.linalg.norm([0.01, 0, 1]))
    assert derive(model, {}, contacts(*tilted)).mobility.instantaneous == 0


def test_contact_of_rank_six_fuses_before_joints_are_named():
    model = assembly(part("clip"), part("hub"), part("pin"), ground="hub")
    found = derive(
        model,
        {},
        contacts(
            between(cylinder(), "pin", "hub"),
            *weld("clip", "pin", (0, 0, 0.05)),
            between(ring((0, 0, 0.01)), "clip", "hub"),
            between(ring((0, 0, -0.01), normal=-Z), "clip", "hub"),
        ),
    )
    assert [b.name for b in found.bodies] == ["clip", "hub"]
    assert found.bodies[0].parts == ("clip", "pin")
    assert [(j.name, j.type) for j in found.joints] == [("clip~hub", "revolute")]


def test_a_body_takes_the_name_of_its_first_group():
    parts = (part("a"), part("b"), part("c"))
    found = derive(
        assembly(*parts, groups=[("zed", ["a", "b"])], ground="c"), {}, contacts(*hinge("b", "c", (0, 0, 0)))
    )
    assert [b.name for b in found.bodies] == ["c", "zed"]
    assert found.joints[0].bodies == ("c", "zed")


def test_the_heaviest_body_is_ground_and_the_largest_where_a_density_is_missing():
    heavy = (part("a", volume=1e-6, density=9000.0), part("b", volume=2e-6, density=1000.0))
    patches = contacts(*hinge("a", "b", (0, 0, 0)))
    assert derive(assembly(*heavy), {}, patches).body_of("a").ground
    unknown = (part("a", volume=1e-6, density=9000.0), part("b", volume=2e-6, density=None))
    assert derive(assembly(*unknown), {}, patches).body_of("b").ground


@pytest.mark.parametrize(("heavier", "ground"), [(0.0, "a"), (1e-15, "a"), (2e-4, "a"), (0.01, "b")])
def test_of_equally_heavy_bodies_the_first_is_ground_whichever_was_rounded_up(heavier, ground):
    patches = contacts(*hinge("a", "b", (0, 0, 0)))
    for density in (None, 2700.0):
        parts = (part("a", volume=1e-6, density=density), part("b", volume=1e-6 * (1.0 + heavier), density=density))
        assert derive(assembly(*parts), {}, patches).body_of(ground).ground


def test_an_untouched_part_has_six_freedoms():
    found = derive(assembly(part("a"), part("b"), ground="a"), {}, contacts())
    assert (found.mobility.instantaneous, len(found.joints)) == (6, 0)


def test_assumptions_fuse_or_state_a_joint_and_are_labelled():
    parts = (part("a"), part("b"), part("c"))
    model = assembly(
        *parts,
        ground="a",
        assume=[assume("a", "b", "fixed"), assume("b", "c", "revolute", axis=(0, 0, 1), point=(0, 0, 0))],
    )
    found = derive(model, {}, contacts(between(plane(), "b", "c")))
    assert found.body_of("b").merged == ("assumed fixed: because",)
    joint = found.joints[0]
    assert (joint.type, joint.status, joint.evidence) == ("revolute", "inferred", ("assumption",))
    assert found.mobility.instantaneous == 1


def test_stick_bodies_take_their_joints_from_function_beside_meshed_ones():
    model = assembly(
        part("base"), part("rotor"), part("stick", stick=True), ground="base",
        joints=[intended("yaw", "base", "rotor"), intended("pitch", "rotor", "stick", axis=(1, 0, 0))],
    )  # fmt: skip
    found = derive(model, {}, contacts(*hinge("rotor", "base", (0, 0, 0))))
    assert {j.name: j.evidence for j in found.joints}["rotor~stick"] == ("function",)
    assert found.mobility.instantaneous == 2


def test_the_functional_model_needs_no_geometry():
    model = assembly(
        part("a", stick=True), part("b", stick=True), part("c", stick=True), ground="a",
        joints=[intended("yaw", "a", "b"), intended("pitch", "b", "c", axis=(1, 0, 0)), ],
    )  # fmt: skip
    assert functional(model).mobility.instantaneous == 2


def test_j_preserves_the_freedoms_of_the_assembly_row_by_row():
    from scipy.sparse import csr_matrix

    found = derive(four_bar()[0], {}, four_bar()[1])
    matrix = found.matrix
    j = csr_matrix((matrix.data, matrix.indices, matrix.indptr), shape=(len(matrix.patch), 6 * len(matrix.bodies)))
    twists = found.mobility.freedoms.copy()
    twists[..., 3:] += np.cross(twists[..., :3], matrix.centre)
    twists[..., :3] *= matrix.length
    assert np.abs(j @ twists.reshape(1, -1).T).max() < 1e-12
    fixed = np.delete(j.toarray(), np.s_[:6], axis=1)
    assert np.linalg.matrix_rank(fixed, tol=1e-9) == 17
    patch = four_bar()[1].patches[matrix.patch[0]]
    assert np.allclose(np.abs(j[0, :].toarray()).ravel()[3:6], np.abs(patch.normals[matrix.sample[0]]))


def test_the_order_of_parts_and_patches_changes_nothing():
    model, touching = four_bar()
    plain = derive(model, {}, touching)
    turned = derive(model, {}, contacts(*reversed(touching.patches)))
    assert [(j.name, j.type) for j in plain.joints] == [(j.name, j.type) for j in turned.joints]
    for a, b in zip(plain.joints, turned.joints, strict=True):
        assert np.allclose(a.axis, b.axis)
        assert np.allclose(a.point, b.point, atol=1e-12)


def test_a_universal_joint_keeps_its_axes_with_their_bodies_in_either_order():
    from dataclasses import replace

    parts = (part("a", stick=True), part("b", stick=True))
    stated = replace(intended("cross", "b", "a", "universal", axis=(1, 0, 0)), axis2=np.array([0.0, 1.0, 0.0]))
    joint = functional(assembly(*parts, ground="a", joints=[stated])).joints[0]
    assert joint.axis.tolist() == [0.0, 1.0, 0.0]
    assert joint.axis2.tolist() == [1.0, 0.0, 0.0]
