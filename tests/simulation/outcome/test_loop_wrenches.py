"""What joints carry round closed loops, against least squares over all joints at once."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.spatial.transform import Rotation

from kinform.simulation.outcome import loop_freedoms
from kinform.simulation.outcome.loop_wrenches import Shares, about, add_loops

LENGTH = 0.4
TIMES = 3
LOOPS = {0: (0, 1, 2, 3), 1: (3, 4, 5, 6), 2: (7, 8, 9), 3: (10, 11)}
"""Joints of each loop: two that share one, one that shares none, and one of two hinges."""


def posed(rng, coaxial, planar):
    """Shares, screws (T, n, 6) and points (T, J, 3) of hinges, one a joint; with `planar` all axes of a loop are
    parallel, in no direction of the world, and with `coaxial` both hinges of the last loop lie on one line."""
    joints = 1 + max(max(own) for own in LOOPS.values())
    by_loops = np.zeros((joints, len(LOOPS)))
    for loop, own in LOOPS.items():
        by_loops[list(own), loop] = rng.choice([-1.0, 1.0], len(own))
        by_loops[own[-1], loop] = 1.0
    points = rng.normal(size=(TIMES, joints, 3))
    axes = rng.normal(size=(TIMES, joints, 3))
    if planar:
        turn = Rotation.random(TIMES, random_state=rng).as_matrix()
        axes = np.repeat(turn[:, None, :, 2], joints, axis=1)
    if coaxial:
        axes[:, 11], points[:, 11] = axes[:, 10], points[:, 10] + 0.3 * axes[:, 10]
    axes /= np.linalg.norm(axes, axis=2, keepdims=True)
    screws = np.concatenate([axes, np.cross(points, axes)], axis=2)
    closing = np.array([own[-1] for own in LOOPS.values()])
    gears = np.zeros((0, joints))
    return Shares(by_loops, closing, np.arange(joints), gears, LENGTH, np.ones(joints)), screws, points


def by_least_squares(carried, shares, screws, points, effort):
    """(T, J, 6) wrenches on joints about their points, (T, J, 6) how far each could be otherwise, the number of
    conditions."""
    unit = np.array([LENGTH] * 3 + [1.0] * 3)
    joints, loops = shares.by_loops.shape
    out, open_, rank = np.zeros_like(carried), np.zeros_like(carried), 0
    for t in range(TIMES):
        rows = np.einsum("jc,jk->jck", shares.by_loops, screws[t]).reshape(joints, 6 * loops)
        at = np.eye(6)[None].repeat(joints, axis=0)
        at[:, :3, 3:] = -np.array([np.cross(point, np.eye(3), axisb=0, axisc=0) for point in points[t]])
        to_points = np.einsum("jc,jkl->jkcl", shares.by_loops, at / unit[:, None]).reshape(6 * joints, 6 * loops)
        # torques over the length, about the joint of each loop: as the conditions are weighed
        weigh = np.zeros((6 * loops, 6 * loops))
        for c, joint in enumerate(shares.closing):
            lever = np.diag(unit)
            lever[:3, 3:] = np.cross(points[t, joint], np.eye(3), axisb=0, axisc=0)
            weigh[6 * c : 6 * c + 6, 6 * c : 6 * c + 6] = lever
        rows, to_points = rows @ weigh, to_points @ weigh
        rank = int(np.linalg.matrix_rank(rows, tol=1e-9))
        tree = (about(carried[t : t + 1], points[t : t + 1])[0] / unit).ravel()
        special = np.linalg.pinv(rows, rcond=1e-9) @ (effort[t] - np.einsum("jk,jk->j", screws[t], carried[t]))
        free = to_points @ null_space(rows, rcond=1e-9)
        best = tree + to_points @ special
        best = best - free @ np.linalg.lstsq(free, best, rcond=None)[0]
        out[t] = best.reshape(joints, 6) * unit
        open_[t] = np.abs(free).max(axis=1).reshape(joints, 6)
    return out, open_, rank


@pytest.mark.parametrize("few_meet", [0.0, 1.0])
@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("coaxial", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_wrenches_round_loops_are_the_least_over_all_joints(monkeypatch, few_meet, planar, coaxial, seed):
    monkeypatch.setattr(loop_freedoms, "FEW_MEET", few_meet)
    rng = np.random.default_rng(seed)
    shares, screws, points = posed(rng, coaxial, planar)
    carried, effort = rng.normal(size=points.shape[:2] + (6,)), rng.normal(size=points.shape[:2])
    if coaxial:  # hinges on one line are turned by one torque, or no wrench is in balance
        carried[:, [10, 11]], effort[:, [10, 11]] = 0.0, 0.0
    expected, open_, rank = by_least_squares(carried, shares, screws, points, effort)
    got, loose, stresses = add_loops(carried, shares, screws, points, effort, rank)
    assert np.allclose(got, expected, rtol=0, atol=1e-8 * np.abs(expected).max())
    assert np.array_equal(loose, open_.max(axis=0) > 1e-6)
    assert loose.any() == (len(stresses) > 0)
    along = np.einsum("znk,nk->zn", at_centre(stresses, points[0]), screws[0])
    assert np.abs(along).max(initial=0.0) < 1e-9, "what could be added does no work along any freedom"


def at_centre(wrenches, points):
    out = wrenches.copy()
    out[..., :3] += np.cross(points, wrenches[..., 3:])
    return out
