"""Bodies from function: the cheapest labels are the cheapest of all, and parts part where their joints may."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support.assemblies import HERE, assembly
from support.diagonal import diagonal
from support.patches import patch
from support.solids import box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import contacts, kinematics, surfaces
from kinform.kinematics.joints.bodies.stated_joints import joint_twists
from kinform.kinematics.partition import partition
from kinform.kinematics.partition.contact import Asked, Contact
from kinform.kinematics.partition.labelling import Edge, label_all, margins
from kinform.kinematics.partition.split_prices import prices
from kinform.model.function import Function, IntendedJoint

PRICES = st.sampled_from([1.0, 30.0, 300.0])


@st.composite
def graphs(draw):
    """Seeds 0 to k − 1 with their own label, a few free nodes, and contacts at any price."""
    seeds, free = draw(st.integers(2, 3)), draw(st.integers(1, 4))
    pairs = [(a, b) for a in range(seeds + free) for b in range(max(a + 1, seeds), seeds + free)]
    chosen = draw(st.lists(st.sampled_from(pairs), min_size=1, max_size=9, unique=True))
    edges = []
    for ends in chosen:
        joints = draw(st.lists(st.tuples(st.integers(0, seeds - 1), st.integers(0, seeds - 1), PRICES), max_size=2))
        parted = {}
        for a, b, price in joints:
            if a != b:
                parted[(a, b)] = parted[(b, a)] = price
        jams = draw(st.lists(st.tuples(st.integers(0, seeds - 1), st.integers(0, seeds - 1)), max_size=2))
        jammed = {two for a, b in jams if a != b for two in ((a, b), (b, a))} - parted.keys()
        edges.append(Edge(ends, parted, draw(st.sampled_from([10.0, 1000.0, 6000.0])), jointed=frozenset(jammed)))
    return seeds, free, edges


def reachable(node, seeds, edges):
    """Seeds that a node touches, itself or through others that are none, and those across a joint that may part such a
    contact: it is in no other body than theirs."""
    near, waiting, met = {node}, [node], []
    while waiting:
        here = waiting.pop()
        for edge in edges:
            if here in edge.ends:
                met.append(edge)
                new = set(edge.ends) - near
                near |= new
                waiting += [one for one in new if one >= seeds]
    touched = {one for one in near if one < seeds}
    across = {b for edge in met for a, b in edge.parted if a in touched}
    return sorted(touched | across) or [seeds - 1]


def cost(labels, edges):
    return sum(edge.price(labels[edge.ends[0]], labels[edge.ends[1]]) for edge in edges)


ACROSS = (
    3,
    1,
    [
        Edge((1, 3), {}, 10.0, jointed=frozenset({(1, 2), (2, 1)})),
        Edge((2, 3), {(0, 2): 1.0, (2, 0): 1.0}, 1000.0),
    ],
)
"""A node that touches two bodies, and is in neither: it is across the joint of one."""


@settings(max_examples=30, deadline=None)
@given(graphs())
@example(ACROSS)
def test_no_labels_cost_less(graph):
    seeds, free, edges = graph
    own = {k: k for k in range(seeds)}
    found = label_all(seeds + free, own, edges)
    labels = [seeds - 1 if label is None else label for label in found.labels]  # what touches no seed costs nothing
    ways = product(*(reachable(seeds + k, seeds, edges) for k in range(free)))
    best = min(cost([*range(seeds), *rest], edges) for rest in ways)
    reached = [k for k, label in enumerate(found.labels) if label is None]
    if not reached:
        assert cost(labels, edges) == pytest.approx(best)
    for margin in margins(found.labels, own, edges).values():
        assert margin.cost >= -1e-9


def joint(name, between, type_="revolute", axis=(0, 0, 1), point=(0, 0, 0)):
    at = None if point is None else np.asarray(point, float)
    return IntendedJoint(name, between, type_, np.asarray(axis, float), None, at, None, None, HERE.file, None)


def moved(one, X, scale):
    """The joint with the assembly; points in mm of the drawing."""
    at = X[:3, :3] @ (scale * one.point) + X[:3, 3]
    return IntendedJoint(one.name, one.between, one.type, X[:3, :3] @ one.axis, None, at, None, None, one.file, None)


def stack(lift=0.0):
    """A base with a pivot, an arm on it made of two plates and two bolts, and a cover on the base."""
    base = box(-30, 30, -30, 30, -10, 0) + rod(5, -1, 30, 48)
    low = box(-10, 60, -10, 10, 0.0, 6) - rod(5.02, -1, 7, 48) - rod(2, -1, 7, 24).translate((40, 0, 0))
    low -= rod(2, -1, 7, 24).translate((50, 0, 0))
    high = (
        box(30, 60, -10, 10, 6, 12) - rod(2, 5, 13, 24).translate((40, 0, 0)) - rod(2, 5, 13, 24).translate((50, 0, 0))
    )
    bolts = [(rod(1.98, 0, 12, 24) + rod(3.5, 12, 15, 24)).translate((x, 0, 0)) for x in (40, 50)]
    cover = box(-30, -12, -30, 30, 0, 4)
    arm = {"low": low, "high": high, "bolt_1": bolts[0], "bolt_2": bolts[1]}
    return {"base": base, "cover": cover} | {name: solid.translate((0, 0, lift)) for name, solid in arm.items()}


def made(X=None, scale=1e-3, groups=(), joints=(), order=None, lift=0.0):
    X = np.eye(4) if X is None else X
    solids = stack(lift)
    names = order or list(solids)
    parts = [part(name, solids[name], X, scale) for name in names]
    whole = assembly(*parts, groups=groups)
    stated = Function(joints=tuple(moved(one, X, scale) for one in joints), complete=("",))
    whole = type(whole)(**{f: getattr(whole, f) for f in whole.__dataclass_fields__} | {"function": stated})
    found, near = touching_of(whole)
    return whole, found, near


ARM = joint("turn", ("base", "low"))


@diagonal(seed=[None, 0], scale=[1e-3, 1.0], expected=[(0.0, "determined", 1), (2.0, "stated", 2)])
def test_an_arm_of_plates_and_bolts_is_one_body(seed, scale, expected):
    """Lifted off the base, only its pivot guides it: contact alone lets it slide off."""
    lift, status, by_contact = expected
    X = None if seed is None else random_pose(np.random.default_rng(seed))
    whole, found, touching = made(X, scale, joints=[ARM], lift=lift)
    K = kinematics.derive(whole, found, touching)
    assert sorted(set(body.parts) == {"base", "cover"} for body in K.bodies) == [False, True]
    (arm,) = K.joints
    assert (arm.type, arm.status) == ("revolute", status)
    assert [(reading.cause, reading.type) for reading in arm.readings] == (
        [("contact", "cylindrical")] if status == "stated" else []
    )
    assert K.mobility.instantaneous == 1
    assert K.mobility.by_contact == by_contact


def test_contact_that_forbids_the_joint_stands():
    """The arm cannot slide along x: its pivot is in the way."""
    slide = joint("slide", ("base", "low"), "prismatic", (1, 0, 0))
    whole, found, touching = made(joints=[slide])
    (arm,) = kinematics.derive(whole, found, touching).joints
    assert (arm.type, arm.status) == ("revolute", "determined")


def test_the_order_of_parts_and_joints_does_not_matter():
    one = made(joints=[ARM])
    other = made(joints=[ARM], order=["cover", "bolt_2", "high", "low", "bolt_1", "base"])
    first, second = (partition(whole, touching, whole.function.joints) for whole, _, touching in (one, other))
    assert first.parts == second.parts
    assert {name: (p.how, p.margin, p.other) for name, p in first.placed.items()} == {
        name: (p.how, p.margin, p.other) for name, p in second.placed.items()
    }


def test_a_group_wins_over_what_the_joints_ask_for():
    whole, _, touching = made(joints=[ARM], groups=(("odd", ("base", "high")),))
    found = partition(whole, touching, whole.function.joints)
    assert found.placed["high"].body == found.placed["base"].body != found.placed["low"].body


def test_a_part_without_contact_belongs_to_the_nearest_body_and_is_unclear():
    whole, _, touching = made(joints=[ARM])
    lonely = part("lonely", box(0, 5, 40, 45, 0, 5), np.eye(4))
    whole = type(whole)(
        **{f: getattr(whole, f) for f in whole.__dataclass_fields__} | {"parts": (*whole.parts, lonely)}
    )
    found = partition(whole, touching, whole.function.joints)
    assert found.placed["lonely"].how == "nearest"
    assert found.placed["lonely"].body == found.placed["base"].body
    assert "lonely" in {one.part for one in found.unclear}


@pytest.mark.parametrize(("named", "guessed"), [("low", False), ("high", True)])
def test_bodies_guessed_from_several_names_are_unclear_where_contact_still_holds_across(named, guessed):
    """A lever on the arm stands on the base, too: either it is one with the base, or what was taken for one arm is
    two. Where both joints name the same part of the arm, nothing of it was guessed."""
    solids = stack()
    solids["high"] += rod(3, 11, 20, 40).translate((45, 0, 0))
    lever = box(20, 50, -30, -15, 0, 18) + box(37, 53, -15, 8, 12, 18) - rod(3.02, 11, 20, 40).translate((45, 0, 0))
    joints = (ARM, joint("swing", (named, "lever"), point=(45, 0, 0)))
    whole = assembly(*(part(name, solid, np.eye(4)) for name, solid in (solids | {"lever": lever}).items()))
    stated = Function(joints=tuple(moved(one, np.eye(4), 1e-3) for one in joints), complete=("",))
    whole = replace(whole, function=stated)
    _, near = touching_of(whole)
    placed = partition(whole, near, stated.joints).placed
    assert placed["low"].body == placed["high"].body != placed["base"].body
    assert all(placed[name].either for name in ("base", "low", "high", "lever")) == guessed


@pytest.mark.parametrize("tight", ["left", "right"])
def test_a_pin_stays_where_it_is_tight_and_may_go_with_either(tight):
    """Neither side holds it along its axis; the area that it touches is greater where it is loose."""
    height = {name: 6 if name == tight else 9 for name in ("left", "right")}
    bore = {name: 3.0 if name == tight else 3.1 for name in ("left", "right")}
    left = box(-30, 6, -6, 6, -height["left"], 0) - rod(bore["left"], -20, 20, 64)
    right = box(-6, 30, -6, 6, 0.5, 0.5 + height["right"]) - rod(bore["right"], -20, 20, 64)
    pin = rod(3.0, -height["left"], 0.5 + height["right"], 64)
    solids = {"left": left, "right": right, "pin": pin}
    whole = assembly(*(part(name, solid, np.eye(4)) for name, solid in solids.items()))
    hinge = moved(joint("hinge", ("left", "right")), np.eye(4), 1e-3)
    whole = replace(whole, function=Function(joints=(hinge,), complete=("",)))
    _, near = touching_of(whole)
    placed = partition(whole, near, (hinge,)).placed
    assert placed["pin"].body == placed[tight].body
    assert placed["pin"].unclear


def test_a_horn_may_go_either_way_and_a_plate_that_is_screwed_on_beside_the_axis_may_not():
    """Both have screw holes in line with the arm's, and the turn leaves both free: the horn goes round its axis."""
    solids = stack() | {"horn": rod(12, 6, 10, 48) - rod(5.02, 5, 11, 48)}
    for x, y in ((0, 8.5), (0, -8.5)):
        hole = rod(1, -20, 20, 24).translate((x, y, 0))
        solids = {n: s - hole if n in ("horn", "low") else s for n, s in solids.items()}
    del solids["bolt_1"], solids["bolt_2"]
    whole = assembly(*(part(name, solid, np.eye(4)) for name, solid in solids.items()))
    found = {p.mesh.digest: surfaces.recover(p.mesh, whole.tolerances) for p in whole.parts}
    joints = [moved(ARM, np.eye(4), 1e-3)]
    placed = partition(whole, contacts.find(whole, found), joints).placed
    assert placed["horn"].body == placed["high"].body == placed["low"].body
    assert placed["horn"].unclear
    assert placed["horn"].margin > 100.0  # screws speak for the arm
    assert not placed["high"].unclear


