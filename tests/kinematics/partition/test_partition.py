"""Machines of bolted stacks, bearings, pins and horns: bodies from their joints, whichever parts these name, and joints
that are proposed where none is stated."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from random_assemblies.draw import Draw
from random_assemblies.machine_verdict import assembly_of, judge
from random_assemblies.machines import machine
from random_assemblies.rings import ring
from support.diagonal import first as first_of
from support.solids import box, part, rod
from support.touching import touching as touching_of

from kinform import kinematics, surfaces
from kinform.foundation.graphs.graph import UnionFind
from kinform.kinematics import propose, proposed_joints
from kinform.kinematics.joints.bodies.stated_joints import joint_twists
from kinform.kinematics.partition.contact import Contact
from kinform.kinematics.partition.label_merging import merge_by_cost, merge_labels
from kinform.kinematics.partition.labelling import Edge
from kinform.kinematics.partition.split_prices import prices
from kinform.kinematics.partition.standard_parts import standard_parts

SEEDS = [3, 4, 9, 11]
NAMED_ANYHOW = [119, 104, 129, 100]
"""Rings whose joints name different parts of one body; of 119 and 129, names connect all joints, to a chain."""
CAGED = 133
"""Whose cage is as near to one ring as its balls are to the other."""


@cache
def touching(seed):
    made = machine(Draw([seed]))
    assembly = assembly_of(made, seed)
    found, near = touching_of(assembly)
    return made, assembly, found, near


@pytest.mark.parametrize("seed", SEEDS)
def test_bodies_are_those_of_the_machine_whichever_parts_are_named(seed):
    made, assembly, found, contact = touching(seed)
    assert judge(made, kinematics.derive(assembly, found, contact)).exact


def test_a_loop_of_decks_with_a_caged_bearing_comes_apart_at_its_joints_at_a_millimetre():
    made = ring(Draw([CAGED]), largest=True)
    assert any(name.startswith("cage") for name in made.solids)
    assembly = assembly_of(made, CAGED, size=0.001)
    found, near = touching_of(assembly)
    K = kinematics.derive(assembly, found, near)
    verdict = judge(made, K)
    assert verdict.exact and verdict.mobility == 1, verdict


@pytest.mark.parametrize("seed", SEEDS)
def test_a_sample_of_the_points_gives_the_same_prices(seed, monkeypatch):
    """Of many joints a fifth of the points of a contact tells most that do not part it: the prices are the same."""
    _, assembly, _, contact = touching(seed)
    joints = [joint for joint in assembly.function.joints if joint.type != "fixed"]
    twists = [joint_twists(joint) for joint in joints]
    every = prices(joints, twists, contact.patches, contact.suggestions)
    told = []
    asked = Contact._surely_opposed
    monkeypatch.setattr(Contact, "_surely_opposed", lambda of, motions: told.append(asked(of, motions)) or told[-1])
    monkeypatch.setattr("kinform.kinematics.partition.contact.NUMBERS_AT_ONCE", 1)
    assert prices(joints, twists, contact.patches, contact.suggestions).by_joint == every.by_joint
    assert np.concatenate(told).any() or len(joints) == 1


@pytest.mark.parametrize("seed", SEEDS)
def test_every_joint_that_is_proposed_is_one(seed):
    _, assembly, found, contact = touching(seed)
    ways = propose(replace(assembly, function=type(assembly.function)()), found, contact)
    assert ways or seed == 11  # whose only joint is that of a horn: no journal
    seen = set()
    for way in ways:
        gaps = [way.point - joint.point for joint in assembly.function.joints]
        off = [np.linalg.norm(gap - (gap @ way.axis) * way.axis) for gap in gaps]
        nearest = assembly.function.joints[int(np.argmin(off))]
        assert min(off) < 1e-6
        assert nearest.name not in seen
        seen.add(nearest.name)
        assert abs(way.axis @ nearest.axis) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("seed", SEEDS[:3])  # of the last nothing is proposed
def test_stating_all_proposed_joints_gives_their_bodies(seed):
    _, assembly, found, contact = touching(seed)
    bare = replace(assembly, function=type(assembly.function)())
    joints = tuple(joint for joint, _ in proposed_joints(bare, found, contact))
    K = kinematics.derive(replace(bare, function=replace(assembly.function, joints=joints)), found, contact)
    assert len(K.bodies) == len(joints) + 1
    assert K.mobility.instantaneous == len(joints)
    pairs = [frozenset(str(K.body_of(name).name) for name in joint.between) for joint in joints]
    assert sorted(map(sorted, pairs)) == sorted(sorted(joint.bodies) for joint in K.joints)


def test_the_judge_finds_a_part_in_another_body():
    made, assembly, found, contact = touching(SEEDS[0])
    K = kinematics.derive(assembly, found, contact)
    first, second = K.bodies[:2]
    moved = (replace(first, parts=first.parts[1:]), replace(second, parts=(*second.parts, first.parts[0])))
    assert not judge(made, replace(K, bodies=(*moved, *K.bodies[2:]))).exact


@pytest.mark.parametrize("seed", first_of(1, NAMED_ANYHOW))
def test_bodies_round_a_loop_are_those_of_the_machine_whichever_parts_are_named(seed):
    made = ring(Draw([seed]))
    assembly = assembly_of(made, seed)
    found, near = touching_of(assembly)
    verdict = judge(made, kinematics.derive(assembly, found, near))
    assert verdict.exact and verdict.mobility == 1, verdict


def test_names_that_firm_contact_joins_are_one_body_unless_joints_hang_them_together():
    """Nodes 0–1–2–3 in a row; joints between labels (0, 1) and (2, 3)."""
    seeds = {0: 0, 1: 1, 2: 2, 3: 3}
    holds = [(20000.0, (1, 2)), (300.0, (0, 3)), (20000.0, (0, 1))]
    assert merge_labels(UnionFind(4), seeds, holds, [(0, 1), (2, 3)]) == [0, 1, 1, 3]
    assert merge_labels(UnionFind(4), seeds, [(40.0, (1, 2))], [(0, 1), (2, 3)]) == [0, 1, 2, 3]


def test_names_that_were_joined_wrongly_are_moved_to_where_less_is_parted():
    """Nodes 0 to 3, joints between labels (0, 1) and (2, 3); 1 and 2 are firm, 0 and 3 lie flush."""
    edges = [Edge((1, 2), {}, 20000.0), Edge((0, 3), {}, 150.0)]
    for start in ([0, 1, 2, 0], [0, 1, 2, 3], [0, 1, 1, 3]):
        found, close = merge_by_cost({k: k for k in range(4)}, edges, [(0, 1), (2, 3)], start)
        assert [label == found[1] for label in found] == [False, True, True, False]
        assert not close
    # as firm on either side: both are named as open
    even = [Edge((1, 2), {}, 200.0), Edge((0, 3), {}, 200.0)]
    _, close = merge_by_cost({k: k for k in range(4)}, even, [(0, 1), (2, 3)], [0, 1, 2, 0])
    assert close == {0, 1, 2, 3}


def shaped(**solids):
    parts = [part(name, solid, np.eye(4)) for name, solid in solids.items()]
    made = assembly_of(machine(Draw([0])), 0)
    made = replace(made, parts=tuple(parts))
    found = {p.mesh.digest: surfaces.recover(p.mesh, made.tolerances) for p in parts}
    return {name: one.kind for name, one in standard_parts(made, found).items()}


def test_standard_parts_by_name():
    names = {
        "DIN 912 M3x10": "screw",
        "iso_4032_m5": "nut",
        "Unterlegscheibe_2": "washer",
        "bearing screw": "screw",
        "top/ISO 7089": "washer",
        "螺丝 M3": "screw",
        "vise_jaw": None,
        "pinion": None,
        "DIN rail": None,
    }
    solid = box(0, 10, 0, 20, 0, 30)
    assert shaped(**dict.fromkeys(names, solid)) == {name: kind for name, kind in names.items() if kind}


def test_standard_parts_by_shape_need_copies():
    bolt = rod(1.5, 0, 10) + rod(2.75, 10, 13)
    washer = rod(3.5, 0, 0.5) - rod(1.6, -1, 1)
    three = {f"{name}{k}": solid for name, solid in (("a", bolt), ("b", washer)) for k in range(3)}
    found = shaped(**three, wheel=rod(20, 0, 5) + rod(3, 5, 40), plate=box(0, 40, 0, 40, 0, 4) - rod(3, -1, 5))
    assert found == {name: "screw" if name[0] == "a" else "washer" for name in three}
    assert shaped(knob=bolt) == {}
