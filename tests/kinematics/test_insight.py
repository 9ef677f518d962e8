"""The evidence of a joint, and queries answered with contacts that only push."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from support.assemblies import assembly, between, contacts, intended, part
from support.patches import Z, cylinder, plane, ring

from kinform.design import Design
from kinform.kinematics import derive, insight, intended_answers, query

X, Y = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])


def design(model, *patches):
    touching = contacts(*patches)
    return Design(model, contacts=touching, kinematics=derive(model, {}, touching))


def hinge():
    return cylinder(), ring((0, 0, 0.01)), ring((0, 0, -0.01), normal=-Z)


@cache
def two_parts():
    return assembly(part("a"), part("b"), ground="a")


def test_a_collared_shaft_is_cylindrical_without_both_collars_and_planar_without_its_journal():
    made = design(two_parts(), *hinge())
    found = insight(made, "a~b")
    kinds = {k: p.kind for k, p in enumerate(made.contacts.patches)}
    others = {tuple(sorted(kinds[k] for k in item.without)): item for item in found.alternatives}
    assert {kinds: item.type for kinds, item in others.items()} == {
        ("cylinder",): "planar",
        ("plane", "plane"): "cylindrical",
    }
    assert "translation along (0, 0, 1)" in others[("plane", "plane")].frees
    # what is claimed is so: derived without those patches
    for item in found.alternatives:
        rest = [p for k, p in enumerate(made.contacts.patches) if k not in item.without]
        (joint,) = derive(two_parts(), {}, contacts(*rest)).joints
        assert (joint.type, joint.freedoms, joint.status) == (item.type, item.freedoms, item.status)


def test_the_gap_behind_the_decision_is_that_of_the_singular_values():
    found = insight(design(two_parts(), *hinge()), "a~b")
    assert found.last_free < found.free < found.held < found.first_held
    assert np.isclose(found.first_held, found.joint.singular_values[1])
    assert {item.role for item in found.patches} == {"carries"}
    assert sum(item.share for item in found.patches) == pytest.approx(1.0)
    assert found.rows == len(design(two_parts(), *hinge()).kinematics.matrix.patch)


def test_a_blocked_joint_names_the_patch_without_which_it_is_determined():
    stop = plane((0.02, 0, 0), Y, (0.002, 0.002), area=2e-5)
    made = design(two_parts(), *hinge(), stop)
    found = insight(made, "a~b")
    roles = {made.contacts.patches[item.index].area: item.role for item in found.patches}
    assert roles[2e-5] == "blocks"
    (freed,) = [item for item in found.alternatives if item.status == "determined" and item.type == "revolute"]
    assert [made.contacts.patches[k].area for k in freed.without] == [2e-5]


def test_an_unknown_joint_lists_those_there_are():
    with pytest.raises(KeyError, match="a~b"):
        insight(design(two_parts(), *hinge()), "b~a")


def test_a_query_says_which_way_a_block_leaves_its_table():
    made = design(two_parts(), plane())
    up = query(made, "a", "b", slide=Z)
    assert (up.free_in_pair, up.pair_ways, up.assembly_ways) == (False, (True, False), (True, False))
    assert "one way only: b leaves contact in +z" in up.text
    down = query(made, "a", "b", slide=-Z)
    assert (down.pair_ways, down.assembly_ways) == ((False, True), (False, True))
    assert "leaves contact in +z" in down.text
    assert [b.patch for b in down.assembly_blocked_by] == [0]
    # asked of the table: it leaves the block downwards
    assert query(made, "b", "a", slide=-Z).pair_ways == (True, False)
    assert query(made, "a", "b", slide=X).pair_ways == (True, True)


def test_tipping_about_an_edge_is_there_and_about_the_middle_is_not():
    made = design(two_parts(), plane(size=(0.02, 0.02)))
    edge = query(made, "a", "b", turn=(Y, np.array([0.01, 0, 0])))
    assert edge.pair_ways == (True, False)
    assert "the sense of +y" in edge.text
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


def test_every_intended_joint_is_answered():
    wanted = [
        intended("spin", "a", "b", "revolute"),
        intended("slip", "a", "b", "cylindrical"),
        intended("weld", "a", "b", "fixed", axis=None),
    ]
    made = design(assembly(part("a"), part("b"), ground="a", joints=wanted), *hinge())
    found = {item.joint.name: item for item in intended_answers(made)}
    assert {name: item.free for name, item in found.items()} == {"spin": True, "slip": False, "weld": False}
    turn, slide = found["slip"].motions
    assert (turn.answer.free_in_assembly, slide.answer.free_in_assembly) == (True, False)
    assert {made.contacts.patches[b.patch].kind for b in slide.answer.blocked_by} == {"plane"}
