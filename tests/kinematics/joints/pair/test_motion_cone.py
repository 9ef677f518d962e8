"""The cone of motions of a pair: oracles are analytic, at random poses, sizes and orders of the patches."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation
from support.patches import Z, cone, cylinder, plane, ring, sphere

from kinform.kinematics.joints.bodies.admitted import admits, admitted_senses
from kinform.kinematics.joints.pair.decision import decide
from kinform.kinematics.joints.pair.evidence import gather
from kinform.kinematics.joints.pair.motion_cone import nearest_within
from kinform.model.tolerances import Tolerances

X, Y = np.eye(3)[0], np.eye(3)[1]
CONTACT = 5e-4
COLLARS = [ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z)]
WALLS = [plane(0.01 * n, n, (0.02, 0.02)) for n in (X, -X, Y, -Y)]
JAMB = plane((0.03, -0.003, 0), -Y, (0.002, 0.002))
LEANING = np.array([np.sin(1.0), 0.0, np.cos(1.0)])


CASES = {
    "bore with collars": ([cylinder(), *COLLARS], 1, 1, False),
    "bore with one collar": ([cylinder(), COLLARS[0]], 1, 2, False),
    "block on a table": ([plane()], 3, 6, True),
    "slot with end wall": (
        [plane(s * 0.01 * X, s * X, (0.02, 0.02)) for s in (1, -1)]
        + [plane(s * 0.01 * Z, s * Z, (0.02, 0.02)) for s in (1, -1)]
        + [plane(0.01 * Y, Y, (0.02, 0.02))],
        0,
        1,
        False,
    ),
    "pocket": ([*WALLS, plane((0, 0, -0.01), -Z, (0.02, 0.02))], 0, 1, False),
    "dovetail": (
        [plane((0, 0, 0), -Z), plane(0.01 * X, LEANING), plane(-0.01 * X, LEANING * [-1, 1, 1])],
        1,
        1,
        False,
    ),
    "ball in a cup below the equator": ([sphere(cap=-0.5)], 3, 6, True),
    "ball in a cup beyond the equator": ([sphere(cap=0.3)], 3, 3, False),
    "half bearing": ([cylinder(arc=(-0.1, np.pi - 0.1))], 2, 4, True),
    "cone in its seat": ([cone()], 1, 4, True),
    "door on its jamb": ([cylinder(), *COLLARS, JAMB], 0, 1, False),
    "lever between two stops": (
        [cylinder(), *COLLARS, JAMB, plane((0.03, 0.003, 0), Y, (0.002, 0.002))],
        0,
        0,
        False,
    ),
}


def moved(patch, turn, scale, shift):
    """The patch of the same contact at another attitude, size and place."""
    return replace(
        patch,
        points=scale * turn.apply(patch.points) + shift,
        normals=turn.apply(patch.normals),
        weights=scale**2 * patch.weights,
        area=scale**2 * patch.area,
        gaps=scale * patch.gaps,
        gap=scale * patch.gap,
        axis=turn.apply(patch.axis),
        point=scale * turn.apply(patch.point) + shift,
        radii=patch.radii if patch.kind == "cone" else tuple(scale * r for r in patch.radii),
        uncertainty=(patch.uncertainty[0], scale * patch.uncertainty[1]),
    )


def decision(patches, contact=CONTACT):
    return decide(gather([(k, p, False) for k, p in enumerate(patches)], Tolerances(), contact), Tolerances())


def counts(found):
    return found.cone.rest.shape[1], found.cone.closed.shape[1], found.cone.plainly_open


@pytest.mark.parametrize("name", CASES)
def test_what_is_at_rest_closed_and_open_is_that_of_the_mechanics(name):
    patches, *expected = CASES[name]
    assert counts(decision(patches)) == tuple(expected)


@pytest.mark.parametrize("name", CASES)
@settings(max_examples=6, deadline=None)
@given(
    turn=st.integers(0, 2**31 - 1),
    scale=st.sampled_from([1e-2, 0.37, 1.0, 1e3]),
    shift=st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3),
    order=st.randoms(use_true_random=False),
)
def test_attitude_size_place_and_order_do_not_matter(name, turn, scale, shift, order):
    patches, *expected = CASES[name]
    rotation = Rotation.random(random_state=turn)
    there = [moved(p, rotation, scale, scale * np.array(shift)) for p in patches]
    order.shuffle(there)
    found, plain = decision(there, CONTACT * scale), decision(patches)
    assert counts(found) == tuple(expected)
    assert (found.form.type, found.status) == (plain.form.type, plain.status)
    assert len(found.ended) == len(plain.ended)


@pytest.mark.parametrize("side", [1, -1])
def test_the_other_side_of_the_jamb_reverses_the_sense(side):
    jamb = plane((0.03, -0.003 * side, 0), -side * Y, (0.002, 0.002))
    found = decision([cylinder(), *COLLARS, jamb])
    [(k, motion, sense)] = found.ended
    assert (found.form.type, found.status, k) == ("revolute", "determined", 3)
    assert sense * motion.axis[2] == side


def test_a_lever_between_two_stops_that_both_touch_is_fixed():
    found = decision(CASES["lever between two stops"][0])
    assert (found.form.type, found.status, found.ended) == ("fixed", "determined", ())


def test_the_motion_inside_opens_what_is_open_and_keeps_no_contact():
    found = decision([plane()])
    assert found.cone.inside[5] > 0.0
    assert found.cone.opened.all()


@st.composite
def distance_problems(draw):
    """Half spaces that contain zero, and a point; some are repeated, so that they tie."""
    seed, size = draw(st.integers(0, 2**31 - 1)), draw(st.integers(1, 6))
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(draw(st.integers(1, 12)), size))
    if draw(st.booleans()):
        rows = np.vstack([rows, rows])
    if draw(st.booleans()):
        rows = np.round(rows)
        assume((np.linalg.norm(rows, axis=1) > 0.0).all())
    rows /= np.linalg.norm(rows, axis=1)[:, None]
    point = rng.normal(size=size)
    return rows, np.full(len(rows), draw(st.sampled_from([1e-3, 0.1]))), point / np.linalg.norm(point)


@settings(max_examples=60, deadline=None)
@given(distance_problems())
def test_the_nearest_point_of_the_cone_is_that_of_another_method(problem):
    rows, slack, point = problem
    found = nearest_within(rows, slack, point)
    assert (rows @ found >= -slack - 1e-6).all()
    other = minimize(
        lambda x: ((x - point) ** 2).sum(),
        np.zeros(len(point)),
        jac=lambda x: 2.0 * (x - point),
        constraints={"type": "ineq", "fun": lambda x: rows @ x + slack, "jac": lambda x: rows},
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 300},
    )
    assume(other.success)
    assert found == pytest.approx(other.x, abs=1e-5)


def test_contact_admits_a_motion_that_it_only_pushes():
    table = [plane(parts=("table", "block"))]
    lift, slide = np.array([0, 0, 0, 0, 0, 1.0]), np.array([0, 0, 0, 1.0, 0, 0])
    assert admitted_senses(table, lift, {"table"}) == (True, False)
    assert admitted_senses(table, lift, {"block"}) == (False, True)
    assert admitted_senses(table, slide, {"table"}) == (True, True)
    held = [*table, plane((0, 0, 0.01), -Z, parts=("table", "block"))]
    assert not admits(held, np.array([lift]), {"table"})
    assert admits(held, np.array([slide]), {"table"})
    assert not admits(held, np.array([slide, lift]), {"table"})
    assert not admits(held, np.zeros((0, 6)), {"table"})


def test_no_contact_admits_all():
    assert admitted_senses([], np.ones(6), {"table"}) == (True, True)
