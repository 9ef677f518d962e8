"""Linkages that move by their proportions close all along their motion, and nothing is bent into moving."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.diagonal import diagonal
from support.linkages import bennett, bricard, planar, ring

from kinform.foundation.algebra.screws import Frame
from kinform.kinematics.joints.axes.bounds import MoveBounds
from kinform.kinematics.joints.axes.misfit import misfit_of, moves_between
from kinform.kinematics.joints.axes.proportions import fit_proportions
from kinform.kinematics.joints.pair.joint import twists_of
from kinform.mechanism.joint_graph import JointGraph
from kinform.mechanism.loop_system import loop_system
from kinform.model.kinematics import Body, Joint

MECHANISMS = {"Bennett": lambda: ring(*bennett()), "Bricard": bricard}


def joints_of(mechanism, error=0.0, seed=0):
    """Hinges, each turned and shifted at random by about `error` (rad, and m)."""
    rng = np.random.default_rng(seed)
    out = []
    for first, second, kind, axis, point, _ in mechanism:
        axis = axis + error * rng.normal(size=3)
        axis = axis / np.linalg.norm(axis)
        point = point + error * rng.normal(size=3)
        a, b = sorted((first, second))
        out.append(
            Joint(
                f"{a}~{b}", (a, b), kind, axis, point, None, None, 1, twists_of(kind, axis, point, None, None),
                (), "determined", "", (), (), np.zeros(6),
            )
        )  # fmt: skip
    return out


def graph_of(joints):
    names = sorted({name for j in joints for name in j.bodies})
    return JointGraph(tuple(Body(name, (name,), name == "base") for name in names), tuple(joints))


def bounds_of(sigma):
    """Bounds of three standard uncertainties, well within any alignment."""
    return MoveBounds(sigma, np.full_like(sigma, 0.003), np.zeros_like(sigma))


def gap(joints, angle=1.2):
    """What is left open (rad, and shares of the size) when the linkage is led on by `angle`, in steps."""
    names = sorted({name for joint in joints for name in joint.bodies})
    edges = [tuple(names.index(body) for body in joint.bodies) for joint in joints]
    system = loop_system(edges, [j.twists for j in joints], Frame.of(np.array([j.point for j in joints])))
    q, rank = np.zeros(len(joints)), len(joints) - 1
    _, _, right = np.linalg.svd(system.equations(q[None]).jacobian[0])
    ahead = right[-1]
    for _ in range(24):
        q = q + angle / 24 * ahead / np.abs(ahead).max()
        for _ in range(8):
            closed = system.equations(q[None])
            left, values, right = np.linalg.svd(closed.jacobian[0])
            q = q - ((left[:, :rank].T @ closed.residual[0]) / values[:rank]) @ right[:rank]
        ahead = right[-1] * np.sign(right[-1] @ ahead)
    return np.abs(system.equations(q[None]).residual).max()


@diagonal(2, name=list(MECHANISMS), seed=range(3))
def test_roundings_of_a_mesh_file_are_taken_out_of_the_whole_motion(name, seed):
    joints = joints_of(MECHANISMS[name](), 2e-9, seed)
    assert gap(joints) > 1e-10
    sigma = np.full((len(joints), 2), 1e-8)
    fitted = fit_proportions(graph_of(joints), bounds_of(sigma), 2.0)
    assert gap(fitted) < 1e-12
    assert gap(fitted, -0.8) < 1e-13
    moved = max(np.linalg.norm(np.cross(a.axis, b.axis)) for a, b in zip(joints, fitted, strict=True))
    assert 0.0 < moved < 3e-8
    moves = moves_between(joints, fitted)
    assert misfit_of(moves).angle == pytest.approx(moved)
    assert {move.joint for move in moves} == {joint.name for joint in joints}


@pytest.mark.parametrize("name", MECHANISMS)
def test_errors_beyond_the_uncertainty_stay_and_no_misfit_is_claimed(name):
    joints = joints_of(MECHANISMS[name](), 1e-5)
    fitted = fit_proportions(graph_of(joints), bounds_of(np.full((len(joints), 2), 1e-8)), 2.0)
    assert all(a is b for a, b in zip(joints, fitted, strict=True))
    assert moves_between(joints, fitted) == ()


def test_the_least_moves_are_those_of_the_least_certain_axes():
    """One hinge known a thousand times worse than the others takes it all, as far as it is in the way at all."""
    joints = joints_of(MECHANISMS["Bricard"]())
    worst = replace(joints[2], axis=joints[2].axis + np.array([0.0, 3e-6, 0.0]))
    joints[2] = replace(worst, twists=twists_of("revolute", worst.axis, worst.point, None, None))
    sigma = np.full((len(joints), 2), 1e-8)
    sigma[2, 0] = 1e-5
    fitted = fit_proportions(graph_of(joints), bounds_of(sigma), 2.0)
    moved = [np.linalg.norm(np.cross(a.axis, b.axis)) for a, b in zip(joints, fitted, strict=True)]
    assert 1e-6 < moved[2] < 3.1e-6
    assert max(moved[:2] + moved[3:]) < 1e-8
    assert gap(fitted) < 1e-12


def test_loops_that_fit_exactly_are_left_alone():
    joints = joints_of(planar((0, 0), (0, 2), (3, 3), (4, 0)))
    fitted = fit_proportions(graph_of(joints), bounds_of(np.full((4, 2), 1e-8)), 2.0)
    assert all(a is b for a, b in zip(joints, fitted, strict=True))


def test_cranks_in_one_row_on_one_rod_close_all_along_their_turn():
    """Redundant within the plane too: three cranks of one length whose pins are off by roundings."""
    rng = np.random.default_rng(3)
    joints = []
    for k, x in enumerate((0.0, 1.0, 2.1)):
        crank, pin = f"crank{k}", np.array([x + 0.3, 0.4, 0.0])
        for a, b, point in (("base", crank, np.array([x, 0.0, 0.0])), (crank, "rod", pin)):
            point = point + 2e-9 * np.array([*rng.normal(size=2), 0.0])
            joints += joints_of([(a, b, "revolute", np.eye(3)[2], point, None)])
    assert gap(joints) > 1e-10
    fitted = fit_proportions(graph_of(joints), bounds_of(np.full((len(joints), 2), 1e-8)), 2.0)
    assert gap(fitted) < 1e-12
    assert 0.0 < max(move.distance for move in moves_between(joints, fitted)) < 1e-8
