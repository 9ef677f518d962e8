"""Whether a motion is there: between two bodies, and in the assembly, with contacts that only push."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from support.assemblies import assembly, between, contacts, part
from support.four_bar import four_bar, hinge
from support.patches import Z, cylinder, plane, ring

from kinform.design import Design
from kinform.kinematics import derive, query

X, Y = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])


def design(model, *patches):
    touching = contacts(*patches)
    return Design(model, contacts=touching, kinematics=derive(model, {}, touching))


def collared():
    return cylinder(), ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z)


@cache
def two_parts():
    return assembly(part("a"), part("b"), ground="a")


def test_a_query_says_which_way_a_block_leaves_its_table():
    made = design(two_parts(), plane())
    up = query(made, "a", "b", slide=Z)
    assert (up.free_in_pair, up.pair_ways, up.assembly_ways) == (False, (True, False), (True, False))
    down = query(made, "a", "b", slide=-Z)
    assert (down.pair_ways, down.assembly_ways) == ((False, True), (False, True))
    assert [b.patch for b in down.assembly_blocked_by] == [0]
    # asked of the table: it leaves the block downwards
    assert query(made, "b", "a", slide=-Z).pair_ways == (True, False)
    assert query(made, "a", "b", slide=X).pair_ways == (True, True)


def test_tipping_about_an_edge_is_there_and_about_the_middle_is_not():
    made = design(two_parts(), plane(size=(0.02, 0.02)))
    edge = query(made, "a", "b", turn=(Y, np.array([0.01, 0, 0])))
    assert edge.pair_ways == (True, False)
    assert query(made, "a", "b", turn=(Y, np.zeros(3))).pair_ways == (False, False)


def test_the_assembly_can_block_what_a_pair_lets_go_and_says_where():
    parts = assembly(part("base"), part("block"), part("roof"), ground="base")
    under = between(plane((0, 0, 0)), "base", "block")
    over = between(plane((0, 0, 0.02)), "block", "roof")
    post = between(cylinder(point=(0.1, 0, 0)), "base", "roof")
    caps = [between(ring((0.1, 0, z), normal=n), "base", "roof") for z, n in ((0.01, Z), (-0.01, -Z))]
    made = design(parts, under, over, post, *caps)
    answer = query(made, "base", "block", slide=Z)
    assert answer.pair_ways == (True, False)
    assert answer.assembly_ways[0] is False
    assert answer.assembly_blocked_by
    # without the contacts that are named, it goes
    named = {b.patch for b in answer.assembly_blocked_by}
    rest = [p for k, p in enumerate(made.contacts.patches) if k not in named]
    assert query(design(parts, *rest), "base", "block", slide=Z).assembly_ways[0] is True
    # and each of them is needed
    for spared in named:
        rest = [p for k, p in enumerate(made.contacts.patches) if k not in named - {spared}]
        assert query(design(parts, *rest), "base", "block", slide=Z).assembly_ways[0] is False


def test_queries_answer_for_the_pair_and_for_the_whole():
    model, touching = four_bar()
    design = Design(model, contacts=touching, kinematics=derive(model, {}, touching))
    there = query(design, "crank", "link", turn=(np.array([0, 0, 2.0]), np.array([0, 0.1, 0])))
    assert (there.free_in_pair, there.free_in_assembly, there.blocked_by) == (True, True, ())
    blocked = query(design, "base", "crank", slide=np.array([0, 0, 1.0]))
    assert (blocked.free_in_pair, blocked.free_in_assembly) == (False, False)
    assert {b.kind for b in blocked.blocked_by} == {"plane"}
    apart = query(design, "base", "link", slide=np.array([0, 0, 1.0]))
    assert (apart.free_in_pair, apart.free_in_assembly) == (None, False)
    with pytest.raises(KeyError):
        query(design, "base", "crnak", slide=np.array([0, 0, 1.0]))
    with pytest.raises(ValueError):  # noqa: PT011
        query(design, "base", "crank", slide=np.zeros(3))


def test_a_joint_at_its_stop_is_free_one_way_only_in_a_query():
    model = assembly(part("base"), part("door"), ground="base")
    stray = between(plane((0.02, 0, 0), (0, 1, 0), (0.002, 0.002), area=2e-5), "base", "door")
    touching = contacts(*hinge("base", "door", (0, 0, 0)), stray)
    design = Design(model, contacts=touching, kinematics=derive(model, {}, touching))
    assert [touching.patches[one.patch].area for one in design.kinematics.joints[0].at_stop] == [2e-5]
    turn = query(design, "base", "door", turn=(Z, np.zeros(3)))
    assert (turn.free_in_pair, turn.free_in_assembly) == (False, False)
    assert [touching.patches[b.patch].area for b in turn.blocked_by] == [2e-5]
    assert len(query(design, "base", "door", slide=Z).blocked_by) > 1
