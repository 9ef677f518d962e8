"""Sharp edges and corners that stand on planes have one row a point, with the normal of the plane."""

from __future__ import annotations

import numpy as np
import pytest
from support.solids import box, derived, extrusion, random_pose, rod


def table():
    return box(-30, 30, -30, 30, -5, 0)


def cube():
    return box(-5, 5, -5, 5, -5, 5)


def standing(solid):
    """The solid lowered, or raised, until it touches z = 0 from above."""
    return solid.translate((0, 0, -solid.bounding_box()[2]))


def wedge():
    return extrusion([(0, 0), (4, 10), (-3, 10)], -8, 8).rotate((90, 0, 0))


CASES = {
    "a knife edge": (4, ["line"], wedge),
    "a cube on its edge": (4, ["line"], lambda: cube().rotate((0, 45, 0))),
    "a cube on its corner": (5, ["point"], lambda: cube().rotate((45, np.degrees(np.arctan(np.sqrt(0.5))), 0))),
    "a disc on its rim": (5, ["point"], lambda: rod(6, 0, 3, 48).rotate((50, 0, 0))),
}


@pytest.mark.parametrize("name", sorted(CASES))
@pytest.mark.parametrize("swap", [False, True])
def test_an_edge_or_corner_holds_the_plane_it_stands_on(name, swap):
    freedoms, kinds, make = CASES[name]
    names = ("b", "a") if swap else ("a", "b")
    X = random_pose(np.random.default_rng(3))
    kinematics, contacts = derived(X, **dict(zip(names, (standing(make()), table()), strict=True)))
    assert [patch.kind for patch in contacts.patches] == kinds
    outward = X[:3, 2] if swap else -X[:3, 2]
    for patch in contacts.patches:
        assert patch.normals == pytest.approx(np.tile(outward, (len(patch.points), 1)), abs=1e-9)
        assert (patch.points - X[:3, 3]) @ X[:3, 2] == pytest.approx(np.zeros(len(patch.points)), abs=1e-7)
    (joint,) = kinematics.joints
    assert (joint.type, joint.freedoms, joint.status) == ("general", freedoms, "determined")


def test_an_edge_counts_only_where_the_plane_is():
    contacts = derived(a=standing(wedge()), b=table().translate((0, 25, 0)))[1]
    (patch,) = contacts.patches
    assert patch.kind == "line"
    assert patch.points[:, 1].min() > -5e-3
    assert not derived(a=standing(wedge()), b=table().translate((0, 45, 0)))[1].patches


@pytest.mark.parametrize("apart", [0.1, 1.0])
def test_an_edge_above_the_plane_does_not_touch(apart):
    assert not derived(a=standing(wedge()).translate((0, 0, apart)), b=table())[1].patches