def test_a_block_that_a_joint_names_stays_on_what_turns():
    """Parting the block, one flat, costs less than the arm on its pivot among screw holes, where the joint is."""
    solids = stack()
    solids = {"base": solids["base"], "low": solids["low"], "block": box(-25, -15, -25, -15, 0, 8)}
    for x, y in ((0, 8), (0, -8), (8, 0), (-8, 0)):
        hole = rod(1, -20, 20, 24).translate((x, y, 0))
        solids = {n: s - hole for n, s in solids.items()}
    whole = assembly(*(part(name, solid, np.eye(4)) for name, solid in solids.items()))
    found = {p.mesh.digest: surfaces.recover(p.mesh, whole.tolerances) for p in whole.parts}
    joints = [moved(joint("turn", ("block", "low")), np.eye(4), 1e-3)]
    cut = partition(whole, contacts.find(whole, found), joints)
    assert sorted(cut.parts) == [("base", "block"), ("low",)]


@pytest.mark.parametrize(("gap", "price"), [(0.0, 300.0), (1e-4, 300.0), (3e-4, 50.0)])
def test_a_flat_with_a_gap_that_is_wide_by_its_size_holds_little(gap, price):
    """4 mm across: 0.2 mm is the limit. The axis is 50 mm beside it."""
    corners = 2e-3 * np.array([[x, y, 0.0] for x in (-1, 0, 1) for y in (-1, 0, 1)])
    flat = patch(corners, (0, 0, 1), "plane", area=16e-6, gap=gap)
    turn = joint("turn", ("a", "b"), point=(0.05, 0, 0))
    assert prices([turn], [joint_twists(turn)], [flat], ()).by_joint == {("a", "b"): {0: price}}


