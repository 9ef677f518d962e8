"""Finite mobility of mechanisms whose motions are known from the literature."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from support.devices import joint
from support.diagonal import diagonal
from support.linkages import (
    KNOWN,
    ball_truss,
    door,
    four_bar,
    generic,
    hinge,
    manifest,
    planar,
    ring,
    slider_crank,
    turned,
)

from kinform import stages
from kinform.foundation.algebra.screws import Frame
from kinform.kinematics.mobility.finite_motion import finite_mobility
from kinform.mechanism import closing, least_change
from kinform.mechanism.first_order import close
from kinform.mechanism.loop_system import loop_system

X, Y, Z = np.eye(3)


def build(mechanism):
    return [joint(a, b, kind, axis, point, axis2) for a, b, kind, axis, point, axis2 in mechanism]


def count(joints, *, size=5.0, ground="base"):
    """(first-order freedoms, what finite_mobility says)."""
    names = sorted({name for one in joints for name in one.bodies})
    index = {name: k for k, name in enumerate(names)}
    edges = [(index[a], index[b]) for a, b in (one.bodies for one in joints)]
    first = close(len(names), edges, [one.twists for one in joints], index[ground], size).mobility
    return first, finite_mobility(edges, joints, len(names), first, size)


def figures(mechanism, **keys):
    first, found = count(build(mechanism), **keys)
    return first, found.count, found.infinitesimal, found.singular


def moved(mechanism, rotation=None, shift=(0, 0, 0), scale=1.0):
    """The mechanism turned, then scaled, then shifted."""
    turn = np.eye(3) if rotation is None else rotation

    def line(vector):
        return None if vector is None else turn @ vector

    return [
        (a, b, kind, line(axis), scale * (turn @ point) + np.asarray(shift, float), line(axis2))
        for a, b, kind, axis, point, axis2 in mechanism
    ]


@pytest.mark.parametrize("name", KNOWN)
def test_mechanisms_move_as_published(name):
    mechanism, *expected = KNOWN[name]
    assert figures(mechanism) == tuple(expected)


@pytest.mark.parametrize("name", KNOWN)
def test_ball_and_stick_manifests_move_as_published(name, tmp_path):
    mechanism, first, finite, infinitesimal, singular = KNOWN[name]
    if name.startswith(("door", "table")):
        pytest.skip("a manifest states one joint between two bodies")
    (tmp_path / "m.toml").write_text(manifest(mechanism))
    mobility = stages.joints(stages.contacts(stages.import_(tmp_path / "m.toml"))).kinematics.mobility
    assert (mobility.instantaneous, mobility.finite) == (first, finite)
    assert (mobility.infinitesimal, mobility.singular) == (infinitesimal, singular)
    assert mobility.effective == finite - mobility.idle


@diagonal(name=list(KNOWN), scale=[1e-3, 30.0])
def test_turned_shifted_and_scaled_mechanisms_move_alike(name, scale):
    mechanism, *expected = KNOWN[name]
    rotation = Rotation.from_rotvec([0.4, -1.1, 0.7]).as_matrix()
    elsewhere = moved(mechanism, rotation, (200 * scale, -70 * scale, 30 * scale), scale)
    assert figures(elsewhere, size=5.0 * scale) == tuple(expected)


@pytest.mark.parametrize(
    "name",
    ["Watt six-bar", "flat parallelogram", pytest.param("shaky truss with balls", marks=pytest.mark.sweep), "Bennett"],
)
def test_ground_and_order_do_not_matter(name):
    mechanism, *expected = KNOWN[name]
    order = np.random.default_rng(5).permutation(len(mechanism))
    for ground in {body for one in mechanism for body in one[:2]}:
        assert figures([mechanism[k] for k in order], ground=ground) == tuple(expected)
    renamed = [(b, a, *rest) for a, b, *rest in reversed(mechanism)]
    assert figures(renamed) == tuple(expected)


def test_a_flat_parallelogram_goes_on_in_two_ways():
    _, found = count(build(KNOWN["flat parallelogram"][0]))
    (certificate,) = found.certificates
    assert certificate.branches == (1, 1)
    assert certificate.stepped == 1
    assert found.singular


def test_certificates_are_residuals_of_closed_loops():
    for name in ("four-bar", "Bennett", "Stewart platform", "rectangular Bricard"):
        (certificate,) = count(build(KNOWN[name][0]))[1].certificates
        assert certificate.second_order == "extends"
        assert certificate.step == 0.05
        assert certificate.kept > 0.9
        assert certificate.residual < 1e-13
        assert certificate.stepped == certificate.instantaneous


def test_a_shaky_truss_is_obstructed_at_second_order_and_says_where():
    _, found = count([*build(planar((0, 0), (1, 0), (2.5, 0))), *build([hinge("base", "flag", (9, 9, 9))])])
    (certificate,) = found.certificates
    assert found.count == 1
    assert certificate.second_order == "obstructed"
    assert certificate.moves == ("base~link1", "link1~link2", "link2~base")
    assert (found.infinitesimal, certificate.finite) == (1, 0)


def test_a_mechanism_near_its_singular_pose_is_not_singular():
    for height in (1e-2, 1e-3):
        assert figures(planar((0, 0), (1, height), (4, height), (3, 0))) == (1, 1, 0, False)


def test_a_dead_centre_is_no_singularity_of_the_motion():
    dead = [
        hinge("base", "crank", (0, 0, 0)), hinge("crank", "rod", (1, 0, 0)), hinge("rod", "piston", (4, 0, 0)),
        ("base", "piston", "prismatic", X, np.array([4.0, 0, 0]), None),
    ]  # fmt: skip
    assert figures(dead) == (1, 1, 0, False)


def test_a_slider_crank_whose_rod_is_as_long_as_its_crank_can_change_over():
    folded = [
        hinge("base", "crank", (0, 0, 0)), hinge("crank", "rod", (0, 1, 0)), hinge("rod", "piston", (0, 0, 0)),
        ("base", "piston", "prismatic", X, np.array([0.0, 0, 0]), None),
    ]  # fmt: skip
    # the piston slides from the crank's axis, or stays on it while crank and rod turn together
    first, found = count(build(folded))
    assert (first, found.count, found.singular) == (2, 1, True)
    assert found.certificates[0].branches == (1, 1)


def test_a_shaky_part_within_a_mechanism_is_told_from_its_motion():
    # a four-bar whose coupler is tied to a second, collinear pair of bars that could only move sideways
    mechanism = [*four_bar(), hinge("link1", "m1", (0.0, 0.5, 0)), hinge("m1", "m2", (0, 1, 0))]
    mechanism += [hinge("m2", "link1", (0, 1.5, 0))]
    first, found = count(build(mechanism))
    assert (first, found.count, found.infinitesimal) == (2, 1, 1)


def truss(cart, height, name):
    """Two bars in line from the wall at x = 0 to a cart at x = 2."""
    return [
        hinge("base", f"{name}1", (0, height, 0)), hinge(f"{name}1", f"{name}2", (1, height, 0)),
        hinge(f"{name}2", cart, (2, height, 0)),
    ]  # fmt: skip


def cart(axis=X):
    return [("base", "cart", "prismatic", axis, np.array([2.0, 0, 0]), None)]


def test_two_shaky_trusses_that_pull_a_cart_the_same_way_move_together():
    # the cart moves by −(a² + b²)/2 …: both middles go up, or one up and one down
    first, found = count(build([*cart(), *truss("cart", 0, "a"), *truss("cart", 1, "b")]))
    assert (first, found.count, found.infinitesimal, found.singular) == (2, 1, 0, True)
    assert found.certificates[0].branches == (1, 1)


def test_two_shaky_trusses_that_pull_against_each_other_are_rigid():
    against = [hinge("cart", "c", (2, 1, 0)), hinge("c", "d", (3, 1, 0)), hinge("base", "d", (5, 1, 0))]
    first, found = count(build([*cart(), *truss("cart", 0, "a"), *against]))
    assert (first, found.count, found.infinitesimal) == (2, 0, 2)
    assert found.certificates[0].second_order == "obstructed"


def test_shakiness_of_fourth_order_passes_the_second_order_test_and_is_found_by_steps():
    # the cart would have to give way by a²; a bar across its way lets it give only at first order: a⁴ = 0
    across = [hinge("base", "bar", (2, 3, 0)), hinge("bar", "cart", (2, 0, 0))]
    first, found = count(build([*cart(), *truss("cart", 0, "a"), *across]))
    assert (first, found.count, found.infinitesimal) == (1, 0, 1)
    assert found.certificates[0].second_order == "extends"


def test_bridges_and_loose_bodies_are_motions():
    mechanism = [*four_bar(), hinge("link2", "flag", (9, 9, 9), Y), hinge("far", "away", (50, 0, 0), X)]
    assert count(build(mechanism))[0] == 1 + 1 + 1 + 6
    assert count(build(mechanism))[1].count == 1 + 1 + 1 + 6


def as_general(joint_of):
    return replace(joint_of, type="general", axis=None, point=None)


def test_a_loop_that_moves_a_general_joint_is_not_known():
    joints = build(four_bar())
    first, found = count([*joints[:3], as_general(joints[3])])
    assert first == 1
    assert found.count is None
    (certificate,) = found.certificates
    assert (certificate.instantaneous, certificate.finite) == (1, None)


def test_a_loop_in_which_a_general_joint_rests_is_known_from_the_others():
    post = [
        ("base", "post", "prismatic", X, np.zeros(3), None), ("base", "mid", "prismatic", Y, np.zeros(3), None),
        ("mid", "post", "prismatic", Y, np.zeros(3), None),
    ]  # fmt: skip
    bars = [(a, "post" if b == "base" else b, *rest) for a, b, *rest in four_bar()]
    joints = build([*bars, *post])
    at = next(k for k, one in enumerate(joints) if one.name == "base~post")
    joints[at] = as_general(joints[at])
    assert count(joints)[0] == 2
    assert count(joints)[1].count == 2


def test_an_open_general_joint_has_its_freedoms():
    first, found = count([as_general(one) for one in build([hinge("base", "flap", (1, 0, 0))])])
    assert (first, found.count, found.reason) == (1, 1, "")


@pytest.mark.parametrize(
    ("feet", "tops", "finite"),
    [
        ([(0, 0), (1, 0.5), (3, 0)], [(0.5, 2), (1.5, 2.5), (3.5, 2)], 1),
        ([(0, 0), (1, 0), (3, 0)], [(0, 2), (1, 2.5), (3, 3)], 0),
        ([(0, 0), (2, 0), (5, 0)], [(0.6, 1.2), (2, 1.6), (4.4, 0.8)], 0),
    ],
    ids=["equal and parallel", "parallel only", "concurrent"],
)
def test_a_plate_on_three_bars_moves_only_on_equal_parallel_ones(feet, tops, finite):
    bars = []
    for k, (foot, top) in enumerate(zip(feet, tops, strict=True)):
        bars += [hinge("base", f"bar{k}", (*foot, 0)), hinge(f"bar{k}", "plate", (*top, 0))]
    assert figures(bars) == (1, finite, 1 - finite, False)


def test_axes_rounded_to_nine_digits_move_like_exact_ones():
    for name in ("Bennett", "spherical four-bar"):
        rounded = [
            (a, b, kind, np.round(axis / np.linalg.norm(axis), 9), np.round(point, 9), None)
            for a, b, kind, axis, point, _ in KNOWN[name][0]
        ]
        assert figures(rounded) == (1, 1, 0, False)


def test_many_fixed_joints_in_a_block_cost_nothing():
    welds = [("base", "post", "fixed", None, None, None) for _ in range(400)]
    assert figures([*door(2), *welds]) == (1, 1, 0, False)


def test_a_loop_with_an_ambiguous_joint_is_not_known_and_others_are():
    joints = build([*four_bar(), *door(2)])
    joints[1] = replace(joints[1], status="ambiguous")
    _, found = count(joints)
    assert found.count is None
    assert sorted(c.finite for c in found.certificates if c.finite is not None) == [1]


def test_a_block_beyond_the_limit_is_said_to_be(monkeypatch):
    monkeypatch.setattr("kinform.kinematics.mobility.finite_motion.MOST_BLOCK_WORK", 50)
    _, found = count(build(four_bar()))
    assert found.count is None
    (certificate,) = found.certificates
    assert (certificate.instantaneous, certificate.finite) == (None, None)


@pytest.mark.parametrize("empty", [0, 20])
def test_equations_of_a_large_block_made_triangular_have_the_same_solution(empty):
    rng = np.random.default_rng(1)
    jacobian, missed = rng.normal(size=(2, 150, 64)), rng.normal(size=(2, 150))
    jacobian[:, :, 63] = jacobian[:, :, 0] - jacobian[:, :, 1]
    jacobian[:, :empty] = 0.0
    short, rest = least_change.reduced(jacobian, missed)
    assert short.shape == (2, 64, 64)
    full, less = (np.linalg.svd(a, compute_uv=False) for a in (jacobian, short))
    assert np.abs(full - less).max() < 1e-13 * full.max()
    for k in range(2):
        expected = np.linalg.pinv(jacobian[k], rcond=1e-9) @ missed[k]
        assert np.abs(np.linalg.pinv(short[k], rcond=1e-9) @ rest[k] - expected).max() < 1e-13


def test_a_large_block_moves_alike_with_triangular_equations(monkeypatch):
    mechanism, *_ = KNOWN["parallelogram"]
    _, plain = count(build(mechanism))
    for module in (closing, least_change):
        monkeypatch.setattr(module, "REDUCED_RATES", 1)
    _, reduced = count(build(mechanism))
    assert reduced.count == plain.count == 1 and reduced.certificates == plain.certificates


def test_a_row_of_coupled_parallelograms_in_one_block_moves():
    mechanism, last = [], "base"
    for k in range(12):
        mechanism += [hinge("base", f"crank{k}", (3 * k, 0, 0))]
        if k:
            mechanism += [
                hinge(last, f"bar{k}", (3 * k - 3, 1, 0)), hinge(f"bar{k}", f"crank{k}", (3 * k, 1, 0)),
            ]  # fmt: skip
        last = f"crank{k}"
    first, found = count(build(mechanism), size=36.0)
    assert (first, found.count) == (1, 1)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6), st.integers(4, 7))
def test_random_planar_loops_have_all_but_three(seed, bars):
    points = np.random.default_rng(seed).normal(size=(bars, 2))
    assert figures(planar(*points))[:3] == (bars - 3, bars - 3, 0)


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.integers(6, 9))
def test_random_spatial_loops_have_all_but_six(seed, bars):
    assert figures(generic(bars, seed))[:2] == (bars - 6, bars - 6)


@settings(max_examples=10, deadline=None)
@given(st.floats(-0.9, 0.9), st.floats(0.5, 3.0))
def test_the_stepped_pose_of_a_crank_is_where_trigonometry_puts_it(angle, length):
    edges = [(0, 1), (1, 2), (2, 3), (0, 3)]
    joints = build(slider_crank())
    system = loop_system(edges, [one.twists for one in joints], Frame(np.zeros(3), length))
    # crank turned by `angle`: the rod of length √10 keeps its end on the x axis
    pin = np.array([np.cos(np.pi / 4 + angle), np.sin(np.pi / 4 + angle)]) * np.sqrt(2.0)
    end = pin[0] + np.sqrt(10.0 - pin[1] ** 2)
    tilt = np.arctan2(-pin[1], end - pin[0]) - np.arctan2(-1.0, 3.0)
    q = np.array([[angle, tilt - angle, -tilt, (end - 4.0) / length]])
    assert np.abs(system.equations(q).residual).max() < 1e-12


def test_the_jacobian_is_the_change_of_the_residual_and_the_curvature_that_of_the_jacobian():
    mechanism = [*generic(7, 4), ("base", "link3", "universal", X, np.ones(3), turned(90)), *ball_truss()]
    joints = build(mechanism)
    names = sorted({name for one in joints for name in one.bodies})
    index = {name: k for k, name in enumerate(names)}
    edges = [(index[one.bodies[0]], index[one.bodies[1]]) for one in joints]
    system = loop_system(edges, [one.twists for one in joints], Frame(np.zeros(3), 1.5))
    rng = np.random.default_rng(0)
    u, h = rng.normal(size=(1, system.coordinates)), 1e-5
    origin = np.zeros((1, system.coordinates))
    here = system.equations(origin)
    ahead, behind = system.equations(h * u), system.equations(-h * u)
    assert np.allclose((ahead.residual - behind.residual) / (2 * h), here.jacobian[0] @ u[0], atol=1e-8)
    # twists of the bodies away from the pose are those of the columns: differentiate J(t u) u, up to closure
    bent = (ahead.jacobian[0] - behind.jacobian[0]) @ u[0] / (2 * h)
    assert np.allclose(bent, system.curvature(here.columns[0], u)[0], atol=1e-7)


def test_a_row_of_flat_parallelograms_goes_on_in_every_combination():
    bars = [hinge("base", f"crank{k}", (3 * k, 0, 0)) for k in range(3)]
    for k in (1, 2):
        bars += [hinge(f"crank{k - 1}", f"bar{k}", (3 * k - 2, 0, 0)), hinge(f"bar{k}", f"crank{k}", (3 * k + 1, 0, 0))]
    first, found = count(build(bars))
    assert (first, found.count, found.infinitesimal) == (3, 1, 0)
    # each cell goes on as a parallelogram, or crossed
    assert found.certificates[0].branches == (1, 1, 1, 1)


def test_a_folded_hexagon_is_singular_but_no_crossing_of_branches():
    first, found = count(build(planar(*[(k % 2, 0) for k in range(6)])))
    assert (first, found.count, found.singular) == (4, 3, True)
    assert found.certificates[0].branches == (3,)


def test_a_platform_on_equal_parallel_legs_is_shaky_wherever_it_goes():
    feet = np.c_[np.random.default_rng(1).normal(size=(4, 2)), np.zeros(4)]
    legs = []
    for k, foot in enumerate(feet):
        top = foot + (0.3, 0.2, 2.0)
        along = (top - foot) / np.linalg.norm(top - foot)
        across = np.cross(along, X) / np.linalg.norm(np.cross(along, X))
        legs += [
            ("base", f"leg{k}", "universal", across, foot, np.cross(along, across)),
            ("plate", f"leg{k}", "spherical", None, top, None),
        ]  # fmt: skip
    # it swings in two directions; that it also twists is true of velocities only
    assert figures(legs) == (3, 2, 1, False)


def test_spherical_four_bar_at_its_flat_pose_is_a_bifurcation():
    # arcs that add up in pairs lie on one great circle
    angles = (0.0, 30.0, 80.0, 50.0)
    axes = [turned(a) for a in angles]
    first, found = count(build(ring(axes, axes)))
    assert (first, found.count, found.singular) == (2, 1, True)
