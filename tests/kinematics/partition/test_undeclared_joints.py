"""Joints that a function with all joints leaves out, or states as fixed: a lever and a wheel on pivots of a base."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import HERE, assembly
from support.solids import box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import kinematics
from kinform.consistency.comparisons.answers import answers
from kinform.design import Design
from kinform.model.function import Function, IntendedJoint

PIVOT, AXLE = (0.0, 0.0, 0.0), (70.0, 0.0, 0.0)
BASE = box(-30, 100, -30, 30, -10, 0) + rod(5, -1, 10, 48) + rod(4, -1, 10, 48).translate(AXLE)
LEVER = box(-8, 45, -8, 8, 0, 6) - rod(5.02, -1, 7, 48)
WHEEL = (rod(20, 0, 8, 64) - rod(4.02, -1, 9, 48)).translate(AXLE)
KNOB = rod(6, 6, 20, 32).translate((30, 0, 0))


def joint(name, between, type_, point, X, scale):
    axis = None if type_ == "fixed" else X[:3, 2]
    at = None if type_ == "fixed" else X[:3, :3] @ (scale * np.asarray(point)) + X[:3, 3]
    return IntendedJoint(name, between, type_, axis, None, at, None, None, HERE.file, None)


def derived(joints, X, scale, groups=(), backwards=False):
    """Assembly, contacts and kinematics."""
    solids = {"base": BASE, "lever": LEVER, "wheel": WHEEL, "knob": KNOB}
    names = list(reversed(solids)) if backwards else list(solids)
    whole = assembly(*(part(name, solids[name], X, scale) for name in names), groups=groups)
    whole = replace(whole, function=Function(joints=tuple(joint(*one, X, scale) for one in joints), complete=("",)))
    found, touching = touching_of(whole)
    return whole, touching, kinematics.derive(whole, found, touching)


def answer(whole, touching, K, name):
    given = answers(Design(assembly=whole, contacts=touching, kinematics=K))
    return next(one for one in given if one.name == name)


SPIN = ("spin", ("base", "wheel"), "revolute", AXLE)
TURN = ("turn", ("base", "lever"), "revolute", PIVOT)
STUCK = ("turn", ("base", "lever"), "fixed", PIVOT)
POSES = [(None, 1e-3, False), (0, 1e-3, True), (1, 1.0, False)]


@pytest.fixture(params=POSES, ids=["as drawn", "turned", "large"])
def placed(request):
    seed, scale, backwards = request.param
    X = np.eye(4) if seed is None else random_pose(np.random.default_rng(seed))
    return X, scale, backwards


def test_nothing_is_undeclared_where_all_joints_are_stated(placed):
    X, scale, backwards = placed
    whole, touching, K = derived([SPIN, TURN], X, scale, backwards=backwards)
    assert K.left_out == ()
    assert all(answer(whole, touching, K, name).answer == "agrees" for name in ("spin", "turn"))


def test_a_pivot_that_is_not_stated_is_found_in_its_body(placed):
    X, scale, backwards = placed
    _, _, K = derived([SPIN], X, scale, backwards=backwards)
    (one,) = K.left_out
    assert (one.body, one.type) == ("base", "revolute")
    assert (one.first, one.second) == (("base",), ("knob", "lever"))
    assert np.linalg.norm(np.cross(one.axis, X[:3, 2])) < 1e-6
    assert np.linalg.norm(np.cross(one.point - X[:3, 3], X[:3, 2])) < 1e-4 * scale * 100


def test_a_pivot_that_is_stated_as_fixed_is_not_held(placed):
    X, scale, backwards = placed
    whole, touching, K = derived([SPIN, STUCK], X, scale, backwards=backwards)
    given = answer(whole, touching, K, "turn")
    assert (given.answer, given.free) == ("not held", "revolute, 1 freedom by contact")
    assert {body.parts for body in K.bodies} == {("base", "knob", "lever"), ("wheel",)}


def test_a_pivot_is_not_held_either_where_all_is_stated_as_fixed(placed):
    X, scale, backwards = placed
    whole, touching, K = derived([STUCK], X, scale, backwards=backwards)
    given = answer(whole, touching, K, "turn")
    assert (given.answer, given.free) == ("not held", "revolute, 1 freedom by contact")
    whole, touching, K = derived([("grip", ("lever", "knob"), "fixed", PIVOT)], X, scale, backwards=backwards)
    assert answer(whole, touching, K, "grip").answer == "agrees"


def test_what_is_stated_as_fixed_and_cannot_turn_agrees(placed):
    X, scale, backwards = placed
    whole, touching, K = derived(
        [SPIN, TURN, ("grip", ("lever", "knob"), "fixed", PIVOT)], X, scale, backwards=backwards
    )
    assert answer(whole, touching, K, "grip").answer == "agrees"


def test_a_group_says_that_a_pivot_is_fastened(placed):
    X, scale, backwards = placed
    groups = (("frame", ("base", "lever")),)
    _, _, K = derived([SPIN], X, scale, groups=groups, backwards=backwards)
    assert K.left_out == ()
    assert answer(*derived([SPIN, STUCK], X, scale, groups=groups, backwards=backwards), "turn").answer == "agrees"


def test_the_rules_report_undeclared_joints():
    X, scale = np.eye(4), 1e-3

    def fired(joints):
        whole, touching, K = derived(joints, X, scale)
        from kinform import consistency
        from kinform.mass import compile_mass
        from kinform.simulation import simulate

        masses = compile_mass(whole, K)
        report = consistency.check(
            Design(assembly=whole, contacts=touching, kinematics=K, mass=masses, simulation=simulate(whole, K, masses))
        )
        return {(f.code, *f.subject, f.severity) for f in report.findings}

    assert ("KF416", "base", "warning") in fired([SPIN])
    stuck = fired([SPIN, STUCK])
    assert ("KF414", "turn", "error") in stuck
    assert not any(code in ("KF416", "KF402") for code, *_ in stuck)
    assert not any(code == "KF416" for code, *_ in fired([SPIN, TURN]))
