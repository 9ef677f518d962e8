"""Every kind of joint obeys the axioms of its motion, in either direction of the tree."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from support.devices import body, device, joint

from kinform.behaviour import build
from kinform.behaviour.joints import KINDS
from kinform.foundation.algebra.spatial import cross_motion, quaternions, rotation_vector, to_matrix
from kinform.foundation.algebra.vectors import perpendicular
from kinform.simulation.mechanism.construction import assemble

AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
POINT = np.array([0.3, -0.2, 0.5])
OTHER = np.cross(AXIS, [0.0, 0.6, 0.8])


def placed(kind, a="base", b="part"):
    needs = {"axis": AXIS, "point": POINT, "axis2": OTHER, "pitch": 0.02}
    return joint(a, b, kind, **needs)


def mechanism(kind, a="base", b="part"):
    made, chain, mass = device([body("part", 1.0, (0.1, 0.2, 0.3), [1, 1, 1])], [placed(kind, a, b)])
    return assemble(build(made, chain, mass).system)[0]


def pose(model, q):
    """Pose of the part in the world."""
    X = model.poses(q)[model.link_of[model.bodies.index("part")]]
    out = X.copy()
    out[:3, 3] = X[:3, 3] + model.centre - X[:3, :3] @ model.centre
    return out


def at(model, seed=0):
    """Some positions away from zero."""
    step = np.random.default_rng(seed).uniform(-1.0, 1.0, model.rates)
    return model.advance(model.start, step)


def bracket(twist):
    w, v = twist[:3], twist[3:]
    out = np.zeros((4, 4))
    out[:3, :3] = np.cross(np.eye(3), w)
    out[:3, :3] = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    out[:3, 3] = v
    return out


MOVING = sorted(set(KINDS) - {"fixed"})


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_the_start_is_the_pose_of_the_meshes(kind):
    model = mechanism(kind)
    np.testing.assert_array_equal(pose(model, model.start), np.eye(4))


@pytest.mark.parametrize("kind", MOVING)
@pytest.mark.parametrize("ends", [("base", "part"), ("part", "base")])
def test_rates_move_the_body_as_differences_of_poses_say(kind, ends):
    model = mechanism(kind, *ends)
    q, h = at(model), 1e-6
    screws = model.screws(model.poses(q))
    X = model.poses(q)[-1]
    for k, unit in enumerate(np.eye(model.rates)):
        after, before = (model.poses(model.advance(q, s * h * unit))[-1] for s in (1, -1))
        difference = (after - before) / (2 * h) @ np.linalg.inv(X)
        np.testing.assert_allclose(difference, bracket(screws[k]), atol=2e-9)


@pytest.mark.parametrize("kind", MOVING)
def test_turning_the_tree_round_gives_the_inverse_motion(kind):
    there, back = mechanism(kind, "base", "part"), mechanism(kind, "part", "base")
    q = at(there)
    np.testing.assert_allclose(pose(there, q) @ pose(back, q), np.eye(4), atol=1e-14)


@pytest.mark.parametrize("kind", MOVING)
@pytest.mark.parametrize("ends", [("base", "part"), ("part", "base")])
def test_twists_change_as_the_bias_says(kind, ends):
    """The acceleration at constant rates, against differences of the twist."""
    model = mechanism(kind, *ends)
    q, h = at(model), 1e-6
    v = np.random.default_rng(1).normal(size=model.rates)
    screws = model.screws(model.poses(q))
    V = model.twists(screws, v)
    bias = (model.moves @ cross_motion(V[model.column_link], screws * v[:, None]))[-1]
    after, before = (model.twists(model.screws(model.poses(model.advance(q, s * h * v))), v)[-1] for s in (1, -1))
    np.testing.assert_allclose((after - before) / (2 * h), bias, atol=5e-9)


@pytest.mark.parametrize("kind", MOVING)
def test_a_joint_that_closes_a_loop_agrees_with_the_same_joint_in_the_tree(kind):
    """Two equal joints side by side: the gap is zero at equal values and has the stated derivative."""
    parts = [body("part", 1.0, (0.1, 0.2, 0.3), [1, 1, 1]), body("twin", 1.0, (0.1, 0.2, 0.3), [1, 1, 1])]
    made, chain, mass = device(
        parts, [placed(kind), placed(kind, "base", "twin"), joint("part", "twin", "revolute", AXIS, POINT)]
    )
    model = assemble(build(made, chain, mass).system)[0]
    single = model.slots[0]
    q = model.start
    half = np.random.default_rng(2).uniform(-1, 1, single.v.stop - single.v.start)
    step = np.zeros(model.rates)
    for slot in model.slots[:2]:
        step[slot.v] = half
    q = model.advance(q, step)
    np.testing.assert_allclose(model.gap(model.poses(q), q), 0.0, atol=1e-14)
    rows, h = model.closure(model.screws(model.poses(q))), 1e-6
    for k, unit in enumerate(np.eye(model.rates)):
        after, before = (model.advance(q, s * h * unit) for s in (1, -1))
        difference = (model.gap(model.poses(after), after) - model.gap(model.poses(before), before)) / (2 * h)
        np.testing.assert_allclose(difference, rows[:, k], atol=2e-9)


def test_revolute_is_the_exponential_of_its_twist():
    model = mechanism("revolute")
    twist = np.concatenate([AXIS, np.cross(POINT, AXIS)])
    np.testing.assert_allclose(pose(model, np.array([0.7])), expm(0.7 * bracket(twist)), atol=1e-14)


def test_screw_advances_by_its_pitch_in_one_turn():
    X = pose(mechanism("screw"), np.array([2 * np.pi]))
    np.testing.assert_allclose(X[:3, :3], np.eye(3), atol=1e-14)
    np.testing.assert_allclose(X[:3, 3], 0.02 * AXIS, atol=1e-14)


def test_cylindrical_turns_and_slides_independently():
    model = mechanism("cylindrical")
    both = pose(model, np.array([0.4, 0.05]))
    np.testing.assert_allclose(both, pose(model, np.array([0.0, 0.05])) @ pose(model, np.array([0.4, 0.0])), atol=1e-15)
    np.testing.assert_allclose(AXIS @ (both @ [*POINT, 1])[:3], AXIS @ POINT + 0.05, atol=1e-15)


def test_planar_stays_in_its_plane_and_its_slides_do_not_turn():
    model = mechanism("planar")
    u, v = perpendicular(AXIS)
    X = pose(model, np.array([0.9, 0.03, -0.02]))
    np.testing.assert_allclose((X @ [*POINT, 1])[:3], POINT + 0.03 * u - 0.02 * v, atol=1e-15)
    np.testing.assert_allclose(X[:3, :3] @ AXIS, AXIS, atol=1e-15)


def test_universal_keeps_each_axis_in_its_body():
    X = pose(mechanism("universal"), np.array([0.5, -0.8]))
    np.testing.assert_allclose((X @ [*POINT, 1])[:3], POINT, atol=1e-15)
    first_only = pose(mechanism("universal"), np.array([0.5, 0.0]))
    np.testing.assert_allclose(X[:3, :3] @ OTHER, first_only[:3, :3] @ OTHER, atol=1e-15)
    assert AXIS @ X[:3, :3] @ OTHER == pytest.approx(AXIS @ OTHER, abs=1e-15)


def test_spherical_turns_by_its_quaternion():
    model = mechanism("spherical")
    q = at(model, 4)
    X = pose(model, q)
    np.testing.assert_allclose(X[:3, :3], to_matrix(q), atol=1e-15)
    np.testing.assert_allclose((X @ [*POINT, 1])[:3], POINT, atol=1e-15)


def test_quaternions_and_rotation_vectors_invert_rotations():
    rng = np.random.default_rng(5)
    vectors = rng.normal(size=(200, 3))
    vectors *= (rng.uniform(0, np.pi - 1e-6, 200) / np.linalg.norm(vectors, axis=1))[:, None]
    vectors[0] = 0.0
    vectors[1] = 1e-9
    R = np.array([expm(bracket(np.array([*w, 0, 0, 0]))[:3, :3]) for w in vectors])
    np.testing.assert_allclose(rotation_vector(R), vectors, atol=1e-8)
    np.testing.assert_allclose([to_matrix(q) for q in quaternions(R)], R, atol=1e-14)
