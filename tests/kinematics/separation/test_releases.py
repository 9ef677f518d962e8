"""How a pair of bodies comes apart: what is held, what leaves, and along which directions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support.assemblies import assembly, assume, between, contacts, part
from support.diagonal import diagonal
from support.directions import same_directions, slides
from support.patches import Z, cylinder, patch, plane, ring
from support.solids import ball, box, derived, random_pose, rod

from kinform.foundation.algebra.screws import Frame
from kinform.kinematics import derive
from kinform.kinematics.separation.cone import rows_beside, unit_rows
from kinform.kinematics.separation.contact_rows import Cone
from kinform.kinematics.separation.releases import certainly_held, leaving_of_each
from kinform.reuse.packing import pack

X, Y = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])


def joint_of(*patches, **keys):
    """The one joint between a and b."""
    (joint,) = derive(assembly(part("a"), part("b"), ground="a", **keys), {}, contacts(*patches)).joints
    return joint


def turned(found, R, scale=1.0, offset=0.0):
    """A patch moved by x → scale·R·x + offset."""
    from dataclasses import replace

    axis = found.axis @ R.T
    return replace(
        found, points=scale * found.points @ R.T + offset, normals=found.normals @ R.T, axis=axis,
        point=scale * R @ found.point + offset, weights=scale**2 * found.weights, area=scale**2 * found.area,
        radii=(scale * found.radii[0], scale * found.radii[1]),
    )  # fmt: skip


def test_a_block_on_a_table_lifts_off_and_tips_about_its_edges():
    joint = joint_of(between(plane(size=(0.02, 0.03)), "a", "b"))
    assert (joint.type, joint.held, joint.extremes) == ("planar", False, 4)
    assert same_directions(slides(joint.releases), [Z])
    tips = [way for way in joint.releases if way.kind == "turn"]
    # about the right edge, x = 0.015, the block turns by +y: its left side rises
    edges = {tuple(np.round(way.direction).astype(int) + 0): way.point for way in tips}
    assert set(edges) == {(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)}
    assert edges[(0, 1, 0)][0] == pytest.approx(0.015)
    assert edges[(0, -1, 0)][0] == pytest.approx(-0.015)
    assert edges[(-1, 0, 0)][1] == pytest.approx(0.01)


def test_the_motion_is_that_of_the_second_body():
    joint = joint_of(between(plane(), "b", "a"))
    assert same_directions(slides(joint.releases), [-Z])


def test_a_block_in_an_edge_slides_along_it_and_leaves_two_ways():
    joint = joint_of(plane((0, 0, -0.01), Z), plane((-0.01, 0, 0), X))
    assert (joint.type, joint.held) == ("prismatic", False)
    assert same_directions(slides(joint.releases), [X, Z])


def test_a_block_in_a_corner_is_one_body_with_it_by_contact_and_can_still_leave_three_ways():
    found = derive(
        assembly(part("a"), part("b"), ground="a"),
        {},
        contacts(plane((0, 0, -0.01), Z), plane((-0.01, 0, 0), X), plane((0, -0.01, 0), Y)),
    )
    assert len(found.bodies) == 1
    (apart,) = found.separations
    assert apart.bodies == ("b",)
    assert same_directions(slides(apart.releases), [X, Y, Z])


def test_a_ball_on_a_table_lifts_off():
    joint = joint_of(patch([[0, 0, 0]], Z, "point", area=1e-8))
    assert (joint.freedoms, joint.held, joint.extremes) == (5, False, 1)
    assert same_directions(slides(joint.releases), [Z])


def test_a_collared_shaft_is_held():
    joint = joint_of(cylinder(gap=5e-5), ring((0, 0, 0.01), gap=2e-5), ring((0, 0, -0.01), normal=-Z))
    assert (joint.type, joint.held, joint.releases) == ("revolute", True, ())


def test_a_press_fit_and_a_clearance_fit_are_held_alike():
    for gap in (-2e-5, 0.0, 1e-4):
        joint = joint_of(cylinder(gap=gap))
        assert (joint.type, joint.held) == ("cylindrical", True)


def test_a_shaft_with_one_collar_leaves_one_way():
    joint = joint_of(cylinder(), ring((0, 0, 0.01)))
    assert (joint.type, joint.held, joint.extremes) == ("revolute", False, 1)
    assert same_directions(slides(joint.releases), [Z])


def test_an_end_stop_of_a_hinge_lets_it_turn_away():
    stop = plane((0.02, 0, 0), Y, (0.002, 0.002), area=2e-5)
    joint = joint_of(cylinder(), ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z), stop)
    assert (joint.status, joint.held, len(joint.at_stop)) == ("determined", False, 1)
    (way,) = joint.releases
    # b at x > 0 moves away along +y: it turns by +z
    assert way.kind == "turn"
    assert np.allclose(way.direction, Z, atol=1e-6)
    assert np.allclose(way.point[:2], 0, atol=1e-6)


def test_contact_does_not_say_whether_a_stated_joint_is_held():
    joint = joint_of(plane(), assume=[assume("a", "b", "revolute", axis=(0, 0, 1), point=(0, 0, 0))])
    assert joint.held is None
    assert joint.held_reason


CASES = {
    "peg in a blind hole": (
        lambda: box(-20, 20, -20, 20, -20, 0) - rod(5.05, -15, 1, 48), lambda: rod(5, -15, 10), [Z],
    ),
    "ball in half a socket": (lambda: box(-20, 20, -20, 20, -20, 0) - ball(8.05, 64, 3), lambda: ball(8), [Z]),
    "ball in a socket past its equator": (
        lambda: box(-20, 20, -20, 20, -20, 5) - ball(8.05, 64, 3), lambda: ball(8), [],
    ),
    "box in an open slot": (
        lambda: box(-20, 20, -20, 20, -20, 7) - box(-5, 5, -30, 30, -7, 8), lambda: box(-5, 5, -6, 6, -7, 7), [Z],
    ),
    "shaft in half a bearing": (
        lambda: box(-20, 20, -20, 20, -20, 0) - rod(5.05, -30, 30, 48).rotate((90, 0, 0)),
        lambda: rod(5, -25, 25).rotate((90, 0, 0)), [Z],
    ),
}  # fmt: skip


@diagonal(name=list(CASES), seed=[0, 1])
def test_meshes_at_any_pose_and_from_millimetres_to_a_hundred_metres(name, seed):
    first, second, expected = CASES[name]
    rng = np.random.default_rng(seed)
    scale = (1e-3, 2.5)[seed]
    pose = random_pose(rng, 100.0 * scale)
    found, _ = derived(pose, scale, a=first(), b=second())
    (joint,) = found.joints
    assert joint.held is not (bool(expected))
    assert same_directions(slides(joint.releases), [pose[:3, :3] @ d for d in expected], 0.02)
    assert bool(found.separations) == bool(expected)


def test_a_box_in_a_closed_slot_is_one_body_and_leaves_nowhere():
    found, _ = derived(a=box(-20, 20, -20, 20, -20, 20) - box(-5, 5, -6, 6, -7, 7), b=box(-5, 5, -6, 6, -7, 7))
    assert len(found.bodies) == 1
    assert found.separations == ()


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_turning_scaling_and_reordering_change_nothing_but_the_frame(scale):
    R = Rotation.from_euler("xyz", [0.3, -0.8, 1.1]).as_matrix()
    offset = scale * np.array([0.4, -0.2, 0.7])
    before = [plane((0, 0, -0.01), Z), plane((-0.01, 0, 0), X)]
    after = [turned(p, R, scale, offset) for p in before]
    plain, moved = joint_of(*before), joint_of(*reversed(after))
    assert (plain.held, plain.extremes) == (moved.held, moved.extremes)
    assert same_directions(slides(moved.releases), [R @ d for d in slides(plain.releases)], 1e-6)
    found = {tuple(np.round(R.T @ way.direction, 4) + 0.0) for way in moved.releases if way.kind != "slide"}
    assert found == {tuple(np.round(way.direction, 4) + 0.0) for way in plain.releases if way.kind != "slide"}


def test_the_order_of_parts_and_patches_does_not_matter():
    rng = np.random.default_rng(3)
    patches = [plane((0, 0, -0.01), Z), plane((-0.01, 0, 0), X), cylinder(0.003, point=(0.02, 0, 0), axis=X)]
    parts = [part("a"), part("b")]
    plain = derive(assembly(*parts, ground="a"), {}, contacts(*patches)).joints
    for _ in range(3):
        mixed = [patches[k] for k in rng.permutation(len(patches))]
        again = derive(assembly(*reversed(parts), ground="a"), {}, contacts(*mixed)).joints
        assert [(j.held, [w.words for w in j.releases]) for j in again] == [
            (j.held, [w.words for w in j.releases]) for j in plain
        ]


def loose_cones(rng):
    """Cones that are held both ways in up to five directions, and one way by a few random rows, or by many all round
    one direction; few of them are held."""
    out = []
    for held in range(6):
        for count in (1, 2, 4, 40):
            fixed = np.linalg.qr(rng.normal(size=(6, 6)))[0][:held]
            fixed = np.linalg.qr(rng.normal(size=(3, 3)))[0][:held] @ np.eye(3, 6, 3) if held < 3 else fixed
            rows = rng.normal(size=(count, 6)) + 2.0 * rng.normal(size=6)
            out.append(Cone(fixed, rows_beside(unit_rows(rows), fixed), Frame(rng.normal(size=3), 0.1)))
    return out


@diagonal(2, seed=range(4), turns=[True, False])
def test_how_a_pair_comes_apart_does_not_depend_on_the_others(seed, turns):
    found = loose_cones(np.random.default_rng(9))
    cones = [cone for cone, held in zip(found, certainly_held(found), strict=True) if not held]
    alone = [pack(leaving_of_each([cone], turns=turns)[0]) for cone in cones]
    assert len(set(alone)) > 12
    rng = np.random.default_rng(seed)
    chosen = rng.permutation(len(cones))[: int(rng.integers(2, len(cones) + 1))].tolist()
    together = leaving_of_each([cones[k] for k in chosen], turns=turns)
    assert [pack(leaving) for leaving in together] == [alone[k] for k in chosen]
