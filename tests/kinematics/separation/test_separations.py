"""What can leave the whole assembly, alone or together."""

from __future__ import annotations

import numpy as np
from support.assemblies import assembly, assume, between, contacts, part
from support.directions import same_directions, slides
from support.patches import Z, plane

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