@given(st.integers(0, 10_000), st.sampled_from(["cylinder", "other"]))
@settings(max_examples=40, deadline=None)
def test_what_a_joint_costs_does_not_hang_on_those_that_are_asked_with_it(seed, kind):
    """A ring of contact on a flat; axes and centres on it, beside it and far away, of every type of joint."""
    draw = np.random.default_rng(seed)
    angle = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)
    radial = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(36)])
    ring = patch(5e-3 * radial, radial, kind, area=2e-5, radii=(5e-3, 5e-3))
    flat = patch(8e-3 * radial, (0, 0, 1), "plane", area=float(draw.choice([1e-6, 2e-5])))
    kinds = ("revolute", "cylindrical", "prismatic", "planar", "spherical", "screw")
    joints = []
    for k in range(24):
        axis = (np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), draw.normal(size=3))[draw.integers(3)]
        point = draw.choice([0.0, 3e-3, 5e-2]) * draw.normal(size=3)
        turn = joint(f"turn_{k}", ("a", "b"), point=point)
        joints.append(replace(turn, type=kinds[k % 6], axis=axis / np.linalg.norm(axis), pitch=1e-3))
    contact = Contact.of([ring, flat])
    twists = [joint_twists(one) for one in joints]
    together = contact.costs(Asked.of(joints, twists))
    alone = [contact.costs(Asked.of([one], [motions])).get(0) for one, motions in zip(joints, twists, strict=True)]
    assert [together.get(k) for k in range(24)] == alone
    centred = [k for k in range(0, 24, 6) if not joints[k].point.any() and abs(joints[k].axis[2]) == 1.0]
    assert all(together[k] == (40.0 if kind == "cylinder" else 30.0) for k in centred)
