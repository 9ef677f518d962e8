"""Trees and loops of joints, without any mechanics."""

from __future__ import annotations

from kinform.simulation.mechanism.topology import arrange


def test_a_chain_is_carried_from_the_ground_outwards():
    found = arrange(3, [(0, 1), (1, 2)], [False, False], ground=1)
    assert [(step.joint, step.forward) for step in found.carried] == [(0, False), (1, True)]
    assert found.closing == ()
    assert found.adrift == ()


def test_every_joint_left_over_closes_one_loop():
    joints = [(0, 1), (1, 2), (2, 3), (0, 3), (1, 3)]
    found = arrange(4, joints, [False] * 5, ground=0)
    assert len(found.carried) == 3
    assert sorted([step.joint for step in found.carried] + list(found.closing)) == [0, 1, 2, 3, 4]


def test_rigid_joints_make_one_node_and_close_nothing():
    found = arrange(4, [(0, 1), (1, 2), (2, 3), (1, 3)], [False, True, True, True], ground=0)
    assert found.node_of == (0, 1, 1, 1)
    assert len(found.carried) == 1
    assert found.closing == ()


def test_a_body_fixed_to_the_ground_is_ground():
    assert arrange(2, [(0, 1)], [True], ground=1).node_of == (0, 0)


def test_a_joint_within_one_rigid_group_closes_a_loop():
    found = arrange(3, [(0, 1), (1, 2), (0, 2)], [True, False, False], ground=0)
    assert len(found.carried) == 1
    assert len(found.closing) == 1


def test_bodies_that_nothing_connects_are_adrift_with_their_joints():
    found = arrange(4, [(0, 1), (2, 3)], [False, False], ground=0)
    assert found.adrift == (2, 3)
    assert found.node_of == (0, 1, -1, -1)
    assert found.closing == ()
