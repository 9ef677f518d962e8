"""Parts with play between two others: what they may carry is not known, and is neither found nor denied; what is sure
to be missing is still told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from manifold3d import Manifold
from support.assemblies import assembly, assume, intended
from support.bearings import KINDS, Size
from support.diagonal import diagonal
from support.diagonal import first as first_of
from support.solids import ball, block, box, part, random_pose, rod
from support.touching import touching as touching_of

from kinform import kinematics
from kinform.consistency import check
from kinform.consistency.comparisons.answers import answers
from kinform.consistency.questions.captive_parts import CaptiveParts, may_carry
from kinform.design import Design
from kinform.model.function import Drive

RADIUS = 4.0
"""mm: of rollers and balls."""
WIDE = 60.0
"""mm: of the plates."""


def roller(radius=RADIUS):
    """A roller along y whose corners are highest and lowest."""
    return rod(radius, -10, 10, 40).rotate((90, 0, 0))


def plates(lower, upper, radius=RADIUS):
    """Two plates that keep these distances (mm) from a roller or ball about the origin."""
    return {
        "low": block(WIDE, WIDE, 10).translate((0, 0, -radius - lower - 5)),
        "high": block(WIDE, WIDE, 10).translate((0, 0, radius + upper + 5)),
    }


def design_of(solids, *, kind="planar", between=("low", "high"), X=None, scale=1e-3, complete=False, **more):
    """A design whose function states a joint of the two along z, and none where these are ()."""
    X = np.eye(4) if X is None else X
    joints = (intended("slide", *between, kind, X[:3, 2], X[:3, 3]),) if between else ()
    parts = (part(name, solid, X, scale) for name, solid in solids.items())
    made = assembly(*parts, **{"ground": next(iter(solids)), "joints": joints} | more)
    made = replace(made, function=replace(made.function, complete=("",) if complete else ()))
    found, touching = touching_of(made)
    derived = kinematics.derive(made, found, touching)
    return Design(assembly=made, surfaces=found, contacts=touching, kinematics=derived)


def answer_of(solids, **more):
    (answer,) = answers(design_of(solids, **more))
    return answer.answer


def told(design):
    """Errors and warnings by code, and the rules that are inconclusive."""
    report = check(design)
    found = {finding.code for finding in report.findings if finding.severity != "note"}
    return found, {rule.code for rule in report.rules if rule.outcome == "inconclusive"}


def carrier(design):
    """The part with play between the two plates: its name, and its gaps (mm) to the high and the low one."""
    parts = CaptiveParts(design.assembly, design.contacts)
    one = may_carry(parts, design.kinematics, "high", "low", {"high", "low"})
    assert one.sides == ("high", "low")
    return one.name, [gap if gap is None else 1e3 * gap for gap in one.gaps]


@diagonal(
    scale=[1e-4, 1e-3, 0.1],
    gaps=[(0.15, 0.15), (0.12, 0.2), (0.22, 0.12)],
    shape=[roller, lambda: ball(RADIUS).rotate((0, 0, 13))],
)
def test_the_clearances_of_a_captive_part_are_those_to_its_sides(shape, gaps, scale):
    design = design_of(
        {**plates(*gaps), "element": shape()}, X=random_pose(np.random.default_rng(1), scale), scale=scale
    )
    assert not design.contacts.patches
    assert [one.answer for one in answers(design)] == ["undecided"]
    found, doubts = told(design)
    assert not found & {"KF203", "KF301", "KF401", "KF402", "KF414"}
    assert doubts >= {"KF203", "KF401", "KF402"}
    name, away = carrier(design)
    assert name == "element"
    assert away == pytest.approx([gap * 1e3 * scale for gap in reversed(gaps)], rel=1e-6)


def test_beyond_the_contact_tolerance_of_either_pair_there_is_no_contact():
    limit = design_of({**plates(0.1, 0.1), "element": roller()}).contacts.tolerance["element", "high"] * 1e3
    assert 0.2 < limit < 1.0
    for lower, upper, expected in ((0.98, 0.98, "undecided"), (0.5, 1.1, "no contact"), (1.1, 0.5, "no contact")):
        for X in (np.eye(4), random_pose(np.random.default_rng(6))):
            assert answer_of({**plates(lower * limit, upper * limit), "element": roller()}, X=X) == expected


def test_clearances_are_those_of_the_placed_meshes():
    """What keeps one plate too far is moved nearer."""
    solids = {**plates(0.1, 3.0), "element": roller()}
    design = design_of(solids)
    assert [one.answer for one in answers(design)] == ["no contact"]
    nearer = solids | {"high": solids["high"].translate((0, 0, -2.9))}
    assert answer_of(nearer) == "undecided"


@pytest.mark.parametrize("gap", [0.1, 0.3])
def test_what_comes_near_one_side_only_is_a_ball_above_a_table(gap):
    """Two tables side by side, with a stated joint, and a ball above their seam or above one of them."""
    left = block(40, 40, 10).translate((-20.5, 0, -RADIUS - gap - 5))
    right = block(40, 40, 10).translate((25.5, 0, -RADIUS - gap - 5))
    seam = right.translate((-5.0, 0, 0))
    for other in (right, seam):
        design = design_of({"left": left, "right": other, "element": ball(RADIUS)}, between=("left", "right"))
        assert [one.answer for one in answers(design)] == ["no contact"]
        found, doubts = told(design)
        assert {"KF203", "KF401"} <= found
        assert not doubts & {"KF203", "KF401"}


def test_what_its_own_bore_holds_comes_near_the_other_from_one_side():
    """A pin in a bore of one plate that keeps a little from the other is no part between the two."""
    upper = block(WIDE, WIDE, 10)
    for gap, bottom in ((0.1, -15), (0.2, -21)):
        lower = block(WIDE, WIDE, 20).translate((0, 0, -10)) - rod(3.0, bottom, 1, 64)
        tip = rod(3.0, -15, 4, 64) + ball(3.0, 64).translate((0, 0, 4))
        assert answer_of({"low": lower, "high": upper.translate((0, 0, 12.0 + gap)), "pin": tip}) == "no contact"
        beside = block(10, WIDE, 10).translate((8.0 + gap, 0, 7.0))
        assert answer_of({"low": lower, "high": beside, "pin": rod(3.0, -15, 5, 64)}) == "no contact"


def test_what_hangs_from_hooks_of_one_side_does_not_reach_the_other():
    """A roller with play to either side, whose thin ends are pressed against lips that keep it from going up."""
    ends = rod(1.0, -20, 20, 40).rotate((90, 0, 0))
    lips = box(-5, 5, 14, 18, 1.0, 2.0) + box(-5, 5, -18, -14, 1.0, 2.0)
    posts = box(5, 8, 14, 18, -8, 2) + box(5, 8, -18, -14, -8, 2)
    sides = plates(0.15, 0.15)
    hung = {"low": sides["low"] + lips + posts, "high": sides["high"], "element": roller() + ends}
    design = design_of(hung)
    assert {patch.parts for patch in design.contacts.patches} == {("element", "low")}
    assert [one.answer for one in answers(design)] == ["no contact"]
    free = {**hung, "low": sides["low"] + (lips + posts).translate((0, 0, 0.7))}
    assert answer_of(free) == "undecided"


def test_a_roller_that_lies_on_one_race_may_carry_the_other():
    for gap in (0.1, 0.2):
        design = design_of({**plates(0.0, gap), "element": roller()})
        assert {patch.parts for patch in design.contacts.patches} == {("element", "low")}
        assert [one.answer for one in answers(design)] == ["undecided"]
        _, doubts = told(design)
        assert "KF401" in doubts
        name, (to_high, to_low) = carrier(design)
        assert (name, to_low) == ("element", None)
        assert to_high == pytest.approx(gap, rel=1e-6)


def test_a_part_that_hangs_on_a_stated_body_is_not_captive():
    """The roller turns on a pin of a third body that the function names, or of ground, or is named itself."""
    axle = rod(1.0, -20, 20, 40).rotate((90, 0, 0))
    bored = roller() - rod(1.0, -20, 20, 40).rotate((90, 0, 0))
    bracket = axle + block(10, 4, 3).translate((0, -20, 0))
    solids = {**plates(0.1, 0.1), "element": bored, "third": bracket}
    stated = (intended("slide", "low", "high", "planar"), intended("far", "low", "third", "planar"))
    for joints, ground in ((stated, "low"), (stated[:1], "third")):
        made = design_of(solids, joints=joints, ground=ground)
        assert [one.answer for one in answers(made) if one.name == "slide"] == ["no contact"]
    assert answer_of(solids, ground="low") == "undecided"
    named = design_of({**plates(0.1, 0.1), "element": roller()}, joints=(*stated[:1], intended("it", "low", "element")))
    assert {one.name: one.answer for one in answers(named)} == {"slide": "no contact", "it": "no contact"}


def test_groups_are_one_and_pairs_that_are_ignored_do_not_count():
    solids = {**plates(0.1, 0.1), "element": roller()}
    assert answer_of(solids) == "undecided"
    assert answer_of(solids, groups=(("base", ("element", "low")),), between=("base", "high")) == "no contact"
    assert answer_of(solids, assume=(assume("element", "low", None, ignore=True),)) == "no contact"
    # a cage that joins the rollers as one
    both = {**plates(0.1, 0.1), "one": roller().translate((-9, 0, 0)), "two": roller().translate((9, 0, 0))}
    design = design_of(both, groups=(("rollers", ("one", "two")),))
    assert [one.answer for one in answers(design)] == ["undecided"]
    assert carrier(design) == ("rollers", pytest.approx([0.1, 0.1], rel=1e-6))


@pytest.mark.parametrize("lean", first_of(2, [10.0, 60.0, 30.0, 80.0]))
def test_edges_that_come_near_two_sides_face_nothing(lean):
    """A loose plate that stands askew between two others keeps 0.2 mm from each with an edge."""
    askew = block(14, 20, 3).rotate((0, lean, 0))
    half = askew.bounding_box()[5]
    design = design_of({**plates(0.2, 0.2, half), "loose": askew})
    assert {pair for pair in design.contacts.candidates if "loose" in pair} == {("high", "loose"), ("loose", "low")}
    assert [one.answer for one in answers(design)] == ["no contact"]
    assert {"KF203", "KF401"} <= told(design)[0]


def test_a_hinge_without_its_pin_is_a_finding():
    """Also where a screw of one of the leaves ends near the other."""
    bore = rod(3.0, -1, 40, 64)
    leaf = box(-8, 8, -8, 8, 0, 10) - bore
    other = leaf.translate((0, 0, 12))
    screw = (rod(1.5, 3, 10.3, 40) + ball(1.5, 40).translate((0, 0, 10.3))).translate((6, 0, 0))
    for solids in ({}, {"screw": screw}):
        hole = rod(1.5, 3, 11, 40).translate((6, 0, 0)) if solids else Manifold()
        made = design_of({"a": leaf - hole, "b": other, **solids}, kind="revolute", between=("a", "b"))
        assert [one.answer for one in answers(made)] == ["no contact"]
        assert "KF401" in told(made)[0]


def test_bearings_in_a_row_may_carry():
    """Balls between a plate and a loose sleeve, and others between that and the next plate."""
    sleeve = block(WIDE, WIDE, 6)
    lower, upper = ball(RADIUS).translate((0, 0, -3.1 - RADIUS)), ball(RADIUS).translate((5, 0, 3.1 + RADIUS))
    solids = {**plates(0.2, 0.2, 3.0 + 2 * RADIUS), "sleeve": sleeve, "one": lower, "two": upper}
    assert answer_of(solids) == "undecided"
    assert answer_of({name: solid for name, solid in solids.items() if name != "two"}) == "no contact"
    assert answer_of(solids, assume=(assume("one", "sleeve", None, ignore=True),)) == "no contact"


@diagonal(3, kind=["needles", "balls, cage", "thrust rollers", "balls", "tapers, rib"], complete=[False, True])
def test_no_rule_contradicts_a_bearing_with_clearance(kind, complete):
    bearing = KINDS[kind](Size(5, 8.0, 2.2, 12.0, 0.035 * 2.2, 64, 32, 70.0))
    mobility = {"revolute": 1, "cylindrical": 2, "planar": 3}[bearing.truth]
    design = design_of(
        bearing.solids, kind=bearing.truth, between=("ring", "shaft"), mobility=mobility, complete=complete
    )
    drive = Drive("slide", "effort", None, {}, 1.0, "m.toml", 12)
    design = replace(
        design, assembly=replace(design.assembly, function=replace(design.assembly.function, drives=(drive,)))
    )
    assert [one.answer for one in answers(design)] == ["undecided"]
    found, doubts = told(design)
    assert not found & {"KF203", "KF301", "KF401", "KF402", "KF409", "KF414"}
    assert "KF401" in doubts
    assert complete or doubts >= {"KF301", "KF402", "KF409"}


def test_elements_left_out_leave_a_missing_joint():
    """With every second ball it is not known; without any the joint is missing."""
    solids = KINDS["balls"](Size(4, 8.0, 2.2, 12.0, 0.035 * 2.2, 96, 40)).solids
    for left, expected in (((0, 2), "undecided"), ((), "no contact")):
        some = {name: solid for name, solid in solids.items() if name[:4] != "ball" or int(name[4:]) in left}
        assert answer_of(some, kind="revolute", between=("ring", "shaft")) == expected


def test_captive_parts_between_bodies_without_a_function():
    """Without a function it is not sure that these are apart; what is far from all of them is."""
    solids = {**plates(0.1, 0.1), "element": roller(), "far": ball(5.0).translate((0, 0, 90))}
    found, _ = told(design_of(solids, between=()))
    assert "KF203" in found
    report = check(design_of(solids, between=()))
    assert [finding.subject for finding in report.findings if finding.code == "KF203"] == [("far",)]
    # apart from ground together
    base = block(WIDE, WIDE, 5).translate((0, 0, 200))
    report = check(design_of({"base": base, **plates(0.1, 0.1), "element": roller()}, between=()))
    (finding,) = (one for one in report.findings if one.code == "KF203")
    assert finding.subject == ("element", "high", "low")


@pytest.mark.parametrize("seed", first_of(1, range(4)))
def test_neither_pose_nor_names_nor_facets_change_it(seed):
    rng = np.random.default_rng(seed)
    X = random_pose(rng, 0.1)
    X[:3, 3] += 20.0 * rng.normal(size=3)
    names = dict(zip(("low", "high", "element"), rng.permutation(["a", "b", "c"]).tolist(), strict=True))
    shape = rod(RADIUS, -10, 10, int(rng.integers(12, 90)), float(rng.uniform(0, 90))).rotate((90, 0, 0))
    for upper, expected in ((0.15, "undecided"), (1.5, "no contact")):
        solids = {names[name]: solid for name, solid in {**plates(0.15, upper), "element": shape}.items()}
        between = (names["low"], names["high"])
        assert answer_of(solids, between=between, ground=names["low"], X=X) == expected


def guided(side, gap=0.15):
    """A block that lies on a plate, with an upright roller and its play between it and a wall of the plate: beside it,
    or ahead of it along x."""
    reach = 2 * RADIUS + 2 * gap
    wall, block_on_it = box(-40, 40, 20, 30, -1, 12), box(-15, 15, -10, 20 - reach, 0, 10)
    upright = rod(RADIUS, 2.5, 8.5, 40).translate((0, 20 - RADIUS - gap, 0))
    turned = (0, 0, 0 if side == "beside" else -90)
    return {
        "low": block(90, 90, 10).translate((0, 0, -5)) + wall.rotate(turned),
        "high": block_on_it.rotate(turned),
        "element": upright.rotate(turned),
    }


@pytest.mark.parametrize("complete", [False, True])
def test_a_joint_is_not_contradicted_where_a_captive_part_may_constrain_it(complete):
    """A block on a plate is no slide; a roller beside it may make it one, and a roller ahead of it does not."""
    x = np.array([1.0, 0.0, 0.0])
    joint = (replace(intended("slide", "low", "high", "prismatic"), axis=x),)

    def outcome(solids):
        design = design_of(solids, between=(), joints=joint, complete=complete)
        ((answer,), (found, doubts)) = answers(design), told(design)
        return answer.answer, "KF414" in found, "KF414" in doubts

    beside = guided("beside")
    assert outcome(beside) == ("undecided", False, True)
    assert outcome(guided("ahead")) == ("not held", True, False)
    assert outcome(guided("beside", 0.6)) == ("not held", True, False)
    assert outcome({name: solid for name, solid in beside.items() if name != "element"}) == ("not held", True, False)


def test_nothing_is_measured_where_joints_are_in_contact(monkeypatch):
    def never(*_):
        raise AssertionError

    monkeypatch.setattr("kinform.consistency.questions.captive_parts.facing", never)
    bearing = KINDS["needles"](Size(5, 8.0, 2.2, 12.0))
    design = design_of(bearing.solids, kind="cylindrical", between=("ring", "shaft"))
    assert [one.answer for one in answers(design)] == ["agrees"]
    apart = plates(5.0, 5.0) | {"element": roller()}
    assert answer_of(apart) == "no contact"
    # near a loose plate, which is far from the other
    loose = block(WIDE, WIDE, 4).translate((0, 0, RADIUS + 2.15))
    assert answer_of(plates(0.15, 20.0) | {"element": roller(), "loose": loose}) == "no contact"
