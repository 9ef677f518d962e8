"""Cams and flanks touch along lines with the normal of the smooth curves, not of the facets."""

from __future__ import annotations

import numpy as np
import pytest
from support.diagonal import diagonal
from support.solids import derived, extrusion, random_pose, rod


def ellipse(a, b, segments, phase=0.0):
    t = 2 * np.pi * (np.arange(segments) + phase) / segments
    return np.stack([a * np.cos(t), b * np.sin(t)], axis=1)


def touching_ellipses(angle, segments, other=48):
    """Two elliptic discs that touch at a point of the first with parameter `angle`, with its outward normal there."""
    a, b, c, d = 12.0, 8.0, 9.0, 5.0
    point = np.array([a * np.cos(angle), b * np.sin(angle)])
    normal = np.array([np.cos(angle) / a, np.sin(angle) / b])
    normal /= np.linalg.norm(normal)
    # the second's end of its short axis looks back along the normal
    spin = np.array([[normal[1], normal[0]], [-normal[0], normal[1]]])
    second = ellipse(c, d, other, 0.37) @ spin.T + point + d * normal
    solids = {"a": extrusion(ellipse(a, b, segments, 0.21), 0, 6), "b": extrusion(second, 1, 8)}
    return solids, point * 1e-3, normal


@diagonal(angle=[0.4, 1.3, 2.9], segments=[36, 80])
def test_two_cams_touch_with_the_normal_of_their_curves(segments, angle):
    solids, point, normal = touching_ellipses(angle, segments)
    X = random_pose(np.random.default_rng(segments))
    kinematics, contacts = derived(X, **solids)
    (patch,) = contacts.patches
    assert patch.kind == "line"
    assert patch.fit in ("touch", "transition")
    turn = np.linalg.norm(np.cross(patch.normals[0], X[:3, :2] @ normal))
    assert turn < max(3 * patch.uncertainty[0], 1e-6)
    assert turn < 0.2 * np.pi / segments
    local = (patch.points - X[:3, 3]) @ X[:3, :3]
    assert np.linalg.norm(local[:, :2] - point, axis=1).max() < max(3 * patch.uncertainty[1], 1e-6)
    assert local[:, 2].min() >= 1e-3
    assert local[:, 2].max() <= 6e-3
    assert kinematics.joints[0].type == "general"
    assert kinematics.joints[0].freedoms == 4


def test_a_cam_that_also_rubs_on_a_face_across_it_keeps_its_line():
    solids, _, normal = touching_ellipses(0.8, 60)
    flange = rod(4, 6, 8).translate((*(9.0 * normal), 0.0))
    kinematics, contacts = derived(a=solids["a"], b=solids["b"] + flange)
    assert sorted(patch.kind for patch in contacts.patches) == ["line", "plane"]
    assert (kinematics.joints[0].type, kinematics.joints[0].freedoms) == ("general", 2)
    assert kinematics.joints[0].status == "determined"


def test_cams_apart_do_not_touch():
    solids, _, normal = touching_ellipses(0.9, 48)
    solids["b"] = solids["b"].translate((*(0.4 * normal), 0))
    assert not [patch for patch in derived(**solids)[1].patches if patch.kind == "line"]


def test_the_order_of_parts_does_not_matter():
    solids, _, _ = touching_ellipses(1.1, 48)
    (one,) = derived(**solids)[1].patches
    (two,) = derived(a=solids["b"], b=solids["a"])[1].patches
    assert one.normals[0] == pytest.approx(-two.normals[0], abs=1e-9)
    assert one.point == pytest.approx(two.point, abs=1e-9)
