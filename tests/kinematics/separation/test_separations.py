"""What can leave the whole assembly, alone or together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.assemblies import assembly, assume, between, contacts, part
from support.directions import same_directions, slides
from support.patches import Z, cylinder, plane, ring
from support.solids import random_pose

from kinform.kinematics import derive

X, Y = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])


def stack(*names):
    """Blocks one on the other, on a table."""
    levels = ["table", *names]
    patches = [between(plane((0, 0, 0.01 * k)), a, b) for k, (a, b) in enumerate(zip(levels, names, strict=False))]
    return derive(assembly(*(part(n) for n in levels), ground="table"), {}, contacts(*patches))


def test_what_stands_on_a_block_leaves_with_it():
    found = stack("c", "b", "a")
    assert [item.bodies for item in found.separations] == [("a",), ("a", "b"), ("a", "b", "c")]
    assert all(same_directions(slides(item.releases), [Z]) for item in found.separations)


def test_a_block_under_a_bridge_cannot_leave_alone():
    # a lid on two posts that are one with the ground, and a block that fills the room between ground and lid
    patches = [
        between(plane((0, 0, 0)), "ground", "block"),
        between(plane((0, 0, 0.02)), "block", "lid"),
        between(plane((0.05, 0, 0.02)), "ground", "lid"),
    ]
    parts = [part(n) for n in ("ground", "block", "lid")]
    found = derive(assembly(*parts, ground="ground"), {}, contacts(*patches))
    assert [item.bodies for item in found.separations] == [("block", "lid"), ("lid",)]
    bolted = derive(
        assembly(*parts, ground="ground", assume=[assume("ground", "lid", "fixed")]), {}, contacts(*patches)
    )
    assert bolted.separations == ()


def test_a_loop_can_hold_what_its_pairs_do_not():
    # a wedge pair: each block can leave the ground along z, but they hold each other down by a hooked edge
    patches = [
        between(plane((0, 0, 0)), "ground", "one"),
        between(plane((0.05, 0, 0.01), -Z), "ground", "two"),
        between(plane((0.02, 0, 0.02), Z), "one", "two"),
    ]
    parts = [part(n) for n in ("ground", "one", "two")]
    found = derive(assembly(*parts, ground="ground"), {}, contacts(*patches))
    pairs = {joint.name: joint.held for joint in found.joints}
    assert set(pairs.values()) == {False}
    assert all(len(slides(joint.releases)) == 1 for joint in found.joints)
    # one must rise to leave the ground, two must rise with it, and two may only sink from the ground
    assert not any(item.bodies == ("one",) and slides(item.releases) for item in found.separations)


def posed(patch, X, scale):
    """A patch of a scaled assembly, at a pose."""
    R, moved = X[:3, :3], lambda points: scale * np.asarray(points) @ X[:3, :3].T + X[:3, 3]
    return replace(
        patch, points=moved(patch.points), normals=patch.normals @ R.T, axis=R @ patch.axis, point=moved(patch.point),
        area=patch.area * scale**2, weights=patch.weights * scale**2, radii=tuple(scale * r for r in patch.radii),
    )  # fmt: skip


BORES = [
    ("fork", cylinder(point=(0, 0, -0.02), outward=-1)),
    ("fork", cylinder(point=(0, 0, 0.02), outward=-1)),
    ("arm", cylinder(point=(0, 0, 0), outward=-1)),
]
"""A pin along z in two cheeks of a fork, and in the arm between them."""
ABOVE, BELOW = ring((0, 0, 0.03), Z), ring((0, 0, -0.03), -Z)
CHEEKS = [
    between(plane((0, 0, 0.01)), "arm", "fork"), between(plane((0, 0, -0.01), -Z), "arm", "fork"),
]  # fmt: skip
"""Cheeks on both sides of the arm."""


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("heads", "leaves", "slides_"),
    [
        ([("fork", ABOVE)], [Z], []),
        ([("fork", BELOW)], [-Z], []),
        ([("fork", ABOVE), ("fork", BELOW)], [], []),
        ([("arm", ABOVE), ("fork", BELOW)], [], []),
        ([], [], [Z, -Z]),
    ],
    ids=["head", "head below", "two heads", "one at the arm", "no head"],
)
def test_a_pin_leaves_along_its_bores_past_the_side_where_it_has_no_head(heads, leaves, slides_, seed):
    X, scale = (np.eye(4), 1.0) if seed == 0 else (random_pose(np.random.default_rng(seed), 10.0), 10.0 ** (seed - 2))
    patches = CHEEKS + [between(patch, other, "pin") for other, patch in [*BORES, *heads]]
    parts = [part(n) for n in ("fork", "arm", "pin")]
    found = derive(assembly(*parts, ground="fork"), {}, contacts(*(posed(p, X, scale) for p in patches)))
    way = {item.bodies: item.releases for item in found.separations}
    free = {item.bodies: item.releases for item in found.slides}
    assert set(way) == ({("pin",)} if leaves else set())
    assert set(free) == ({("pin",)} if slides_ else set())
    assert same_directions(slides(way.get(("pin",), ())), [X[:3, :3] @ d for d in leaves])
    assert same_directions(slides(free.get(("pin",), ())), [X[:3, :3] @ d for d in slides_])


def test_a_turn_that_leaves_contact_closed_is_no_separation():
    hinge = [cylinder(), ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z)]
    jamb = plane((0.02, 0, 0), Y, (0.002, 0.002), area=2e-5)
    found = derive(assembly(part("a"), part("b"), ground="a"), {}, contacts(*hinge, jamb))
    assert found.joints[0].held is False
    assert found.separations == found.slides == ()
